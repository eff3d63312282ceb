#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/attitude/tracker.h"
#include "wellgyro/base/angle.h"
#include "wellgyro/math/random.h"
#include "wellgyro/math/statistics.h"

#include "attitude/tracker_truth.h"

namespace wellgyro {
namespace {

using truth::Flight;
using truth::Motion;

const Site kSite = truth::SiteOf(FromDegrees(60));

std::vector<ImuSample> Samples(const truth::Path& path, double rate, double seconds,
                               const truth::Sensors& sensors = {}) {
  std::vector<ImuSample> samples;
  for (std::int64_t k = 0; k < static_cast<std::int64_t>(rate * seconds); ++k) {
    samples.push_back(truth::SampleAt(path, sensors, kSite, k, rate));
  }
  return samples;
}

AlongHole AlongAt(const truth::Path& path, const ImuSample& sample) {
  const auto middle = sample.stamp.tool_time.ns + sample.stamp.period_ns / 2;
  return truth::AlongAt(path, 1e-9 * static_cast<double>(middle));
}

double Begin(const ImuSample& sample) {
  return 1e-9 * static_cast<double>(sample.stamp.tool_time.ns);
}

bool Push(HighSideTracker& tracker, const truth::Path& path, const ImuSample& sample) {
  return tracker.Push(sample, AlongAt(path, sample), kSite);
}

TEST(TrackerKnots, SumsDoNotDependOnTheCuts) {
  const truth::Path path = truth::Hour(20);
  HighSideTracker whole({}), pieces({});
  Random random(11);
  Knot sum;
  const auto take = [&](const Knot& knot) {
    sum.seconds += knot.seconds;
    sum.turn += knot.turn;
    sum.cot += knot.cot;
    sum.lift += knot.lift;
    sum.roll += knot.roll;
    sum.d_turn += knot.d_turn;
    sum.d_lift += knot.d_lift;
    sum.white_turn += knot.white_turn;
    sum.inclination_accel += knot.seconds * knot.inclination_accel;
    sum.inclination = knot.inclination;
    sum.d_inclination = knot.d_inclination;
  };
  int cuts = 0;
  for (const ImuSample& sample : Samples(path, 10, 120)) {
    Push(whole, path, sample);
    Push(pieces, path, sample);
    if (!pieces.ready() || random.Uniform() > 0.3) continue;
    const double first = 0.5 * random.Uniform() + 1e-3;
    take(pieces.CutKnot(first));
    if (random.Uniform() < 0.5) take(pieces.CutKnot(first + 0.4));
    ++cuts;
  }
  whole.Flush();
  pieces.Flush();
  take(pieces.CutKnot());
  const Knot knot = whole.CutKnot();
  EXPECT_GT(cuts, 300);
  EXPECT_NEAR(sum.seconds, 120, 1e-6);
  EXPECT_NEAR(sum.turn, knot.turn, 1e-14 * 1200);
  EXPECT_NEAR(sum.lift, knot.lift, 1e-14 * 1200);
  EXPECT_NEAR(sum.roll, knot.roll, 1e-12 * std::abs(knot.roll));
  EXPECT_NEAR(sum.cot, knot.cot, 1e-12 * knot.cot);
  EXPECT_NEAR(sum.white_turn, knot.white_turn, 1e-12 * knot.white_turn);
  EXPECT_NEAR(sum.inclination_accel / sum.seconds, knot.inclination_accel, 1e-9);
  EXPECT_EQ(sum.inclination, knot.inclination);
  EXPECT_EQ(sum.d_inclination, knot.d_inclination);
  for (int i = 0; i < Knot::kSources; ++i) {
    EXPECT_NEAR(sum.d_turn(i), knot.d_turn(i), 1e-11 * std::abs(knot.white_turn)) << i;
    EXPECT_NEAR(sum.d_lift(i), knot.d_lift(i), 1e-11 * std::abs(knot.white_turn)) << i;
  }
  EXPECT_GT(std::abs(knot.turn), 1e-3);
}

TEST(TrackerKnots, ACutInsideASampleStandsWhereItSays) {
  const truth::Path path = truth::Hour(20);
  HighSideTracker tracker({});
  std::int64_t end_before = 0;
  Random random(3);
  for (const ImuSample& sample : Samples(path, 10, 60)) {
    if (sample.stamp.seq % 50 == 0) tracker.SetAzimuth(path(Begin(sample)).azimuth);
    Push(tracker, path, sample);
    if (!tracker.ready() || random.Uniform() > 0.2) continue;
    const double fraction = 1 - random.Uniform();
    const std::int64_t begin = tracker.sample_begin().ns;
    const Knot knot = tracker.CutKnot(fraction);
    EXPECT_NEAR(static_cast<double>(knot.time.ns - begin), fraction * 1e8, 1);
    EXPECT_EQ(knot.utc.ns - knot.time.ns, 1'700'000'000'000'000'000);
    EXPECT_NEAR(knot.seconds, 1e-9 * static_cast<double>(knot.time.ns - end_before), 1e-12);
    const Motion m = path(1e-9 * static_cast<double>(knot.time.ns));
    EXPECT_NEAR(WrapPi(knot.toolface - m.toolface), 0, FromDegrees(2e-3));
    EXPECT_NEAR(knot.inclination, m.inclination, FromDegrees(1e-4));
    EXPECT_NEAR(knot.along.md, m.md, 1e-9);
    EXPECT_TRUE(knot.along.known);
    end_before = knot.time.ns;
  }
}

TEST(TrackerKnots, RefusesImpossibleCuts) {
  const truth::Path path = truth::Hour(20);
  const std::vector<ImuSample> samples = Samples(path, 10, 1);
  HighSideTracker tracker({});
  EXPECT_THROW(tracker.CutKnot(), std::invalid_argument);
  Push(tracker, path, samples[0]);
  EXPECT_THROW(tracker.CutKnot(), std::invalid_argument);  // it still waits for its successor
  Push(tracker, path, samples[1]);
  EXPECT_THROW(tracker.CutKnot(0), std::invalid_argument);
  EXPECT_THROW(tracker.CutKnot(1.1), std::invalid_argument);
  EXPECT_EQ(tracker.CutKnot(0.5).seq_end, 1);
  EXPECT_THROW(tracker.CutKnot(0.4), std::invalid_argument);
  EXPECT_NEAR(tracker.CutKnot().seconds, 0.05, 1e-12);
  EXPECT_EQ(tracker.CutKnot().seconds, 0);
}

TEST(TrackerKnots, OptionsOutsideTheirDomainAreRefused) {
  const auto with = [](auto set) {
    TrackerOptions options;
    set(options);
    return HighSideTracker(options);
  };
  EXPECT_THROW(with([](auto& o) { o.level_seconds = 0; }), std::invalid_argument);
  EXPECT_THROW(with([](auto& o) { o.accel_noise = -1; }), std::invalid_argument);
  EXPECT_THROW(with([](auto& o) { o.inclination_min = 0; }), std::invalid_argument);
  EXPECT_THROW(with([](auto& o) { o.roll_limit = -1; }), std::invalid_argument);
}

// Three seconds lost in a minute: what lies before and after is what it is without the loss.
TEST(TrackerGaps, NothingIsInventedForAGap) {
  const truth::Path path = truth::Hour(20);
  HighSideTracker full({}), lossy({});
  std::vector<Knot> knots;
  for (const ImuSample& sample : Samples(path, 10, 60)) {
    full.SetAzimuth(path(Begin(sample)).azimuth);
    lossy.SetAzimuth(path(Begin(sample)).azimuth);
    Push(full, path, sample);
    if (sample.stamp.seq == 300 || sample.stamp.seq == 330) knots.push_back(full.CutKnot());
    if (sample.stamp.seq < 300 || sample.stamp.seq >= 330) Push(lossy, path, sample);
  }
  full.Flush();
  knots.push_back(full.CutKnot());
  lossy.Flush();
  const Knot knot = lossy.CutKnot();
  EXPECT_NEAR(knot.seconds, 60, 1e-9);
  EXPECT_NEAR(knot.gap_seconds, 3, 1e-9);
  EXPECT_EQ(knot.samples_lost, 30);
  EXPECT_EQ(knot.seq_begin, 0);
  EXPECT_EQ(knot.seq_end, 600);
  EXPECT_EQ(knot.quality, Quality::kGap);
  EXPECT_NEAR(knot.turn, knots[0].turn + knots[2].turn, 1e-6);
  EXPECT_GT(std::abs(knots[1].turn), 1e-3);
  EXPECT_NEAR(knot.lift, knots[0].lift + knots[2].lift, 1e-6);
  EXPECT_NEAR(knot.cot, knots[0].cot + knots[2].cot, 2e-3);
  EXPECT_GT(knots[1].cot, 1);
  EXPECT_NEAR(knot.inclination, knots[2].inclination, FromDegrees(1e-3));
  EXPECT_NEAR(knot.toolface, knots[2].toolface, 1e-9);
  EXPECT_NEAR(knot.roll, knots[0].roll + knots[1].roll + knots[2].roll, 1e-3);
}

TEST(TrackerGaps, LateAndRepeatedSamplesChangeNothing) {
  const truth::Path path = truth::Hour(20);
  HighSideTracker plain({}), disturbed({});
  const std::vector<ImuSample> samples = Samples(path, 10, 30);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    EXPECT_TRUE(Push(plain, path, samples[k]));
    EXPECT_TRUE(Push(disturbed, path, samples[k]));
    EXPECT_FALSE(Push(disturbed, path, samples[k]));
    if (k > 20) {
      EXPECT_FALSE(Push(disturbed, path, samples[k - 20]));
    }
    ImuSample broken = samples[k];
    broken.stamp.seq += 1;
    broken.stamp.tool_time.ns += broken.stamp.period_ns;
    broken.f_T.x() = std::nan("");
    EXPECT_FALSE(Push(disturbed, path, broken));
  }
  const Knot a = plain.CutKnot(), b = disturbed.CutKnot();
  EXPECT_EQ(a.turn, b.turn);
  EXPECT_EQ(a.toolface, b.toolface);
  EXPECT_EQ(a.d_turn, b.d_turn);
  EXPECT_EQ(b.quality, Quality::kGood);
}

TEST(TrackerGaps, ANewSessionIsAGapByTheSurfaceClock) {
  const truth::Path path = truth::Hour(20);
  HighSideTracker tracker({});
  for (ImuSample sample : Samples(path, 10, 20)) {
    if (sample.stamp.seq >= 80 && sample.stamp.seq < 120) continue;
    if (sample.stamp.seq >= 120) {
      sample.stamp.session = 2;
      sample.stamp.seq -= 120;
      sample.stamp.tool_time.ns = sample.stamp.seq * sample.stamp.period_ns;
    }
    EXPECT_TRUE(tracker.Push(sample, {}, kSite));
  }
  tracker.Flush();
  const Knot knot = tracker.CutKnot();
  EXPECT_NEAR(knot.gap_seconds, 4, 1e-9);
  EXPECT_NEAR(knot.seconds, 20, 1e-9);
  EXPECT_TRUE(Has(knot.quality, Quality::kGap));
  EXPECT_TRUE(Has(knot.quality, Quality::kDepth));
}

TEST(TrackerFlags, StandOnTheKnotsThatHoldTheSample) {
  const truth::Path path = truth::Hour(20);
  HighSideTracker tracker({});
  std::vector<Knot> knots;
  for (ImuSample sample : Samples(path, 10, 5)) {
    const std::int64_t k = sample.stamp.seq;
    sample.stamp.gyro_saturated = k == 12;
    sample.stamp.accel_saturated = k == 22;
    sample.stamp.utc_unsynced = k == 29;
    AlongHole along = AlongAt(path, sample);
    if (k == 45) along = {};
    tracker.Push(sample, along, kSite);
    if (k % 10 == 0 && k > 0) knots.push_back(tracker.CutKnot(k == 30 ? 0.5 : 1.0));
  }
  tracker.Flush();
  knots.push_back(tracker.CutKnot());
  ASSERT_EQ(knots.size(), 5u);
  EXPECT_EQ(knots[0].quality, Quality::kGood);
  EXPECT_EQ(knots[1].quality, Quality::kSaturated);
  EXPECT_EQ(knots[2].quality, Quality::kSaturated | Quality::kClock);
  EXPECT_EQ(knots[3].quality, Quality::kClock);  // the other half of sample 29
  EXPECT_EQ(knots[4].quality, Quality::kDepth);
}

TEST(TrackerFlags, RollTooFastForTheSamplingIsAliased) {
  for (double turn_per_sample : {0.4, 2.0}) {
    const truth::Path path = [turn_per_sample](double t) {
      Motion m;
      m.inclination = 0.5;
      m.toolface_rate = 10 * turn_per_sample;
      m.toolface = m.toolface_rate * t;
      return m;
    };
    HighSideTracker tracker({});
    for (const ImuSample& sample : Samples(path, 10, 5)) Push(tracker, path, sample);
    EXPECT_EQ(Has(tracker.CutKnot().quality, Quality::kAliased), turn_per_sample > kPi / 2);
  }
}

// Down through 0.05 deg off vertical and out again.
TEST(TrackerVertical, SumsStayFiniteAndTheFlagStands) {
  const truth::Path path = [](double t) {
    Motion m;
    m.inclination = std::abs(FromDegrees(3) * (1 - t / 100)) + FromDegrees(0.05);
    m.inclination_rate = FromDegrees(t < 100 ? -0.03 : 0.03);
    m.toolface = 0.2 * t;
    m.toolface_rate = 0.2;
    m.speed = 0.5;
    m.md = 0.5 * t;
    return m;
  };
  TrackerOptions options;
  options.accel_noise = 5e-4;
  HighSideTracker tracker(options);
  Random random(5);
  std::vector<Knot> knots;
  for (ImuSample sample : Samples(path, 10, 200)) {
    sample.f_T +=
        5e-4 * std::sqrt(10.) * Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal());
    Push(tracker, path, sample);
    if (sample.stamp.seq % 10 == 0 && tracker.ready()) knots.push_back(tracker.CutKnot());
  }
  const double threshold = std::sin(options.inclination_min);
  for (const Knot& knot : knots) {
    const double t = 1e-9 * static_cast<double>(knot.time.ns);
    const double inclination = path(t).inclination;
    EXPECT_TRUE(std::isfinite(knot.turn) && knot.d_turn.allFinite() && knot.d_lift.allFinite());
    EXPECT_LE(knot.white_turn, 1.001 * knot.seconds / (threshold * threshold));
    if (inclination < FromDegrees(0.4)) {
      EXPECT_TRUE(knot.vertical && Has(knot.quality, Quality::kVertical)) << t;
    } else if (inclination > FromDegrees(0.6)) {
      EXPECT_FALSE(knot.vertical || Has(knot.quality, Quality::kVertical)) << t;
    }
    EXPECT_NEAR(knot.inclination, inclination, FromDegrees(0.06)) << t;
  }
}

