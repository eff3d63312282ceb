#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/calibration/group_solution_internal.h"
#include "wellgyro/calibration/sample_lanes_internal.h"
#include "wellgyro/calibration/thermometer.h"

#include "calibration/random_tool.h"

// Four samples at once and eight, where the processor takes them: the same bytes.
namespace wellgyro {
namespace {

using test::RandomTool;
using test::ToolShape;

/// Numbers of a run, of both ways.
struct Ways {
  Vectors four{}, eight{};
  bool Same(std::size_t n) const {
    for (std::size_t i = 0; i < 3; ++i) {
      if (std::memcmp(four[i].data(), eight[i].data(), n * sizeof(double)) != 0) return false;
    }
    return true;
  }
};

struct Beside {
  Counts counts{};
  OfRun<float> x{}, heating_rate{};
  Vectors f{};
  OfRun<double> per_second{};
};

Beside RandomBeside(Random& random) {
  Beside beside;
  for (std::size_t k = 0; k < beside.x.size(); ++k) {
    beside.x[k] = static_cast<float>(random.Uniform());
    beside.heating_rate[k] = static_cast<float>(0.1 * random.Normal());
    beside.per_second[k] = 90 + 20 * random.Uniform();
    for (auto& f : beside.f) f[k] = 10 * random.Normal();
    // Of all sizes: some are too large for products in single precision.
    const double scale = std::pow(10, -4 * random.Uniform());
    for (auto& counts : beside.counts) {
      counts[k] = static_cast<std::int32_t>(3e8 * scale * random.Normal());
    }
  }
  return beside;
}

TEST(LanesOfSamples, SolveToTheSameBytes) {
  if (MostLanes() == Lanes::kFour) GTEST_SKIP() << "this processor takes four";
  Random random(1);
  for (unsigned what = 0; what < 32; ++what) {
    SCOPED_TRACE(what);
    ToolCalibration tool = RandomTool(what, {.gyro_channels = (what & 1) != 0 ? 4 : 3,
                                             .temperature = (what & 2) != 0,
                                             .second_order = (what & 4) != 0,
                                             .g_terms = (what & 8) != 0});
    if ((what & 8) != 0) tool.gyro.heating.setConstant(0.1);
    tool.gyro.per_second = (what & 16) != 0;
    GroupSolution solution(tool.gyro, units::kDeg);
    solution.Enter(87);
    const Beside beside = RandomBeside(random);
    const Readings readings{beside.counts.data(), beside.x, beside.heating_rate, beside.f,
                            beside.per_second};
    Ways u;
    Solve(Lanes::kFour, solution.kernel(), readings, {0, kRun}, u.four);
    // Where a part begins does not matter either.
    Solve(Lanes::kEight, solution.kernel(), readings, {0, 5}, u.eight);
    Solve(Lanes::kEight, solution.kernel(), readings, {5, kRun}, u.eight);
    EXPECT_TRUE(u.Same(kRun));
    EXPECT_NE(u.four[0][0], u.four[0][1]);
  }
}

TEST(LanesOfSamples, TakeTheSameTemperatures) {
  const ToolCalibration tool = RandomTool(2, {.temperature = true});
  const ThermometerCalibration& thermometer = tool.thermometers[0];
  Random random(3);
  std::vector<RawSample> raw(kRun);
  for (RawSample& sample : raw) {
    sample.temperature_raw[2] = static_cast<float>(3 * random.Uniform());
  }
  raw[3].temperature_raw[2] = std::nanf("");
  raw[12].temperature_raw[2] = -HUGE_VALF;
  OfRun<double> four{}, eight{};
  OfRun<std::int64_t> in_four, in_eight;
  in_four.fill(-1);
  in_eight.fill(-1);
  for (std::size_t k = 0; k < kRun; k += kPiece) {
    const Apart readings{reinterpret_cast<const std::byte*>(&raw[k].temperature_raw[2]),
                         sizeof(RawSample)};
    TakeTemperatures(Lanes::kFour, thermometer, readings, k, four, in_four);
    TakeTemperatures(MostLanes(), thermometer, readings, k, eight, in_eight);
  }
  for (std::size_t k = 0; k < kRun; ++k) {
    const Temperature expected =
        TrueTemperature(thermometer, static_cast<double>(raw[k].temperature_raw[2]));
    EXPECT_EQ(four[k], expected.value);
    EXPECT_EQ(eight[k], expected.value);
    EXPECT_EQ(in_four[k], expected.inside ? -1 : 0);
    EXPECT_EQ(in_eight[k], expected.inside ? -1 : 0);
  }
  OfRun<float> x_four{}, x_eight{};
  CellPlace cell{.min = 20, .max = 160, .per_width = 0.5, .index = 3};
  EXPECT_FALSE(Place(Lanes::kFour, cell, four, {0, kRun}, x_four, in_four));
  EXPECT_FALSE(Place(MostLanes(), cell, eight, {0, kRun}, x_eight, in_eight));
  EXPECT_EQ(x_four, x_eight);
  EXPECT_EQ(in_four, in_eight);
  four.fill(27.5);  // from 26 to 28 degC
  EXPECT_TRUE(Place(Lanes::kFour, cell, four, {0, kRun}, x_four, in_four));
  EXPECT_TRUE(Place(MostLanes(), cell, four, {0, kRun}, x_eight, in_eight));
  EXPECT_EQ(x_four[0], 0.75F);
  EXPECT_EQ(x_eight[0], 0.75F);
}

TEST(LanesOfSamples, HaveEachNumberInItsPlace) {
  // Thirteen: whole eights, fours and twos, and one more.
  constexpr std::size_t kSamples = 13;
  std::vector<RawSample> raw(kSamples);
  Vectors w{}, f{}, b{};
  std::array<double, kSamples> temperature{};
  for (std::size_t k = 0; k < kSamples; ++k) {
    temperature[k] = 0.1 + static_cast<double>(k);
    raw[k].stamp = {.tool_time = {static_cast<std::int64_t>(k)},
                    .seq = static_cast<std::int64_t>(10 + k),
                    .period_ns = static_cast<std::int32_t>(20 + k),
                    .gyro_saturated = k % 2 != 0,
                    .simulated = k % 3 != 0};
    for (std::size_t c = 0; c < 10; ++c) raw[k].counts[c] = static_cast<std::int32_t>(100 * k + c);
    for (std::size_t i = 0; i < 3; ++i) {
      w[i][k] = static_cast<double>(100 * k + i);
      f[i][k] = static_cast<double>(100 * k + 10 + i);
      b[i][k] = static_cast<double>(100 * k + 20 + i);
    }
  }
  for (const Lanes lanes : {Lanes::kFour, MostLanes()}) {
    const auto counts = std::make_unique<Counts>();
    Transpose(lanes, raw, 10, 2, *counts);
    std::vector<ImuSample> out(kSamples);
    Put(lanes, w, f, b, out);
    for (std::size_t k = 0; k < kSamples; ++k) {
      const auto n = static_cast<double>(100 * k);
      for (std::size_t c = 0; c < 10; ++c) EXPECT_EQ((*counts)[c][2 + k], raw[k].counts[c]);
      EXPECT_EQ(out[k].w_IT_T, Eigen::Vector3d(n, n + 1, n + 2));
      EXPECT_EQ(out[k].f_T, Eigen::Vector3d(n + 10, n + 11, n + 12));
      EXPECT_EQ(out[k].b_T, Eigen::Vector3d(n + 20, n + 21, n + 22));
      EXPECT_FALSE(out[k].has_gz || out[k].has_mag);
    }
    Stamp(lanes, raw, temperature.data(), true, false, out.data());
    for (std::size_t k = 0; k < kSamples; ++k) {
      EXPECT_EQ(out[k].stamp.tool_time.ns, raw[k].stamp.tool_time.ns);
      EXPECT_EQ(out[k].stamp.seq, raw[k].stamp.seq);
      EXPECT_EQ(out[k].stamp.period_ns, raw[k].stamp.period_ns);
      EXPECT_EQ(out[k].stamp.gyro_saturated, raw[k].stamp.gyro_saturated);
      EXPECT_EQ(out[k].stamp.simulated, raw[k].stamp.simulated);
      EXPECT_FALSE(out[k].stamp.temperature_outside);
      EXPECT_EQ(out[k].stamp.temperature, static_cast<float>(temperature[k]));
      EXPECT_EQ(out[k].w_IT_T[0], static_cast<double>(100 * k));
      EXPECT_TRUE(out[k].has_gz);
      EXPECT_FALSE(out[k].has_mag);
    }
  }
}

}  // namespace
}  // namespace wellgyro
