#pragma once

#include <cstdint>
#include <variant>
#include <vector>

#include "wellgyro/simulate/simulator.h"
#include "wellgyro/survey/surveyor.h"

namespace wellgyro::testing {

/// Keeps what a surveyor tells.
struct CollectingSink : Sink {
  void OnStation(const Station& station) override { stations.push_back(station); }
  void OnCheck(const Check& check) override { checks.push_back(check); }
  void OnFault(const Fault& fault) override { faults.push_back(fault); }
  void OnAcknowledged(std::int32_t id) override { acknowledged.push_back(id); }
  std::vector<Station> stations;
  std::vector<Check> checks;
  std::vector<Fault> faults;
  std::vector<std::int32_t> acknowledged;
};

/// A survey of a simulated run, as from a log that holds every message once, in order.
inline Survey SurveyOf(const Simulation& simulation, const Job& job, Sink& sink,
                       const RunAdjuster* adjuster = nullptr) {
  Simulator simulator(simulation);
  Surveyor surveyor(job, sink, adjuster);
  surveyor.Push(simulator.tool_info());
  SimulatedStep step;
  while (simulator.Next(step)) {
    std::visit([&](const auto& record) { surveyor.Push(record); }, step);
  }
  surveyor.Finish();
  return surveyor.Current(simulation.streams.tool);
}

}  // namespace wellgyro::testing
