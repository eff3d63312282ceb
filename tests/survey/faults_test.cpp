// What goes wrong in samples and marks, put into a simulated run, is seen and said.
#include <array>
#include <cmath>
#include <functional>
#include <ostream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/math/random.h"
#include "wellgyro/simulate/tool_errors.h"
#include "wellgyro/survey/intake/sample_watch.h"
#include "wellgyro/survey/intake/truncation_watch.h"
#include "wellgyro/survey/verdict/verdict.h"

#include "support/simulated_survey.h"

namespace wellgyro {
namespace {

using testing::CollectingSink;
using testing::Find;
using testing::SurveyOf;
using Cause = SimulatedFault::Cause;

/// Twelve minutes down a hole that builds and turns, with a stop at each end and one on the way.
struct Flight {
  Flight() {
    simulation.well.end_md = 600;
    simulation.well.inclination.start = FromDegrees(30);
    simulation.well.inclination.terms.push_back({.rate = 3 * units::kDegPer30m});
    simulation.well.azimuth.start = FromDegrees(40);
    simulation.well.azimuth.terms.push_back({.rate = units::kDegPer30m});
    simulation.earth.latitude = FromDegrees(60);
    simulation.run.roll_reference = RollReference::kHighSide;
    RunMove down;
    down.speed = 0.8;
    down.roll.rate = kTwoPi / 60;
    down.to_md = 150;
    simulation.run.steps.push_back(RunStop{.seconds = 150});
    simulation.run.steps.push_back(down);
    simulation.run.steps.push_back(RunStop{.seconds = 150});
    down.to_md = 400;
    simulation.run.steps.push_back(down);
    simulation.run.steps.push_back(RunStop{.seconds = 60});
    simulation.streams.imu_hz = 10;
    simulation.streams.depth_hz = 2;
    job.well.latitude = FromDegrees(60);
    job.noise.angle_random_walk = 0.005 * units::kDegPerSqrtHour;
    job.errors.gyro_bias_sigma = 0.1 * units::kDegPerHour;
    job.errors.mass_unbalance_sigma = 0.02 * units::kDegPerHourPerG;
    job.errors.accel_bias_sigma = 5e-4;
    job.errors.accel_noise = 2e-4;
    job.errors.depth_sigma = 0.3;
    simulation.tool.errors = DrawToolErrors(job.errors, job.noise, 4);
    simulation.tool.errors.depth_resolution = 0.01;
    simulation.seed = 4;
  }
  Survey Surveyed() {
    CollectingSink sink;
    const Survey survey = SurveyOf(simulation, job, sink, arrives);
    faults = sink.faults;
    return survey;
  }
  void Add(Cause cause, double size, double begin = 0, int axis = 0, double period = 0) {
    simulation.faults.push_back(
        {.cause = cause, .axis = axis, .begin = begin, .size = size, .period = period});
  }
  void AddUntil(Cause cause, double begin, double end, double size = 0, int axis = 0) {
    simulation.faults.push_back(
        {.cause = cause, .axis = axis, .begin = begin, .end = end, .size = size});
  }

  Simulation simulation;
  Job job;
  /// Every sample and mark as the converter of a log makes it.
  void Converted(const std::function<void(ImuSample&)>& sample,
                 const std::function<void(DepthMark&)>& mark = {}) {
    arrives = [sample, mark](SimulatedStep& step) {
      if (auto* of_tool = std::get_if<ImuSample>(&step); of_tool && sample) sample(*of_tool);
      if (auto* of_rig = std::get_if<DepthMark>(&step); of_rig && mark) mark(*of_rig);
      return true;
    };
  }