// The noise formula: at 100 Hz and 0.01 m/s^2 sqrt(s) the toolface of one sample has a sigma of
// 0.1 rad up to asin(0.01 / (9.81 sqrt(0.01) 0.1)) = 5.9 deg.
TEST(TrackerVertical, TheThresholdFollowsTheNoise) {
  for (double inclination_deg : {5.5, 6.3}) {
    const truth::Path path = [inclination_deg](double) {
      Motion m;
      m.inclination = FromDegrees(inclination_deg);
      return m;
    };
    TrackerOptions options;
    options.accel_noise = 0.01;
    HighSideTracker tracker(options);
    for (const ImuSample& sample : Samples(path, 100, 2)) Push(tracker, path, sample);
    EXPECT_EQ(tracker.CutKnot().vertical, inclination_deg < 5.9);
  }
}

// The azimuth given to the tracker: the bound in its header, and that it is not idle.
TEST(TrackerAzimuth, AWrongOneBarelyMovesInclination) {
  const truth::Path path = truth::Slide(30);
  const std::vector<ImuSample> samples = Samples(path, 10, 400);
  const double bound = kEarthRate * std::cos(kSite.latitude) * 20 / std::exp(1);
  double worst = 0, settled = 0;
  HighSideTracker right({}), wrong({});
  for (const ImuSample& sample : samples) {
    const double t = Begin(sample), azimuth = path(t).azimuth;
    right.SetAzimuth(azimuth);
    if (t < 200) wrong.SetAzimuth(azimuth);
    if (t >= 200) wrong.SetAzimuth(azimuth + kPi);
    Push(right, path, sample);
    Push(wrong, path, sample);
    const double off = std::abs(wrong.inclination() - right.inclination());
    worst = std::max(worst, off);
    if (t > 380) settled = std::max(settled, off);
  }
  EXPECT_GT(worst, bound);
  EXPECT_LT(worst, 2.1 * bound);
  EXPECT_LT(settled, 0.1 * bound);
}

