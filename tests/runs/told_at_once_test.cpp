// A station is told when the samples around it have come, not when its knots are done with.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "wellgyro/io/toml/job_file.h"
#include "wellgyro/io/toml/simulation_file.h"

#include "support/claims.h"
#include "support/hour.h"
#include "support/simulated_survey.h"

namespace wellgyro {
namespace {

/// Knows how far the samples have come, and holds what is told against the truth.
struct AgeSink : Sink {
  explicit AgeSink(const Simulation& simulation)
      : truth(simulation), begin(simulation.streams.begin_utc) {}
  void OnStation(const Station& station) override {
    if (station.revision > 0 || station.kind != StationKind::kContinuous) return;
    ages.push_back((now - station.utc).seconds());
    const double seconds = (station.utc - begin).seconds();
    const double error = WrapPi(station.azimuth - truth.At(seconds).azimuth);
    told.push_back({seconds, error, station.cov_md_inc_azi(2, 2)});
    worst = std::max(worst, std::abs(error) / std::sqrt(told.back().variance));
  }
  struct Told {
    double seconds, error, variance;
  };
  Truth truth;
  UtcTime begin, now;
  std::vector<double> ages;
  std::vector<Told> told;
  double worst = 0;
};

constexpr double kThen = 350;  // [s]

// Minutes behind the only stop, when bias and heading are just being told apart.
TEST(ToldAtOnce, SoonAfterAStopItIsAsSureAsItSays) {
  for (const double inclination : {40.0, 88.0}) {
    testing::Claims claims;
    for (std::uint64_t seed = 1; seed <= (WELLGYRO_LONG ? 24 : 4); ++seed) {
      testing::Hour hour = testing::StrongDrift();
      hour.inclination_deg = inclination;
      hour.stops = 1;
      hour.minutes = 8;
      const Simulation simulation = testing::SimulationOf(hour, seed);
      AgeSink sink(simulation);
      testing::SurveyOf(simulation, testing::JobOf(hour), sink);
      const auto told = std::find_if(sink.told.begin(), sink.told.end(),
                                     [](const auto& station) { return station.seconds > kThen; });
      ASSERT_NE(told, sink.told.end());
      claims.Add(told->error, told->variance);
    }
    claims.ExpectTrue("350 s, I " + std::to_string(static_cast<int>(inclination)));
  }
}

/// Plays the run sample by sample: a tool that sends batches adds the time of one.
AgeSink Played(const Simulation& simulation, const Job& job) {
  AgeSink sink(simulation);
  Surveyor surveyor(job, sink);
  testing::Play(simulation, surveyor, [&sink](const SimulatedStep& step) {
    if (const auto* sample = std::get_if<ImuSample>(&step)) {
      sink.now = sample->stamp.utc + Duration{sample->stamp.period_ns};
    }
    return true;
  });
  return sink;
}

/// From a sample to its station latency_s and a second and a half pass at most, save where the
/// station waits for a north.
void ExpectPrompt(const AgeSink& sink, double latency, double share, const std::string& what) {
  const double late = latency + 1.5;
  const auto prompt = std::ranges::count_if(sink.ages, [late](double age) { return age <= late; });
  const double of = static_cast<double>(sink.ages.size());
  ASSERT_GT(of, 20) << what;
  std::vector<double> ages = sink.ages;
  std::ranges::sort(ages);
  std::printf("%s, latency %g s: %.1f %% within %.1f s, median %.2f s, of %.0f\n", what.c_str(),
              latency, 100 * static_cast<double>(prompt) / of, late, ages[ages.size() / 2], of);
  EXPECT_GE(static_cast<double>(prompt), share * of) << what << ", oldest " << ages.back();
}

TEST(ToldAtOnce, AStationIsNoOlderThanMarksMayBeAndASecondAndAHalf) {
  for (const double latency : {1.0, 5.0}) {
    for (const double inclination : {5.0, 40.0, 88.0}) {
      for (const double rpm : {0.0, 3.0}) {
        testing::Hour hour = testing::StrongDrift();
        hour.inclination_deg = inclination;
        hour.rpm = rpm;
        hour.minutes = 20;
        Job job = testing::JobOf(hour);
        job.depth.latency = latency;
        const AgeSink sink = Played(testing::SimulationOf(hour, 3), job);
        ExpectPrompt(sink, latency, 0.8, fmt::format("{} deg, {} rpm", inclination, rpm));
        EXPECT_LT(sink.worst, 4.5) << inclination << " deg, " << rpm << " rpm";
      }
    }
  }
}

// Marks at 2 Hz, a whole well in and out.
TEST(ToldAtOnce, InTheDemonstrationToo) {
  const std::filesystem::path demo = std::filesystem::path(WELLGYRO_DATA_DIR) / "demo";
  const auto file = ReadSimulation(demo / "simulation.toml");
  ASSERT_TRUE(file) << file.fault().text;
  auto job = ReadJob(demo / "job.toml");
  ASSERT_TRUE(job) << job.fault().text;
  for (const double latency : {1.0, 5.0}) {
    job->job.depth.latency = latency;
    ExpectPrompt(Played(file->simulation, job->job), latency, 0.8, "demonstration");
  }
}

}  // namespace
}  // namespace wellgyro