  std::vector<Fault> faults;
  testing::Arrives arrives;
};

TEST(Faults, ARunWithoutAnyHasNoneSaid) {
  Flight flight;
  const Survey survey = flight.Surveyed();
  ASSERT_EQ(survey.unusable, "");
  EXPECT_TRUE(flight.faults.empty());
  for (const char* code :
       {"gyro_stuck", "accel_stuck", "axes", "gyro_unit", "rest_motion", "depth_jump", "depth_unit",
        "accel_unit", "gyro_spikes", "accel_spikes"}) {
    const Check* check = Find(survey, code);
    ASSERT_NE(check, nullptr) << code;
    EXPECT_EQ(check->verdict, Verdict::kPass) << code << " " << check->limit_source;
  }
  EXPECT_NE(survey.verdict.verdict, Verdict::kFail) << CauseOf(survey.checks.front());
}

/// Two minutes of a run that rolls once a minute, whose gyro x is read in steps of `step` sigmas of
/// its noise, and which repeats one value from `frozen` on [s].
Check StuckGyroOf(double step, double frozen) {
  Job job;
  job.noise.angle_random_walk = 0.005 * units::kDegPerSqrtHour;
  job.errors.accel_noise = 2e-4;
  SampleWatch watch(job);
  Random random(8);
  const double sigma = job.noise.angle_random_walk / std::sqrt(0.1);
  double value = 0;
  for (int k = 0; k < 1200; ++k) {
    ImuSample sample;
    sample.stamp.session = 1;
    sample.stamp.seq = k;
    sample.stamp.tool_time.ns = 100'000'000LL * k;
    sample.stamp.period_ns = 100'000'000;
    const double read = 1e-3 * std::sin(kTwoPi * k / 600) + sigma * random.Normal();
    if (0.1 * k < frozen) value = step * sigma * std::round(read / (step * sigma));
    sample.w_IT_T = {value, sigma * random.Normal(), 0};
    sample.f_T = {1 + 6e-4 * random.Normal(), 6e-4 * random.Normal(), -9.7};
    AlongHoleBlock along;
    along.Set(0, {.md = 0.05 * k, .speed = 0.5, .known = true});
    watch.Push({&sample, 1}, along, 0);
  }
  for (const Check& check : watch.Checks(1, {})) {
    if (check.code.starts_with("gyro_stuck") || check.code.starts_with("gyro_dead")) return check;
  }
  return {};
}

/// Of a straight horizontal hole eastwards on the equator, in which the tool rolls at 1 rpm and the
/// Earth's rate is across it and level. `swapped`: the gyros, in a hole that builds besides.
Check AxesOf(bool swapped) {
  Job job;
  SampleWatch watch(job);
  const double bend = swapped ? FromDegrees(3.0 / 60) : 0;  // [rad/s], 3 deg/30 m at 0.5 m/s
  for (int k = 0; k < 3000; ++k) {
    const double roll = kTwoPi * k / 60;
    ImuSample sample;
    sample.stamp.session = 1;
    sample.stamp.seq = k;
    sample.stamp.tool_time.ns = 1'000'000'000LL * k;
    sample.stamp.period_ns = 1'000'000'000;
    const Eigen::Vector2d up(std::cos(roll), std::sin(roll)), level(-up.y(), up.x());
    const double lean = std::sin(bend * k);
    sample.w_IT_T.head<2>() = (kEarthRate + bend) * level;
    if (swapped) std::swap(sample.w_IT_T.x(), sample.w_IT_T.y());
    sample.f_T << 9.81 * std::sqrt(1 - lean * lean) * up, 9.81 * lean;
    AlongHoleBlock along;
    along.Set(0, {.md = 0.5 * k, .speed = 0.5, .known = true});
    watch.Push({&sample, 1}, along, 0);
    if (swapped && k > 600) break;
  }
  for (const Check& check : watch.Checks(1, {})) {
    if (check.code.starts_with("axes")) return check;
  }
  return {};
}

TEST(Faults, AHoleThatGoesEastDoesNotSwapTheAxes) {
  EXPECT_EQ(AxesOf(false).verdict, Verdict::kNotDone) << AxesOf(false).limit_source;
  const Check swapped = AxesOf(true);
  EXPECT_EQ(swapped.code, "axes");
  EXPECT_EQ(swapped.verdict, Verdict::kFail);
  EXPECT_EQ(swapped.limit_source, "gyros x and y swapped");
}

TEST(Faults, ACoarseConverterIsNotStuck) {
  EXPECT_EQ(StuckGyroOf(0.5, 200).verdict, Verdict::kPass);
  EXPECT_EQ(StuckGyroOf(10, 200).verdict, Verdict::kPass) << "steps wider than the noise";
  const Check stuck = StuckGyroOf(0.5, 100);
  EXPECT_EQ(stuck.verdict, Verdict::kFail);
  EXPECT_NEAR(stuck.value.value_or(0), 20, 1);
}

// Within ten seconds it turns by up to six times what the Earth does, and by as much back.
TEST(Faults, AToolThatWhirlsAtRestHasNoWrongUnit) {
  Flight flight;
  flight.simulation.faults.push_back(
      {.cause = Cause::kWhirl, .size = FromDegrees(0.3), .period = 0.6});
  const Survey survey = flight.Surveyed();
  const Check* unit = Find(survey, "gyro_unit");
  ASSERT_NE(unit, nullptr);
  EXPECT_NE(unit->verdict, Verdict::kFail) << unit->limit_source;
  const Check* motion = Find(survey, "rest_motion");
  ASSERT_NE(motion, nullptr);
  EXPECT_NE(motion->verdict, Verdict::kPass);
}

struct Wrong {
  std::string code;
  std::function<void(Flight&)> make;
  std::string words = {};  ///< in what the check says
  Verdict verdict = Verdict::kFail;
};
void PrintTo(const Wrong& wrong, std::ostream* out) { *out << wrong.code << " " << wrong.words; }

class FaultIsSaid : public ::testing::TestWithParam<Wrong> {};

TEST_P(FaultIsSaid, ByTheCheckThatIsItsOwn) {
  Flight flight;
  GetParam().make(flight);
  const Survey survey = flight.Surveyed();
  const Check* check = Find(survey, GetParam().code);
  ASSERT_NE(check, nullptr);
  EXPECT_EQ(check->verdict, GetParam().verdict)
      << check->value.value_or(0) << " against " << check->limit.value_or(0) << ", "
      << check->limit_source;
  EXPECT_NE(check->limit_source.find(GetParam().words), std::string::npos) << check->limit_source;
  if (GetParam().verdict != Verdict::kFail || survey.passes.empty()) return;
  EXPECT_EQ(survey.runs[0].verdict.verdict, Verdict::kFail);
  for (const Station& s : survey.passes) EXPECT_TRUE(Has(s.quality, Quality::kUnfit));
}

INSTANTIATE_TEST_SUITE_P(
    Each, FaultIsSaid,
    ::testing::Values(
        Wrong{"gyro_stuck", [](Flight& f) { f.AddUntil(Cause::kGyroStuck, 250, 270); }, "gyro x"},
        Wrong{"accel_stuck", [](Flight& f) { f.AddUntil(Cause::kAccelStuck, 250, 260, 0, 1); },
              "accel y"},
        Wrong{"gyro_dead", [](Flight& f) { f.Add(Cause::kGyroDead, 0, 0, 1); }, "gyro y"},
        Wrong{"accel_dead", [](Flight& f) { f.Add(Cause::kAccelDead, 0, 0, 2); }, "accel z"},
        Wrong{"axes", [](Flight& f) { f.Add(Cause::kGyroInverted, 0); }, "gyro x inverted"},
        Wrong{"axes", [](Flight& f) { f.Add(Cause::kGyroInverted, 0, 0, 1); }, "gyro y inverted"},
        Wrong{"axes", [](Flight& f) { f.Add(Cause::kAccelInverted, 0); },
              "accelerometer x or gyro y"},
        Wrong{"axes", [](Flight& f) { f.Add(Cause::kGyrosSwapped, 0); }, "gyros x and y swapped"},
        Wrong{"axes", [](Flight& f) { f.Add(Cause::kAccelsSwapped, 0); },
              "accelerometers x and y swapped"},
        Wrong{"axes_change", [](Flight& f) { f.AddUntil(Cause::kGyroInverted, 290, 350); },
              "gyro x inverted"},
        Wrong{"axes_change", [](Flight& f) { f.AddUntil(Cause::kAccelInverted, 290, 350); },
              "accelerometer x or gyro y"},
        Wrong{
            "accel_unit",
            [](Flight& f) { f.Converted([](ImuSample& s) { s.f_T /= units::kStandardGravity; }); },
            "g taken for m/s2"},
        Wrong{"depth_unit",
              [](Flight& f) { f.Converted({}, [](DepthMark& m) { m.md /= 0.3048; }); },
              "depths in feet are taken for metres"},
        Wrong{"depth_unit",
              [](Flight& f) { f.Converted({}, [](DepthMark& m) { m.md *= 0.3048; }); },
              "depths in metres are taken for feet"},
        Wrong{"depth_reversed",
              [](Flight& f) { f.Converted({}, [](DepthMark& m) { m.md = 500 - m.md; }); }},
        Wrong{"tool_upside_down",
              [](Flight& f) {
                f.Converted([](ImuSample& s) {
                  s.w_IT_T.tail<2>() *= -1;
                  s.f_T.tail<2>() *= -1;
                });
              }},
        Wrong{"gyro_unit", [](Flight& f) { f.Add(Cause::kGyroUnit, 57.3); }},
        Wrong{"gyro_unit", [](Flight& f) { f.Add(Cause::kGyroUnit, 1 / 57.3); }},
        Wrong{"gyro_unit", [](Flight& f) { f.Add(Cause::kGyroUnit, 0.5); }},
        Wrong{"gyro_spikes", [](Flight& f) { f.Add(Cause::kGyroSpike, FromDegrees(1), 30, 0, 60); },
              "every sample", Verdict::kWarn},
        Wrong{"accel_spikes", [](Flight& f) { f.Add(Cause::kAccelSpike, 1, 30, 1, 0.7); },
              "every sample"},
        Wrong{"rest_motion",
              [](Flight& f) { f.AddUntil(Cause::kRestCreep, 5, 145, FromDegrees(0.05) / 60); },
              "still", Verdict::kWarn},
        Wrong{"rest_motion",
              [](Flight& f) {
                f.simulation.faults.push_back({.cause = Cause::kSwing,
                                               .begin = 5,
                                               .end = 145,
                                               .size = FromDegrees(0.1),
                                               .period = 4});
              },
              "still", Verdict::kWarn},
        Wrong{"depth_jump", [](Flight& f) { f.Add(Cause::kDepthStep, 1, 260); }},
        Wrong{"depth_lag", [](Flight& f) { f.Add(Cause::kDepthLag, 0.5); }}));

// Of 7 arcsec a pulse one axis reads nothing for seconds, and pulses stand alone.
TEST(Faults, AGyroThatCountsPulsesIsNeitherStuckNorSpiked) {
  Flight flight;
  flight.job.noise.quantization = 2 * units::kArcsec;
  flight.simulation.tool.errors.gyro_noise.quantization = 2 * units::kArcsec;
  const Survey survey = flight.Surveyed();
  ASSERT_EQ(survey.unusable, "");
  for (const char* code : {"gyro_stuck", "gyro_spikes", "gyro_truncated", "gyro_unit", "fit"}) {
    const Check* check = Find(survey, code);
    ASSERT_NE(check, nullptr) << code;
    EXPECT_NE(check->verdict, Verdict::kFail) << code << " " << check->limit_source;
  }
  EXPECT_EQ(survey.runs[0].samples_gyro_mended, 0);
  ASSERT_FALSE(survey.runs[0].fixes.empty());
  for (const NorthFix& fix : survey.runs[0].fixes) {
    EXPECT_NEAR(*fix.earth_rate, fix.earth_rate_ref, 5 * fix.sigma_earth_rate);
  }
}

// The sentence of a survey that cannot be made says why first.
TEST(Faults, WrongUnitsStandInFrontOfWhatLacksByThem) {
  Flight flight;
  flight.Converted([](ImuSample& s) { s.f_T *= 1000 / units::kStandardGravity; });
  const Survey survey = flight.Surveyed();
  EXPECT_TRUE(survey.unusable.starts_with("the accelerometers' unit or scale is wrong"))
      << survey.unusable;
}

// Of a dead axis the gyros' unit is no measure.
TEST(Faults, ADeadAxisStandsInFrontOfAUnit) {
  Flight flight;
  flight.Converted([](ImuSample& s) {
    s.f_T.y() = 0;
    s.w_IT_T *= 57.3;
  });
  const Survey survey = flight.Surveyed();
  EXPECT_TRUE(survey.unusable.starts_with("an accelerometer axis does not answer"))
      << survey.unusable;
}

// Motion is felt by gyros and accelerometers together: of inverted axes depth is not blamed.
TEST(Faults, DepthIsNotBlamedForAxes) {
  Flight flight;
  flight.AddUntil(Cause::kGyroInverted, 290, 350);
  const Survey survey = flight.Surveyed();
  for (const char* code : {"depth_jump", "depth_unit", "depth_lag", "gyro_unit"}) {
    const Check* check = Find(survey, code);
    ASSERT_NE(check, nullptr) << code;
    EXPECT_EQ(check->verdict, Verdict::kNotDone) << code;
  }
}

enum class Converter { kRounds, kFloors, kCuts };

/// Two gyros of a tool that rolls once a minute for an hour, with five rests of two minutes at
/// zero; steps and noise in units of 1e-6 rad/s.
TruncationWatch::Found TruncationOf(Converter converter, double step, double noise) {
  Random random(17);
  std::array<TruncationWatch, 2> axes;
  for (int k = 0; k < 36000; ++k) {
    for (std::size_t i = 0; i < 2; ++i) {
      const double roll = kTwoPi * k / 600 + static_cast<double>(i);
      const bool rests = k % 7200 < 1200;
      const double read = (rests ? 0 : 60 * std::sin(roll)) + noise * random.Normal();
      const double level = read / step;
      const double whole = converter == Converter::kRounds   ? std::round(level)
                           : converter == Converter::kFloors ? std::floor(level)
                                                             : std::trunc(level);
      axes[i].Push(1e-6 * step * whole, 1e-6 * step);
    }
  }
  return TruncationWatch::Of(axes[0], axes[1]);
}

TEST(Faults, OfAConverterThatCutsTheLevelZeroIsTwiceAsWide) {
  for (const auto& [step, noise] : {std::pair{5., 4.6}, {10., 4.6}, {20., 4.6}, {10., 0.5}}) {
    for (const Converter converter : {Converter::kRounds, Converter::kFloors}) {
      const auto found = TruncationOf(converter, step, noise);
      EXPECT_LT(found.ln_ratio, 5 * found.sigma) << step << " " << noise;
    }
    const auto found = TruncationOf(Converter::kCuts, step, noise);
    EXPECT_GT(found.ln_ratio, 5 * found.sigma) << step << " " << noise;
    EXPECT_GT(found.sigma, 0);
    // Noise of a step's size smears the level: no more than ln 2, and half of it at the least.
    EXPECT_LT(found.ln_ratio, std::log(2.0) + 4 * found.sigma) << step << " " << noise;
    EXPECT_GT(found.ln_ratio, std::log(2.0) / 2) << step << " " << noise;
  }
}

TEST(Faults, SpikesAreReplacedAndToldByRange) {
  Flight clean, spiked;
  spiked.Add(Cause::kGyroSpike, FromDegrees(1), 170, 0, 20);
  const Survey was = clean.Surveyed(), is = spiked.Surveyed();
  ASSERT_EQ(was.chosen.size(), is.chosen.size());
  const Station &a = was.chosen.back(), &b = is.chosen.back();
  const double sigma = std::sqrt(a.cov_md_inc_azi(2, 2));
  EXPECT_LT(std::abs(WrapPi(a.azimuth - b.azimuth)), 0.2 * sigma);
  EXPECT_NEAR(std::sqrt(b.cov_md_inc_azi(2, 2)), sigma, 0.01 * sigma);
  EXPECT_EQ(is.runs[0].samples_gyro_mended, (is.runs[0].samples / 10 - 170 + 19) / 20);
  ASSERT_FALSE(spiked.faults.empty());
  EXPECT_NE(spiked.faults.front().text.find("1700 to 1700 of session 1"), std::string::npos)
      << spiked.faults.front().text;
}

TEST(Faults, AveragesThatNoToolAtRestHasAreLeftOut) {
  Job job;
  CollectingSink sink;
  Surveyor surveyor(job, sink);
  StillWindow window;
  window.utc_begin.ns = 1'700'000'000'000'000'000;
  window.utc_end.ns = window.utc_begin.ns + 120'000'000'000;
  window.md = 100;
  window.f_T = {4.9, 0, -8.5};
  window.w_IT_T = {5e-5, 0, 0};
  surveyor.Push(window);
  EXPECT_TRUE(sink.faults.empty());
  window.f_T *= 0.9;
  surveyor.Push(window);
  EXPECT_EQ(sink.faults.size(), 1u) << "0.9 g";
  window.f_T /= 0.9;
  window.w_IT_T.x() = FromDegrees(1);
  surveyor.Push(window);
  EXPECT_EQ(sink.faults.size(), 2u) << "1 deg/s";
}

TEST(Faults, AnUnverifiedDepthScaleStandsInTheSigma) {
  Flight flight;
  const Survey without = flight.Surveyed();
  flight.job.errors.depth_scale_sigma = 1e-3;
  const Survey with = flight.Surveyed();
  const Station &a = without.chosen.back(), &b = with.chosen.back();
  const double whole = std::pow(1e-3 * b.md, 2);
  EXPECT_NEAR(b.cov_md_inc_azi(0, 0) - a.cov_md_inc_azi(0, 0), whole, 1e-6);
  // Along the hole and across it: the trace grows by the way's square and by the path's bow.
  const double more = (b.cov_p_WT_W - a.cov_p_WT_W).trace();
  EXPECT_GT(more, whole);
  EXPECT_LT(more, 2 * whole);
  const Check* check = Find(with, "depth_scale");
  ASSERT_NE(check, nullptr);
  EXPECT_EQ(check->verdict, Verdict::kNotDone);
  EXPECT_NE(check->limit_source.find("unverified"), std::string::npos);
}

}  // namespace
}  // namespace wellgyro
