// Wells past vertical by analytic motion: samples, increments, estimate against the truth.
#include "crossing.h"

#include <array>
#include <cmath>
#include <ostream>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "wellgyro/attitude/increment_builder.h"
#include "wellgyro/estimate/run_estimate.h"
#include "wellgyro/math/so3.h"
#include "wellgyro/math/statistics.h"

namespace wellgyro::test {
namespace {

constexpr double kHz = 10;

std::vector<RunKnot> BuiltKnots(const Crossing& crossing, const Crossing::Samples& samples,
                                const ToolDraw& draw) {
  IncrementOptions options;
  options.accel_noise = draw.accel_noise;
  options.angle_random_walk = draw.arw;
  options.accel_bias = draw.accel_bias;
  IncrementBuilder builder(options);
  std::vector<RunKnot> knots;
  const auto take = [&] {
    while (builder.Ready()) {
      RunKnot knot;
      knot.increment = builder.Pop();
      const double t = static_cast<double>(knot.increment.time.ns) * 1e-9;
      knot.along = {
          .md = crossing.speed * t, .speed = crossing.speed, .sigma_md = 0.003, .known = true};
      knots.push_back(knot);
    }
  };
  for (std::size_t j = 0; j < samples.w.size(); ++j) {
    ImuSample sample;
    sample.stamp.tool_time.ns = static_cast<std::int64_t>(j) * 100'000'000;
    sample.stamp.seq = static_cast<std::int64_t>(j);
    sample.stamp.period_ns = 100'000'000;
    sample.w_IT_T = samples.w[j];
    sample.w_IT_T.z() = 0;
    sample.f_T = samples.f[j];
    builder.Push(sample, false);
    if (j % 10 == 9) builder.Cut(1);
    take();
  }
  builder.Flush();
  take();
  return knots;
}

/// Normalised squares of the errors at the end (azimuth) and in the middle (tangent, toolface).
struct Score {
  double azimuth = 0, tangent = 0, toolface = 0, square = 0;
};

Score ScoreOf(const Crossing& crossing, std::uint64_t seed) {
  const ToolDraw draw;
  Crossing::Samples samples = crossing.Sample(kHz);
  AddErrors(draw, seed, samples);
  const std::vector<RunKnot> knots = BuiltKnots(crossing, samples, draw);
  EstimateSetup setup;
  setup.gyro.angle_random_walk = draw.arw;
  setup.errors.gyro_bias_sigma = draw.bias;
  setup.errors.accel_bias_sigma = draw.accel_bias;
  setup.errors.accel_noise = draw.accel_noise;
  setup.site = SiteAt(crossing.latitude_deg * M_PI / 180, 0);
  setup.site.gravity = crossing.gravity;
  const Eigen::Matrix3d R0 = crossing.At(0).R_LT;
  setup.ties.push_back({0, std::atan2(R0(1, 2), R0(0, 2)), 1e-5, false});
  const RunEstimate run = EstimateRun(setup, knots, {{{{0, R0}}}, {}}, {});
  EXPECT_TRUE(run.solved) << seed;
  Score score;
  if (!run.solved) return score;
  const auto error = [&](std::size_t node, double t) {
    return Eigen::Vector3d(Log(run.nodes[node].R_LT.transpose() * crossing.At(t).R_LT));
  };
  const std::size_t n = knots.size();
  const Eigen::Matrix3d& R = run.nodes[n].R_LT;
  const double horizontal2 = R(0, 2) * R(0, 2) + R(1, 2) * R(1, 2);
  const Eigen::RowVector3d by_phi =
      -Eigen::RowVector3d(-R(1, 2), R(0, 2), 0) * R * Skew(Eigen::Vector3d::UnitZ()) / horizontal2;
  const double azimuth = by_phi * error(n, crossing.seconds);
  score.square = azimuth * azimuth;
  score.azimuth = score.square / (by_phi * run.cov_phi_T[n] * by_phi.transpose());
  const Eigen::Vector3d middle = error(n / 2, crossing.seconds / 2);
  const Eigen::Matrix2d across = run.cov_phi_T[n / 2].topLeftCorner<2, 2>();
  score.tangent = middle.head<2>().dot(across.inverse() * middle.head<2>());
  score.toolface = middle.z() * middle.z() / run.cov_phi_T[n / 2](2, 2);
  return score;
}

void ExpectInBand(double sum, double freedom, const std::string& what) {
  EXPECT_GT(sum, ChiSquareQuantile(0.001, freedom)) << what << ", of " << freedom;
  EXPECT_LT(sum, ChiSquareQuantile(0.999, freedom)) << what << ", of " << freedom;
}

struct Cell {
  double rpm, closest_deg;
};

/// One way to roll past vertical: what of CrossingRoll is no steady roll.
struct Way {
  double pause = 0, swing_deg = 0, swing_period = 23, phase_walk = 0;
};

struct CellByWay {
  Cell cell;
  Way way;
};

void PrintTo(const CellByWay& c, std::ostream* out) {
  *out << c.cell.rpm << " rpm past " << c.cell.closest_deg << " deg, swinging " << c.way.swing_deg
       << " deg in " << c.way.swing_period << " s, phase " << c.way.phase_walk << ", pause "
       << c.way.pause << " s";
}

Crossing CrossingOf(const CellByWay& c, std::uint64_t seed) {
  Crossing crossing;
  crossing.closest_deg = c.cell.closest_deg;
  crossing.roll = {c.cell.rpm, c.way.pause, c.way.swing_deg, c.way.swing_period, c.way.phase_walk};
  if (c.way.phase_walk > 0) crossing.DrawPhase(seed + 1'000'000);
  return crossing;
}

class PastVertical : public testing::TestWithParam<CellByWay> {};

TEST_P(PastVertical, ErrorsAreThoseOfTheCovariance) {
  constexpr int kSeeds = WELLGYRO_CROSSING_SEEDS;
  Score sum;
  for (int i = 0; i < kSeeds; ++i) {
    const std::uint64_t seed = 5000 + static_cast<std::uint64_t>(i);
    const Score score = ScoreOf(CrossingOf(GetParam(), seed), seed);
    sum.azimuth += score.azimuth;
    sum.tangent += score.tangent;
    sum.toolface += score.toolface;
    sum.square += score.square;
  }
  RecordProperty("rms_deg", std::to_string(std::sqrt(sum.square / kSeeds) * 180 / M_PI));
  printf("rms %.4f deg, azimuth %.2f, tangent %.2f, toolface %.2f\n",
         std::sqrt(sum.square / kSeeds) * 180 / M_PI, sum.azimuth / kSeeds,
         sum.tangent / (2 * kSeeds), sum.toolface / kSeeds);
  ExpectInBand(sum.azimuth, kSeeds, "azimuth");
  ExpectInBand(sum.tangent, 2 * kSeeds, "tangent");
  ExpectInBand(sum.toolface, kSeeds, "toolface");
}

auto Cells(const std::vector<Cell>& cells, const Way& way) {
  std::vector<CellByWay> all;
  for (const Cell& cell : cells) all.push_back({cell, way});
  return testing::ValuesIn(all);
}

const std::vector<Cell> kTen{{0, .05}, {0, .2},  {0, .5}, {0, 2},  {.3, .05},
                             {.3, .5}, {3, .05}, {3, .2}, {3, .5}, {3, 2}};
const std::vector<Cell> kRolling(kTen.begin() + 4, kTen.end());
const std::vector<Cell> kSliding(kTen.begin(), kTen.begin() + 3);

INSTANTIATE_TEST_SUITE_P(Steady, PastVertical, Cells(kTen, {}));
INSTANTIATE_TEST_SUITE_P(Swinging, PastVertical, Cells(kTen, {.swing_deg = 25}));
INSTANTIATE_TEST_SUITE_P(SwingingFast, PastVertical,
                         Cells(kTen, {.swing_deg = 5, .swing_period = 7}));
INSTANTIATE_TEST_SUITE_P(ByTurns, PastVertical, Cells(kRolling, {.pause = 60}));
INSTANTIATE_TEST_SUITE_P(Wandering, PastVertical,
                         Cells(kSliding, {.swing_deg = 25, .phase_walk = 0.05}));

}  // namespace
}  // namespace wellgyro::test