TEST(TrackerAzimuth, LearningItMakesNoStepInInclination) {
  const truth::Path path = truth::Slide(30);
  const double bound = kEarthRate * std::cos(kSite.latitude) * 20 / std::exp(1);
  double worst = 0;
  HighSideTracker known({}), learns({});
  for (const ImuSample& sample : Samples(path, 10, 400)) {
    const double t = Begin(sample), azimuth = path(t).azimuth;
    known.SetAzimuth(azimuth);
    if (t >= 200) learns.SetAzimuth(azimuth);
    Push(known, path, sample);
    Push(learns, path, sample);
    if (t >= 200) {
      worst = std::max(worst, std::abs(learns.inclination() - known.inclination()));
    }
  }
  EXPECT_LT(worst, 0.05 * bound);
}

TEST(TrackerDynamics, StartsAndStopsAlongTheHoleAreTakenOut) {
  const truth::Path path = [](double t) {
    Motion m;
    const double w = kTwoPi / 30;
    m.inclination = FromDegrees(40);
    m.toolface = 0.3 * t;
    m.toolface_rate = 0.3;
    m.speed = 0.5 * (1 - std::cos(w * t));
    m.acceleration = 0.5 * w * std::sin(w * t);
    m.md = 0.5 * (t - std::sin(w * t) / w);
    return m;
  };
  HighSideTracker known({}), unknown({});
  double worst = 0, without = 0;
  for (const ImuSample& sample : Samples(path, 10, 300)) {
    known.SetAzimuth(0);
    unknown.SetAzimuth(0);
    Push(known, path, sample);
    unknown.Push(sample, {}, kSite);
    if (!known.ready()) continue;
    worst = std::max(worst, std::abs(known.inclination() - FromDegrees(40)));
    without = std::max(without, std::abs(unknown.inclination() - FromDegrees(40)));
  }
  EXPECT_LT(worst, FromDegrees(1e-4));
  EXPECT_GT(without, FromDegrees(1e-2));
}

