#include "wellgyro/io/toml/noise_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wellgyro/base/units.h"

namespace wellgyro {
namespace {

using testing::HasSubstr;
using testing::Not;

NoiseFit SomeFit() {
  NoiseFit fit;
  auto& n = fit.term[NoiseTerm::kAngleRandomWalk];
  n = {.observable = true,
       .value = 0.01 * units::kDegPerSqrtHour,
       .sigma = 1e-4 * units::kDegPerSqrtHour};
  auto& b = fit.term[NoiseTerm::kBiasInstability];
  b = {.observable = true, .value = 0.08 * units::kDegPerHour, .sigma = 0.01 * units::kDegPerHour};
  fit.term[NoiseTerm::kQuantization].upper95 = 0.003 * units::kArcsec;
  fit.term[NoiseTerm::kRateRandomWalk].upper95 = 0.4 * units::kDegPerHourSqrtHour;
  fit.term[NoiseTerm::kRateRamp].upper95 = 0.6 * units::kDegPerHour2;
  fit.points = 19;
  return fit;
}

TEST(NoiseFile, WritesValuesWithSigmaOrTheirBoundAlone) {
  const std::string text =
      NoiseFileText(SomeFit(), {.source = "a \"log\".f64", .period = 0.01, .samples = 1000});
  EXPECT_THAT(text, testing::StartsWith("format = \"wellgyro.noise/1\"\n"));
  EXPECT_THAT(text, HasSubstr("\nangle_random_walk_deg_per_sqrt_h = 0.01"));
  EXPECT_THAT(text, HasSubstr("\nangle_random_walk_deg_per_sqrt_h_sigma = "));
  EXPECT_THAT(text, HasSubstr("\nquantization_arcsec_upper95 = 0.003"));
  EXPECT_THAT(text, Not(HasSubstr("\nquantization_arcsec = ")));
  EXPECT_THAT(text, HasSubstr("\nrate_random_walk_deg_per_h_sqrt_h_upper95 = 0."));
  EXPECT_THAT(text, HasSubstr("\nrate_ramp_deg_per_h2_upper95 = "));
  const auto read = ParseNoiseFile(text, "n.toml");
  ASSERT_TRUE(read) << read.fault().text;
  EXPECT_DOUBLE_EQ(read->angle_random_walk, 0.01 * units::kDegPerSqrtHour);
  EXPECT_DOUBLE_EQ(read->bias_instability, 0.08 * units::kDegPerHour);
  EXPECT_EQ(read->rate_random_walk, 0);
  EXPECT_FALSE(read->bias_instability_correlation_time);
}

TEST(NoiseFile, KeepsTheCorrelationTimeAndTheSinusoid) {
  NoiseFit fit = SomeFit();
  fit.model.shape.correlation_time = 1800;
  fit.sigma_correlation_time = 300;
  fit.model.shape.sinusoid_frequency = 0.25;
  fit.term[NoiseTerm::kSinusoid] = {.observable = true, .value = 1e-5, .sigma = 1e-7};
  const std::string text = NoiseFileText(fit, {.source = "x", .period = 0.01});
  EXPECT_THAT(text, HasSubstr("\nbias_instability_correlation_time_h = 0.5\n"));
  EXPECT_THAT(text, HasSubstr("\n[sinusoid]\nfrequency_hz = 0.25\namplitude_deg_per_h = "));
  const auto read = ParseNoiseFile(text, "n.toml");
  ASSERT_TRUE(read) << read.fault().text;
  EXPECT_DOUBLE_EQ(*read->bias_instability_correlation_time, 1800);
}

TEST(NoiseFile, NamesTheLineOfWhatDoesNotBelong) {
  const auto unknown = ParseNoiseFile(
      "format = \"wellgyro.noise/1\"\n[coefficients]\nangle_random_walk = 1\n", "n.toml");
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.fault().line, 3);
  const auto both = ParseNoiseFile(
      "format = \"wellgyro.noise/1\"\n[coefficients]\nrate_ramp_deg_per_h2 = 1\n"
      "rate_ramp_deg_per_h2_upper95 = 2\n",
      "n.toml");
  ASSERT_FALSE(both);
  EXPECT_EQ(both.fault().line, 4);
  EXPECT_FALSE(ParseNoiseFile("format = \"wellgyro.job/1\"\n", "n.toml"));
  EXPECT_FALSE(ParseNoiseFile("", "n.toml"));
  EXPECT_FALSE(ReadNoiseFile("/no/such/file"));
}

TEST(NoiseFile, OfAnAccelerometerIsNotTakenForAGyros) {
  const std::string text =
      NoiseFileText(SomeFit(), {.accelerometer = true, .source = "x", .period = 0.01});
  EXPECT_THAT(text, HasSubstr("\nvelocity_random_walk_mps_per_sqrt_s = "));
  const auto read = ParseNoiseFile(text, "n.toml");
  ASSERT_FALSE(read);
  EXPECT_THAT(read.fault().text, HasSubstr("accel_noise_mps2_per_sqrt_hz"));
  EXPECT_EQ(read.fault().line, 2);
}

}  // namespace
}  // namespace wellgyro
