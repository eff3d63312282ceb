// The knots of a run, kept in less memory, are what they were to the last bit.
#include "wellgyro/survey/run/kept_knots.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/math/random.h"

#include "support/hour.h"

namespace wellgyro {
namespace {

std::uint64_t Bits(double value) { return std::bit_cast<std::uint64_t>(value); }

template <class Matrix>
void ExpectSame(const Matrix& a, const Matrix& b) {
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    EXPECT_EQ(Bits(*(a.data() + i)), Bits(*(b.data() + i))) << i;
  }
}

void ExpectSame(const Increment& a, const Increment& b) {
  EXPECT_EQ(a.time, b.time);
  for (const auto number :
       {&Increment::seconds, &Increment::roll_before, &Increment::roll_after, &Increment::var_turn,
        &Increment::sigma_roll, &Increment::lateral, &Increment::gap_seconds}) {
    EXPECT_EQ(Bits(a.*number), Bits(b.*number));
  }
  ExpectSame(a.turn_M, b.turn_M);
  ExpectSame(a.turn_before_M, b.turn_before_M);
  ExpectSame(a.force_M, b.force_M);
  ExpectSame(a.turn_per_roll, b.turn_per_roll);
  ExpectSame(a.force_per_roll, b.force_per_roll);
  ExpectSame(a.wobble_followed, b.wobble_followed);
  ExpectSame(a.turn_by_harmonic, b.turn_by_harmonic);
  ExpectSame(a.turn_by_error, b.turn_by_error);
  ExpectSame(a.force_by_error, b.force_by_error);
  for (const auto flag : {&Increment::has_axial, &Increment::roll_seen, &Increment::level}) {
    EXPECT_EQ(a.*flag, b.*flag);
  }
  for (const auto number : {&Increment::seq_begin, &Increment::seq_end, &Increment::samples_lost}) {
    EXPECT_EQ(a.*number, b.*number);
  }
  EXPECT_EQ(a.quality, b.quality);
}

void ExpectSame(const AlongHole& a, const AlongHole& b) {
  for (const auto number :
       {&AlongHole::md, &AlongHole::speed, &AlongHole::acceleration, &AlongHole::sigma_md,
        &AlongHole::sigma_speed, &AlongHole::sigma_acceleration}) {
    EXPECT_EQ(Bits(a.*number), Bits(b.*number));
  }
  EXPECT_EQ(a.known, b.known);
}

void ExpectSame(const RunKnot& a, const RunKnot& b) {
  ExpectSame(a.increment, b.increment);
  ExpectSame(a.along, b.along);
  EXPECT_EQ(a.utc, b.utc);
  EXPECT_EQ(a.still, b.still);
  EXPECT_EQ(Bits(a.temperature), Bits(b.temperature));
  EXPECT_EQ(Bits(a.unseen), Bits(b.unseen));
  EXPECT_EQ(Bits(a.var_unseen), Bits(b.var_unseen));
}

void ExpectSame(const AttitudeSample& a, const AttitudeSample& b) {
  EXPECT_EQ(a.time, b.time);
  for (const auto number :
       {&AttitudeSample::inclination, &AttitudeSample::azimuth, &AttitudeSample::toolface}) {
    EXPECT_EQ(Bits(a.*number), Bits(b.*number));
  }
  EXPECT_EQ(a.azimuth_known, b.azimuth_known);
  ExpectSame(a.cov_attitude, b.cov_attitude);
  EXPECT_EQ(a.quality, b.quality);
}

void ExpectSame(const KeptKnots& kept, const std::vector<KeptKnot>& knots) {
  ASSERT_EQ(kept.size(), knots.size());
  KeptKnots::Reader reader(kept);
  for (const KeptKnot& knot : knots) {
    const KeptKnot* read = reader.Next();
    ASSERT_NE(read, nullptr);
    ExpectSame(read->knot, knot.knot);
    ExpectSame(read->attitude, knot.attitude);
    if (::testing::Test::HasFailure()) return;
  }
  EXPECT_EQ(reader.Next(), nullptr);
}

std::vector<KeptKnot> KnotsOf(const RunHistory& history) {
  std::vector<KeptKnot> knots;
  for (std::size_t i = 0; i < history.knots.size(); ++i) {
    knots.push_back({history.knots[i], history.attitude[i]});
  }
  return knots;
}

testing::Hour RollingHour() {
  testing::Hour hour = testing::StrongDrift();
  hour.minutes = 12;
  hour.imu_hz = 50;
  return hour;
}

// Rows of a run hold some 38 numbers of noise, of which 5 to 6 bytes are its own.
TEST(KeptKnots, ARunIsKeptToTheBitInLessThanHalf) {
  const testing::Hour hour = RollingHour();
  const testing::Flown flown = testing::Fly(hour, testing::JobOf(hour), 5);
  const std::vector<KeptKnot> knots = KnotsOf(flown.history);
  ASSERT_GT(knots.size(), 700u);
  KeptKnots kept;
  for (const KeptKnot& knot : knots) kept.Add(knot.knot, knot.attitude);
  ExpectSame(kept, knots);
  const double each = static_cast<double>(kept.bytes()) / static_cast<double>(kept.size());
  std::printf("a knot is kept in %.0f bytes of %zu\n", each,
              sizeof(RunKnot) + sizeof(AttitudeSample));
  EXPECT_LT(each, 0.5 * (sizeof(RunKnot) + sizeof(AttitudeSample)));
}

/// Whatever bits there are: no number need be what the others lead to expect.
KeptKnot AnyBits(Random& random) {
  const auto any = [&random](double& value) {
    const double odd[] = {0.0, -0.0, std::numeric_limits<double>::quiet_NaN(), HUGE_VAL, -1e308};
    const double kind = random.Uniform(), power = 600 * random.Normal();
    value = kind < 0.3 ? odd[static_cast<std::size_t>(kind / 0.06)]
                       : std::ldexp(random.Normal(), static_cast<int>(power));
  };
  const auto all = [&any](auto& matrix) {
    for (Eigen::Index i = 0; i < matrix.size(); ++i) any(*(matrix.data() + i));
  };
  KeptKnot kept;
  Increment& inc = kept.knot.increment;
  inc.time.ns = static_cast<std::int64_t>(1e18 * random.Normal());
  for (double* value : {&inc.seconds, &inc.roll_before, &inc.roll_after, &inc.var_turn,
                        &inc.sigma_roll, &inc.lateral, &inc.gap_seconds}) {
    any(*value);
  }
  all(inc.turn_M);
  all(inc.turn_before_M);
  all(inc.force_M);
  all(inc.turn_per_roll);
  all(inc.force_per_roll);
  all(inc.turn_by_error);
  all(inc.force_by_error);
  inc.seq_begin = static_cast<std::int64_t>(1e18 * random.Normal());
  inc.seq_end = -inc.seq_begin;
  inc.level = random.Uniform() < 0.5;
  inc.quality = static_cast<Quality>(4095 * random.Uniform());
  AlongHole& along = kept.knot.along;
  for (double* value : {&along.md, &along.speed, &along.acceleration, &along.sigma_md,
                        &along.sigma_speed, &along.sigma_acceleration}) {
    any(*value);
  }
  along.known = random.Uniform() < 0.5;
  kept.knot.utc.ns = static_cast<std::int64_t>(1e18 * random.Normal());
  kept.knot.still = random.Uniform() < 0.5;
  kept.knot.temperature = static_cast<float>(random.Normal());
  any(kept.knot.unseen);
  any(kept.knot.var_unseen);
  AttitudeSample& attitude = kept.attitude;
  attitude.time = inc.time;
  for (double* value : {&attitude.inclination, &attitude.azimuth, &attitude.toolface}) any(*value);
  all(attitude.cov_attitude);
  attitude.azimuth_known = random.Uniform() < 0.5;
  attitude.quality = static_cast<Quality>(4095 * random.Uniform());
  return kept;
}

void AddAny(Random& random, KeptKnots& kept, std::vector<KeptKnot>& knots) {
  knots.push_back(AnyBits(random));
  kept.Add(knots.back().knot, knots.back().attitude);
}

TEST(KeptKnots, AnyBitsAreKeptAndAttitudesRevised) {
  Random random(3);
  std::vector<KeptKnot> knots;
  KeptKnots kept;
  for (int i = 0; i < 200; ++i) {
    AddAny(random, kept, knots);
    if (i == 0 || i == 63 || i == 64 || i == 199) ExpectSame(kept, knots);
  }
  std::vector<AttitudeSample> others;
  for (std::size_t i = 100; i < knots.size(); ++i) {
    knots[i].attitude = others.emplace_back(AnyBits(random).attitude);
  }
  kept.Revise(100, others);
  ExpectSame(kept, knots);
  // What is added behind a revision is told from the last knot, too.
  AddAny(random, kept, knots);
  ExpectSame(kept, knots);
}

TEST(KeptKnots, AreReadFromAnyNumberOn) {
  Random random(4);
  std::vector<KeptKnot> knots;
  KeptKnots kept;
  for (int i = 0; i < 130; ++i) AddAny(random, kept, knots);
  for (const std::size_t from : {0, 1, 63, 64, 65, 128, 129, 130}) {
    KeptKnots::Reader reader(kept, from);
    for (std::size_t i = from; i < knots.size(); ++i) {
      const KeptKnot* read = reader.Next();
      ASSERT_NE(read, nullptr) << from;
      ExpectSame(read->knot, knots[i].knot);
      ExpectSame(read->attitude, knots[i].attitude);
    }
    EXPECT_EQ(reader.Next(), nullptr) << from;
  }
}

TEST(KeptKnots, WhatIsKnownAtATimeIsThatOfTheKnotBefore) {
  KeptKnots kept;
  EXPECT_FALSE(kept.KnownAt(ToolTime{100}));
  for (int i = 1; i <= 150; ++i) {
    KeptKnot knot;
    knot.knot.increment.time = knot.attitude.time = ToolTime{10 * i};
    knot.attitude.azimuth = i;
    kept.Add(knot.knot, knot.attitude);
  }
  EXPECT_FALSE(kept.KnownAt(ToolTime{9}));
  for (const int ns : {10, 15, 639, 640, 641, 650, 1280, 1281, 1499, 1500, 9999}) {
    const auto known = kept.KnownAt(ToolTime{ns});
    ASSERT_TRUE(known) << ns;
    EXPECT_EQ(known->azimuth, std::min(ns / 10, 150)) << ns;
  }
}

}  // namespace
}  // namespace wellgyro