// Depth marks of 0.1 m rms; the tool stands. What the first seconds make of it must not stay.
TEST(TrackerDynamics, ScatterOfTheDepthIsNoRateOfInclination) {
  constexpr double kScatter = 0.05;  // [m/s^2]
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    Random random(seed);
    HighSideTracker tracker({});
    tracker.SetAzimuth(0);
    const truth::Path path = [](double) { return Motion{.inclination = FromDegrees(40)}; };
    double worst = 0, said = 0;
    for (const ImuSample& sample : Samples(path, 10, 300)) {
      AlongHole along{.known = true, .sigma_acceleration = kScatter};
      // Alike for about a second, as a fit of marks over some seconds leaves it.
      said += 0.1 * (random.Normal() * kScatter * std::sqrt(20) - said);
      along.acceleration = said;
      tracker.Push(sample, along, kSite);
      if (!tracker.ready() || Begin(sample) < 10) continue;
      worst = std::max(worst, std::abs(tracker.inclination() - FromDegrees(40)));
    }
    EXPECT_LT(worst, FromDegrees(0.3)) << seed << ": " << ToDegrees(worst);
    EXPECT_LT(std::abs(tracker.inclination() - FromDegrees(40)), FromDegrees(0.1)) << seed;
  }
}

TEST(TrackerDynamics, AccelerometersOffTheAxisAreBroughtBack) {
  truth::Sensors sensors;
  sensors.p_accel_T = {0.02, -0.01, 0};
  const truth::Path path = truth::Hour(5);
  const auto worst_toolface = [&](const TrackerOptions& options) {
    HighSideTracker tracker(options);
    double worst = 0;
    for (const ImuSample& sample : Samples(path, 100, 60, sensors)) {
      Push(tracker, path, sample);
      if (!tracker.ready() || Begin(sample) < 1) continue;
      const double t = 1e-9 * static_cast<double>(tracker.time().ns);
      worst = std::max(worst, std::abs(WrapPi(tracker.toolface() - path(t).toolface)));
    }
    return ToDegrees(worst);
  };
  TrackerOptions with, without;
  with.p_accel_T = sensors.p_accel_T;
  const double brought = worst_toolface(with), left = worst_toolface(without);
  EXPECT_GT(left, 0.1);
  EXPECT_LT(brought, 0.05 * left);
}

