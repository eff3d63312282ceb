// A station is told when the samples around it have come, not when its knots are done with.
#include <algorithm>
#include <cmath>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

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

// Minutes behind the only stop, when bias and heading are just being told apart.
TEST(ToldAtOnce, SoonAfterAStopItIsAsSureAsItSays) {
  constexpr double kThen = 350;  // [s]
  for (const double inclination : {40.0, 88.0}) {
    testing::Claims claims;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
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

TEST(ToldAtOnce, AStationIsASecondOlderThanItsDepth) {
  for (const double inclination : {5.0, 40.0, 88.0}) {
    for (const double rpm : {0.0, 3.0}) {
      testing::Hour hour = testing::StrongDrift();
      hour.inclination_deg = inclination;
      hour.rpm = rpm;
      hour.minutes = 20;
      const Simulation simulation = testing::SimulationOf(hour, 3);
      const Job job = testing::JobOf(hour);
      AgeSink sink(simulation);
      Surveyor surveyor(job, sink);
      testing::Play(simulation, surveyor, [&sink](const SimulatedStep& step) {
        if (const auto* sample = std::get_if<ImuSample>(&step)) {
          sink.now = sample->stamp.utc + Duration{sample->stamp.period_ns};
        }
        return true;
      });
      // A sample waits for its depth: marks of two seconds ahead, each as late as it may be, or of
      // as much as may lie between two.
      const DepthSpec& depth = job.depth;
      const double late = depth.latency + std::max(2 + depth.latency, depth.max_gap) + 1;
      const auto prompt = std::count_if(sink.ages.begin(), sink.ages.end(),
                                        [late](double age) { return age <= late; });
      ASSERT_GT(sink.ages.size(), 20u) << inclination << " deg, " << rpm << " rpm";
      EXPECT_GT(prompt, 0.8 * static_cast<double>(sink.ages.size()))
          << inclination << " deg, " << rpm << " rpm, oldest "
          << *std::max_element(sink.ages.begin(), sink.ages.end()) << " s";
      EXPECT_LT(sink.worst, 4.5) << inclination << " deg, " << rpm << " rpm";
    }
  }
}

}  // namespace
}  // namespace wellgyro
