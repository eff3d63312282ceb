#pragma once

#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/sensor/sensor_files.h"
#include "wellgyro/simulate/truth.h"

#include "support/scratch.h"
#include "support/simulated_survey.h"
#include "support/small_hole.h"

/// A run with a stop at every stand, as the tables that a tool and a rig give of it.
namespace wellgyro::test {

inline const testing::SmallHole kStands = {.inclination_deg = 35,
                                           .build_deg = 0.05,
                                           .azimuth_deg = 75,
                                           .latitude_deg = 57,
                                           .to_md = 230,
                                           .depth_hz = 2};

/// Nine stops, a stand of pipe apart.
inline Simulation Stands() {
  Simulation simulation = SimulationOf(kStands);
  simulation.run.steps.clear();
  for (int i = 0; i <= 8; ++i) {
    if (i > 0) {
      simulation.run.steps.push_back(
          RunMove{.to_md = 28.0 * i + 3 * (i % 2), .speed = 0.5 + 0.05 * (i % 3), .ramp = 3});
    }
    simulation.run.steps.push_back(RunStop{.seconds = 70.0 + 13 * (i * i % 5)});
  }
  return simulation;
}

inline Job StandsJob() { return JobOf(kStands); }

/// The run as tables: samples with the tool's time and, where asked, UTC; marks; a tally.
struct StandsTables {
  std::string samples, depth, tally;
};
/// What people note of the stands: whole seconds, and how much hole each adds.
inline std::string TallyOf(const Truth& truth, UtcTime begin_utc) {
  std::string tally = "UTC[s],END_UTC[s],LENGTH[m]\n";
  const double zero = static_cast<double>(begin_utc.ns) * 1e-9;
  double begin = 0, md = 0;
  bool still = true;
  for (double at = 0.5; at <= truth.seconds() + 0.5; at += 0.5) {
    const TruthState now = truth.At(at);
    const bool rests = now.still && at <= truth.seconds();
    if (rests && !still) begin = at;
    if (!rests && still) {
      const double there = truth.At(begin).md;
      tally += fmt::format("{:.0f},{:.0f},{:.3f}\n", zero + begin, zero + at, there - md);
      md = there;
    }
    still = rests;
  }
  return tally;
}

inline StandsTables TablesOf(const Simulation& simulation, bool with_utc, double utc_off = 0) {
  StandsTables t;
  t.samples = with_utc
                  ? "TOOL[ns],UTC[us],GX[deg/h],GY[deg/h],AX[m/s2],AY[m/s2],AZ[g]\r\n"
                  : "# of a memory tool\nTOOL[ns],GX[deg/h],GY[deg/h],AX[m/s2],AY[m/s2],AZ[g]\n";
  t.depth = "UTC[us],MD[m]\n";
  Simulator simulator(simulation);
  SimulatedStep step;
  while (simulator.Next(step)) {
    if (const auto* s = std::get_if<ImuSample>(&step)) {
      t.samples += fmt::format("{},", s->stamp.tool_time.ns);
      if (with_utc) {
        t.samples += fmt::format("{},", s->stamp.utc.ns / 1000 + std::llround(utc_off * 1e6));
      }
      t.samples += fmt::format("{},{},{},{},{}\n", s->w_IT_T.x() / units::kDegPerHour,
                               s->w_IT_T.y() / units::kDegPerHour, s->f_T.x(), s->f_T.y(),
                               s->f_T.z() / units::kStandardGravity);
    }
    if (const auto* mark = std::get_if<DepthMark>(&step)) {
      t.depth += fmt::format("{},{}\n", mark->utc.ns / 1000, mark->md);
    }
  }
  t.tally = TallyOf(simulator.truth(), simulation.streams.begin_utc);
  return t;
}

/// What tables in a folder come to.
struct SurveyedTables {
  Result<SensorReport> report;
  Survey survey;
  std::vector<Fault> faults;
};
inline SurveyedTables Do(const support::Scratch& scratch, const std::vector<std::string>& names,
                         const Job& job) {
  std::vector<std::filesystem::path> files;
  for (const std::string& name : names) files.push_back(scratch.path() / name);
  testing::CollectingSink sink;
  Surveyor surveyor(job, sink);
  Result<SensorReport> report = PushSensorFiles(files, job, surveyor, sink);
  surveyor.Finish();
  return {std::move(report), surveyor.Current(0), sink.faults};
}

}  // namespace wellgyro::test
