#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "wellgyro/simulate/simulator.h"
#include "wellgyro/survey/run_adjuster.h"
#include "wellgyro/survey/surveyor.h"

#include "support/testing.h"

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

/// Is given every step first, may change it, and says whether it comes at all.
using Arrives = std::function<bool(SimulatedStep&)>;

/// Plays a run into a surveyor, as from a log that holds every message once, in order.
inline void Play(const Simulation& simulation, Surveyor& surveyor, const Arrives& arrives = {}) {
  Simulator simulator(simulation);
  surveyor.Push(simulator.tool_info());
  SimulatedStep step;
  while (simulator.Next(step)) {
    if (arrives && !arrives(step)) continue;
    std::visit([&](const auto& record) { surveyor.Push(record); }, step);
  }
}

/// The survey of a simulated run.
inline Survey SurveyOf(const Simulation& simulation, const Job& job, Sink& sink,
                       const Arrives& arrives = {}, const RunAdjuster* adjuster = nullptr) {
  Surveyor surveyor(job, sink);
  if (adjuster != nullptr) AdjustBy(*adjuster, surveyor);
  Play(simulation, surveyor, arrives);
  surveyor.Finish();
  return surveyor.Current(simulation.streams.tool);
}

/// The check of this code, of this run where one is given; nullptr: it was not made.
inline const Check* Find(const Survey& survey, const std::string& code, std::int32_t run = -1) {
  for (const Check& check : survey.checks) {
    if (check.code == code && (run < 0 || check.run == run)) return &check;
  }
  return nullptr;
}

}  // namespace wellgyro::testing
