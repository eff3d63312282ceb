#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "wellgyro.h"

namespace wellgyro {
namespace {

constexpr const char* kJob =
    "format = \"wellgyro.job/1\"\n[well]\nlatitude_deg = 60\n[stations]\nat_stops = "
    "true\n[tie_in]\nmd_m = 500\ntvd_m = 500\n"
    "[noise]\nangle_random_walk_deg_per_sqrt_h = 0.01\n[errors]\ngyro_bias_sigma_deg_per_h = 0.1\n"
    "accel_bias_sigma_mps2 = 1e-3\n";
TEST(Session, AJobThatCannotBeUsedIsToldWithItsLine) {
  wellgyro_session* session = nullptr;
  EXPECT_EQ(
      wellgyro_open_text("format = \"wellgyro.job/1\"\n[well]\nlatitude_deg = 95\n", ".", &session),
      WELLGYRO_UNUSABLE);
  EXPECT_EQ(session, nullptr);
  EXPECT_STREQ(wellgyro_error(nullptr), "job:3:16: [well] latitude_deg: 95 must be at most 89.9");
}

TEST(Session, WithoutSamplesThereIsNoSurveyAndASentenceSaysSo) {
  wellgyro_session* session = nullptr;
  ASSERT_EQ(wellgyro_open_text(kJob, ".", &session), WELLGYRO_OK);
  EXPECT_EQ(wellgyro_finish(session), WELLGYRO_UNUSABLE);
  EXPECT_STRNE(wellgyro_error(session), "");
  EXPECT_EQ(wellgyro_finish(session), WELLGYRO_USAGE);
  wellgyro_close(session);
  wellgyro_close(nullptr);
}

TEST(Session, OfANullOneTheThreadSaysSo) {
  wellgyro_session* session = nullptr;
  EXPECT_EQ(wellgyro_open_text("", ".", &session), WELLGYRO_UNUSABLE);
  EXPECT_EQ(wellgyro_push_depth(nullptr, nullptr, 0), WELLGYRO_USAGE);
  EXPECT_STREQ(wellgyro_error(nullptr), "null session");
}

TEST(Session, MarksOfNoKindOrNoSigmaAreRefused) {
  wellgyro_session* session = nullptr;
  ASSERT_EQ(wellgyro_open_text(kJob, ".", &session), WELLGYRO_OK);
  for (const std::int32_t kind : {-5, 5, 99}) {
    wellgyro_depth mark{};
    mark.kind = kind;
    EXPECT_EQ(wellgyro_push_depth(session, &mark, 1), WELLGYRO_OK);
    EXPECT_THAT(wellgyro_error(session), testing::HasSubstr("kind " + std::to_string(kind)));
  }
  EXPECT_EQ(wellgyro_refused(session), 3);
  wellgyro_depth mark{};
  mark.sigma_m = std::nan("");
  EXPECT_EQ(wellgyro_push_depth(session, &mark, 1), WELLGYRO_OK);
  EXPECT_THAT(wellgyro_error(session), testing::HasSubstr("sigma_m"));
  EXPECT_EQ(wellgyro_refused(session), 4);
  mark.sigma_m = -1;
  EXPECT_EQ(wellgyro_push_depth(session, &mark, 1), WELLGYRO_OK);
  EXPECT_EQ(wellgyro_refused(session), 4);
  wellgyro_close(session);
}

/// Three minutes at rest, 30 deg off plumb towards azimuth 45 deg, at 60 deg north, 10 Hz.
void PushStop(wellgyro_session* session) {
  constexpr double kOmega = 7.292115e-5, kGravity = 9.8192;  // rad/s, m/s^2
  constexpr double kLatitude = M_PI / 3, kLean = M_PI / 6, kAzimuth = M_PI / 4;
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  const auto noise = [&](double sigma) { return sigma * normal(random); };
  for (int k = 0; k < 1800; ++k) {
    if (k % 5 == 0) {
      wellgyro_depth mark{};
      mark.utime_us = k * 100'000;
      mark.seq = k;
      mark.md_m = 500;
      mark.sigma_m = -1;
      ASSERT_EQ(wellgyro_push_depth(session, &mark, 1), WELLGYRO_OK);
    }
    wellgyro_imu sample{};
    sample.tool_ns = std::int64_t{k} * 100'000'000;
    sample.utime_us = k * 100'000;
    sample.seq = k;
    sample.period_ns = 100'000'000;
    // w_T = Ry(I)' Rz(A)' w_L, w_L = Omega (cos latitude, 0, -sin latitude); f_T as in README.
    const double north = std::cos(kAzimuth) * std::cos(kLatitude);
    sample.rate_rad_per_s[0] =
        kOmega * (std::cos(kLean) * north + std::sin(kLean) * std::sin(kLatitude)) + noise(9e-6);
    sample.rate_rad_per_s[1] = -kOmega * std::sin(kAzimuth) * std::cos(kLatitude) + noise(9e-6);
    sample.force_mps2[0] = kGravity * std::sin(kLean) + noise(6e-4);
    sample.force_mps2[1] = noise(6e-4);
    sample.force_mps2[2] = -kGravity * std::cos(kLean) + noise(6e-4);
    ASSERT_EQ(wellgyro_push_imu(session, &sample, 1), WELLGYRO_OK);
  }
}

std::string StopJob(const std::string& latitude_deg) {
  return "format = \"wellgyro.job/1\"\n[well]\nlatitude_deg = " + latitude_deg +
         "\n[stations]\nat_stops = true\n"
         "[tie_in]\nmd_m = 490\ntvd_m = 490\ninclination_deg = 30\nazimuth_true_deg = 45\n"
         "[noise]\nangle_random_walk_deg_per_sqrt_h = 0.01\n"
         "[errors]\naccel_bias_sigma_mps2 = 1e-3\n";
}

TEST(Session, TheVerdictIsToldWithItsCauses) {
  for (const bool right : {true, false}) {
    wellgyro_session* session = nullptr;
    ASSERT_EQ(wellgyro_open_text(StopJob(right ? "60" : "20").c_str(), ".", &session), WELLGYRO_OK);
    std::int32_t verdict = -1;
    EXPECT_EQ(wellgyro_verdict(session, 0, &verdict, nullptr, 0, nullptr), WELLGYRO_UNUSABLE);
    EXPECT_EQ(verdict, WELLGYRO_VERDICT_FAIL) << "there is no survey";
    PushStop(session);
    ASSERT_EQ(wellgyro_finish(session), WELLGYRO_OK) << wellgyro_error(session);
    ASSERT_EQ(wellgyro_verdict(session, 0, &verdict, nullptr, 0, nullptr), WELLGYRO_OK);
    std::size_t size = 0;
    EXPECT_EQ(wellgyro_verdict(session, 0, &verdict, nullptr, 0, &size), WELLGYRO_USAGE);
    ASSERT_GT(size, 0u);
    std::string causes(size, 'x');
    ASSERT_EQ(wellgyro_verdict(session, 0, &verdict, causes.data(), size, &size), WELLGYRO_OK);
    ASSERT_EQ(causes.back(), '\0');
    std::array<wellgyro_directed_station, 10> stations{};
    std::size_t count = 0;
    ASSERT_EQ(wellgyro_poll_directed(session, stations.data(), stations.size(), &count),
              WELLGYRO_OK);
    ASSERT_GT(count, 0u);
    const wellgyro_directed_station& last = stations[count - 1];
    if (right) {
      EXPECT_NE(verdict, WELLGYRO_VERDICT_FAIL) << causes;
      // (sin I cos A, sin I sin A, cos I), and no variance along it.
      const double tangent[3] = {0.5 * std::sqrt(0.5), 0.5 * std::sqrt(0.5), std::sqrt(0.75)};
      double along = 0, trace = 0;
      for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(last.tangent[i], tangent[i], 0.01) << i;
        trace += last.cov_tangent_rad2[4 * i];
        for (int k = 0; k < 3; ++k) {
          along += last.tangent[i] * last.cov_tangent_rad2[3 * i + k] * last.tangent[k];
        }
      }
      EXPECT_GT(trace, 1e-9);
      EXPECT_LT(along, 1e-6 * trace);
      EXPECT_EQ(last.station.quality & WELLGYRO_QUALITY_UNFIT, 0u);
    } else {
      EXPECT_EQ(verdict, WELLGYRO_VERDICT_FAIL);
      EXPECT_THAT(causes, testing::HasSubstr("gravity"));
      EXPECT_NE(last.station.quality & WELLGYRO_QUALITY_UNFIT, 0u);
    }
    wellgyro_close(session);
  }
}

}  // namespace
}  // namespace wellgyro