// Noise in, spread of the knots out, against what they say of it: chi-square over 200 seeds.
TEST(TrackerNoise, SigmasAreThoseOfTheSpread) {
  const truth::Path path = truth::Hour(15);
  TrackerOptions options;
  options.accel_noise = 1e-3;
  options.angle_random_walk = 3e-5;
  const double rate = 10, seconds = 60;
  const std::vector<ImuSample> clean = Samples(path, rate, seconds);
  const auto fly = [&](std::uint64_t seed, bool gyros, bool accels) {
    Random random(seed);
    HighSideTracker tracker(options);
    for (ImuSample sample : clean) {
      for (int i = 0; i < 3; ++i) {
        const double w = random.Normal(), f = random.Normal();
        if (gyros && i < 2) sample.w_IT_T(i) += options.angle_random_walk * std::sqrt(rate) * w;
        if (accels) sample.f_T(i) += options.accel_noise * std::sqrt(rate) * f;
      }
      Push(tracker, path, sample);
    }
    tracker.Flush();
    return tracker.CutKnot();
  };
  const int seeds = 200;
  const Knot truth = fly(0, false, false);
  double inclination = 0, accel = 0, white = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const Knot both = fly(static_cast<std::uint64_t>(seed), true, true);
    const Knot gyros = fly(static_cast<std::uint64_t>(seed), true, false);
    const double sigma_white = options.angle_random_walk * std::sqrt(truth.white_turn);
    inclination += std::pow((both.inclination - truth.inclination) / both.sigma_inclination, 2);
    accel += std::pow(
        (both.inclination_accel - truth.inclination_accel) / both.sigma_inclination_accel, 2);
    white += std::pow((gyros.turn - truth.turn) / sigma_white, 2);
  }
  const double low = ChiSquareQuantile(1e-3, seeds), high = ChiSquareQuantile(1 - 1e-3, seeds);
  for (double sum : {inclination, accel, white}) {
    EXPECT_GT(sum, low);
    EXPECT_LT(sum, high);
  }
}

