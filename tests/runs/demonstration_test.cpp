// The bundled run with its tool's errors drawn afresh: a hole from vertical round through a build,
// in and out, adjusted as the program does.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/toml/job_file.h"
#include "wellgyro/io/toml/simulation_file.h"
#include "wellgyro/math/statistics.h"
#include "wellgyro/simulate/simulator.h"
#include "wellgyro/survey/surveyor.h"

#include "support/claims.h"
#include "support/simulated_survey.h"

namespace wellgyro {
namespace {

const std::filesystem::path kDemo = std::filesystem::path(WELLGYRO_DATA_DIR) / "demo";

// The demonstration's simulation with another seed, from which its errors are drawn.
Result<SimulationFile> WithSeed(std::uint64_t seed) {
  const std::filesystem::path path = kDemo / "simulation.toml";
  std::ifstream file(path);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  const std::string key = "\nseed = ";
  const std::size_t at = text.find(key) + key.size();
  return ParseSimulation(
      text.substr(0, at) + std::to_string(seed) + text.substr(text.find('\n', at)), path, kDemo);
}

constexpr int kRuns = WELLGYRO_LONG ? 20 : 1;

TEST(Demonstration, IsAsGoodAsItSaysFromVerticalToTheEnd) {
  const auto job = ReadJob(kDemo / "job.toml");
  ASSERT_TRUE(job) << job.fault().text;
  testing::Claims azimuth, inclination;
  double lean = 0, place = 0;
  int vertical = 0, runs = 0;
  for (int seed = 1; seed <= kRuns; ++seed, ++runs) {
    const auto file = WithSeed(static_cast<std::uint64_t>(seed));
    ASSERT_TRUE(file) << file.fault().text;
    const Simulation& simulation = file->simulation;
    Sink sink;
    const Survey survey = testing::SurveyOf(simulation, job->job, sink);
    ASSERT_EQ(survey.unusable, "");
    const TruthWell well = Truth(simulation).well();
    for (const Station& s : survey.chosen) {
      if (s.md < 50 || s.md > 590) continue;
      const double off = s.inclination - well.PointAt(s.md).inclination;
      lean += off * off / s.cov_md_inc_azi(1, 1);
      ++vertical;
    }
    const Station& last = survey.chosen.back();  // straight there: its depth does not turn it
    const WellPoint point = well.PointAt(last.md);
    azimuth.Add(WrapPi(last.azimuth - point.azimuth), last.cov_md_inc_azi(2, 2));
    inclination.Add(last.inclination - point.inclination, last.cov_md_inc_azi(1, 1));
    const Eigen::Vector3d off = last.p_WT_W - well.PlaceAt(last.md).p_WT_W;
    place += off.dot(last.cov_p_WT_W.inverse() * off);
  }
  azimuth.ExpectTrue("demonstration, end, azimuth");
  inclination.ExpectTrue("demonstration, end, inclination");
  std::printf("demonstration, vertical part, inclination: mean square %.2f of %d stations\n",
              lean / vertical, vertical);
  std::printf("demonstration, end, place: mean square %.2f of %d\n", place / (3 * runs), runs);
  // At vertical the inclination is the length of a lean in two directions, each of that sigma: two
  // is right. A run's lean is one: chi-square of two degrees a run, 99.9 %.
  EXPECT_GT(lean / vertical, ChiSquareQuantile(5e-4, 2 * kRuns) / kRuns);
  EXPECT_LT(lean / vertical, ChiSquareQuantile(1 - 5e-4, 2 * kRuns) / kRuns);
  // Depth counts twice in it, by where it labels a station and by where it moves the path.
  EXPECT_GT(place, 0.3 * ChiSquareQuantile(5e-4, 3 * runs));
  EXPECT_LT(place, ChiSquareQuantile(1 - 5e-4, 3 * runs));
}

}  // namespace
}  // namespace wellgyro
