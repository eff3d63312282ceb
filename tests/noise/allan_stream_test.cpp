#include "wellgyro/noise/allan_stream.h"

#include <cmath>

#include <gtest/gtest.h>

#include "wellgyro/math/random.h"

namespace wellgyro {
namespace {

std::vector<double> WhiteAbout(std::size_t samples, std::uint64_t seed, double bias) {
  Random random(seed);
  std::vector<double> rate(samples);
  for (auto& y : rate) y = bias + random.Normal();
  return rate;
}

// Differences that begin every max(1, m/16) samples, in long double.
long double ByDefinition(std::span<const double> rate, std::int64_t m) {
  std::vector<long double> x(rate.size() + 1, 0);
  for (std::size_t i = 0; i < rate.size(); ++i) x[i + 1] = x[i] + (rate[i] - 1e3L);
  long double squares = 0;
  long double taken = 0;
  const auto stride = static_cast<std::size_t>(std::max<std::int64_t>(1, m / 16));
  const auto lag = static_cast<std::size_t>(m);
  for (std::size_t k = 0; k + 2 * lag < x.size(); k += stride) {
    const long double d = x[k + 2 * lag] - 2 * x[k + lag] + x[k];
    squares += d * d;
    ++taken;
  }
  return squares / (2.L * static_cast<long double>(m) * static_cast<long double>(m) * taken);
}

TEST(AllanStream, TakesTheDifferencesItSays) {
  for (const std::size_t samples : {2u, 3u, 31u, 32u, 33u, 1000u, 1024u, 2047u, 4096u, 33001u}) {
    const auto rate = WhiteAbout(samples, samples, 1e3);
    AllanStream stream(0.5);
    stream.Push(rate);
    const AllanResult result = stream.Result();
    EXPECT_EQ(result.points.size(), OctaveFactors(static_cast<std::int64_t>(samples)).size());
    for (const auto& point : result.points) {
      EXPECT_EQ(point.terms, static_cast<std::int64_t>(samples) - 2 * point.factor + 1);
      EXPECT_DOUBLE_EQ(point.tau, 0.5 * static_cast<double>(point.factor));
      EXPECT_NEAR(point.variance / static_cast<double>(ByDefinition(rate, point.factor)), 1, 1e-11)
          << samples << " " << point.factor;
    }
  }
}

TEST(AllanStream, DoesNotCareHowTheStreamIsCut) {
  const auto rate = WhiteAbout(20000, 5, -3);
  AllanStream whole(1);
  whole.Push(rate);
  AllanStream pieces(1);
  Random random(1);
  for (std::size_t at = 0; at < rate.size();) {
    const auto n = std::min<std::size_t>(rate.size() - at, 1 + random.Bits() % 3000);
    pieces.Push(std::span(rate).subspan(at, n));
    static_cast<void>(pieces.Result());  // asking in between changes nothing
    at += n;
  }
  const auto a = whole.Result().points;
  const auto b = pieces.Result().points;
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].variance, b[i].variance);
}

TEST(AllanStream, AgreesWithFullOverlapWithinItsScatter) {
  const auto rate = WhiteAbout(1 << 20, 6, 0);
  AllanStream stream(1);
  stream.Push(rate);
  const auto full = AllanVariance(rate, 1, OctaveFactors(1 << 20)).points;
  const auto points = stream.Result().points;
  ASSERT_EQ(points.size(), full.size());
  for (std::size_t i = 0; i < full.size(); ++i) {
    EXPECT_EQ(points[i].terms, full[i].terms);
    // What is lost is 0.4 % of the degrees of freedom: 0.06 sigma; the last has but a few terms.
    const double sigma = std::sqrt(2. * static_cast<double>(full[i].factor) / (1 << 20));
    const double tolerance = full[i].factor <= 16 ? 1e-12 : 0.3 * sigma;
    EXPECT_NEAR(points[i].variance / full[i].variance, 1, tolerance) << full[i].factor;
  }
}

TEST(AllanStream, TakesNoDifferenceAcrossAGapAndNamesWhatIsNotFinite) {
  auto a = WhiteAbout(5000, 7, 0);
  const auto b = WhiteAbout(3000, 8, 50);
  AllanStream stream(1);
  stream.Push(a);
  stream.Push(std::vector<double>{std::nan(""), std::nan("")});
  stream.Push(b);
  stream.Skip(100);
  stream.Push(std::vector<double>{1});
  const AllanResult result = stream.Result();
  EXPECT_EQ(result.samples, 5000 + 2 + 3000 + 100 + 1);
  EXPECT_EQ(result.missing, 102);
  ASSERT_EQ(result.not_finite.size(), 1u);
  EXPECT_EQ(result.not_finite[0].begin, 5000);
  EXPECT_EQ(result.not_finite[0].end, 5002);
  const auto& first = result.points.front();
  EXPECT_EQ(first.terms, 4999 + 2999);
  const double one = AllanVariance(a, 1, OctaveFactors(2)).points[0].variance;
  const double two = AllanVariance(b, 1, OctaveFactors(2)).points[0].variance;
  EXPECT_NEAR(first.variance, (4999 * one + 2999 * two) / 7998, 1e-12);
  EXPECT_EQ(result.points.back().factor, 2048);
}

TEST(AllanStream, StaysSmall) {
  AllanStream stream(1);
  stream.Push(std::vector<double>(1024, 1.));
  const std::size_t two_levels = stream.state_bytes();
  EXPECT_GT(two_levels, 0u);
  // A level more each time the stream doubles: 53 for as many samples as a double can count, 64
  // with what a vector keeps in reserve.
  EXPECT_LE(two_levels / 2 * 64, 1u << 20);
  stream.Push(std::vector<double>(1 << 20, 1.));
  EXPECT_LE(stream.state_bytes(), two_levels / 2 * 16);
  EXPECT_THROW(AllanStream(0), std::invalid_argument);
}

}  // namespace
}  // namespace wellgyro