// Toolface and inclination both; ten minutes, so that the observer's twenty seconds are short.
TEST(TrackerNoise, AccelerometerNoiseOfTheTurnIsThatOfTheSpread) {
  const truth::Path path = truth::Hour(15);
  TrackerOptions options;
  options.accel_noise = 1e-3;
  const double rate = 10;
  const std::vector<ImuSample> clean = Samples(path, rate, 660);
  const auto fly = [&](std::uint64_t seed, double scale) {
    Random random(seed);
    HighSideTracker tracker(options);
    for (ImuSample sample : clean) {
      for (int i = 0; i < 3; ++i) {
        sample.f_T(i) += scale * options.accel_noise * std::sqrt(rate) * random.Normal();
      }
      Push(tracker, path, sample);
      if (sample.stamp.seq == 600) tracker.CutKnot();
    }
    tracker.Flush();
    return tracker.CutKnot();
  };
  const int seeds = 200;
  const Knot truth = fly(0, 0);
  double sum = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const Knot knot = fly(static_cast<std::uint64_t>(seed), 1);
    sum += std::pow(knot.turn - truth.turn, 2) / truth.toolface_noise_turn;
  }
  EXPECT_GT(sum, ChiSquareQuantile(1e-3, seeds));
  EXPECT_LT(sum, ChiSquareQuantile(1 - 1e-3, seeds));
}

TEST(TrackerCopies, GoOnAlone) {
  const truth::Path path = truth::Hour(20);
  const std::vector<ImuSample> samples = Samples(path, 10, 20);
  HighSideTracker tracker({}), alone({});
  for (const ImuSample& sample : samples) {
    Push(tracker, path, sample);
    Push(alone, path, sample);
    if (sample.stamp.seq % 30 == 0) {
      HighSideTracker copy = tracker;
      copy.Flush();
      EXPECT_EQ(copy.CutKnot().seq_end, sample.stamp.seq + 1);
    }
  }
  EXPECT_EQ(tracker.CutKnot().turn, alone.CutKnot().turn);
}

}  // namespace
}  // namespace wellgyro
