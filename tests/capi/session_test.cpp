#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/time.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/fit/run_adjustment.h"
#include "wellgyro/io/exchange/survey_csv.h"
#include "wellgyro/io/toml/job_file.h"
#include "wellgyro/survey/surveyor.h"

#include "wellgyro.h"

namespace wellgyro {
namespace {

constexpr const char* kJob =
    "format = \"wellgyro.job/1\"\n[well]\nlatitude_deg = 60\n[stations]\nat_stops = true\n"
    "[noise]\nangle_random_walk_deg_per_sqrt_h = 0.01\n[errors]\ngyro_bias_sigma_deg_per_h = 0.1\n"
    "accel_bias_sigma_mps2 = 1e-3\n";
constexpr int kSamples = 3000;

wellgyro_imu SampleAt(int i) {
  const double tilt = FromDegrees(30), rise = tilt - FromDegrees(60);
  wellgyro_imu sample{};
  sample.tool_ns = i * std::int64_t{100'000'000};
  sample.utime_us = i * std::int64_t{100'000};
  sample.seq = i;
  sample.period_ns = 100'000'000;
  sample.rate_rad_per_s[0] = kEarthRate * std::cos(rise);
  sample.rate_rad_per_s[2] = kEarthRate * std::sin(rise);
  sample.force_mps2[0] = 9.82 * std::sin(tilt);
  sample.force_mps2[2] = -9.82 * std::cos(tilt);
  return sample;
}

wellgyro_depth MarkAt(int i) {
  wellgyro_depth mark{};
  mark.utime_us = i * std::int64_t{100'000};
  mark.seq = i;
  mark.md_m = 500;
  mark.sigma_m = 0.1;
  return mark;
}

std::string SurveyThroughC() {
  wellgyro_session* session = nullptr;
  EXPECT_EQ(wellgyro_open_text(kJob, ".", &session), WELLGYRO_OK) << wellgyro_error(nullptr);
  for (int i = 0; i < kSamples; ++i) {
    const wellgyro_imu sample = SampleAt(i);
    EXPECT_EQ(wellgyro_push_imu(session, &sample, 1), WELLGYRO_OK);
    if (i % 10 != 0) continue;
    const wellgyro_depth mark = MarkAt(i);
    EXPECT_EQ(wellgyro_push_depth(session, &mark, 1), WELLGYRO_OK);
  }
  EXPECT_EQ(wellgyro_finish(session), WELLGYRO_OK) << wellgyro_error(session);
  std::vector<char> text(100'000);
  std::size_t size = 0;
  EXPECT_EQ(wellgyro_survey_csv(session, 0, text.data(), text.size(), &size), WELLGYRO_OK)
      << wellgyro_error(session);
  EXPECT_EQ(wellgyro_survey_csv(session, 0, text.data(), 10, &size), WELLGYRO_USAGE);
  EXPECT_EQ(size, std::strlen(text.data()) + 1);
  wellgyro_station station;
  std::size_t count = 0;
  EXPECT_EQ(wellgyro_poll(session, &station, 1, &count), WELLGYRO_OK);
  EXPECT_EQ(count, 1u);
  EXPECT_NEAR(station.inclination_rad, FromDegrees(30), 1e-3);
  EXPECT_EQ(wellgyro_refused(session), 0) << wellgyro_error(session);
  const wellgyro_imu late = SampleAt(kSamples);
  EXPECT_EQ(wellgyro_push_imu(session, &late, 1), WELLGYRO_USAGE);
  wellgyro_close(session);
  return text.data();
}

std::string SurveyThroughCpp() {
  const auto file = ParseJob(kJob, "job", ".");
  EXPECT_TRUE(file);
  Sink sink;
  const LeastSquaresAdjuster adjuster;
  Surveyor surveyor(file->job, sink, &adjuster);
  for (int i = 0; i < kSamples; ++i) {
    const wellgyro_imu from = SampleAt(i);
    ImuSample sample;
    sample.stamp.tool_time.ns = from.tool_ns;
    sample.stamp.utc.ns = from.utime_us * 1000;
    sample.stamp.seq = from.seq;
    sample.stamp.period_ns = from.period_ns;
    sample.w_IT_T = Eigen::Vector3d(from.rate_rad_per_s);
    sample.f_T = Eigen::Vector3d(from.force_mps2);
    surveyor.Push(sample);
    if (i % 10 != 0) continue;
    DepthMark mark;
    mark.utc.ns = from.utime_us * 1000;
    mark.seq = i;
    mark.md = 500;
    mark.sigma = 0.1;
    surveyor.Push(mark);
  }
  surveyor.Finish();
  return SurveyCsv(surveyor.Current(0).chosen, nullptr);
}

TEST(Session, GivesTheBytesOfCpp) {
  const std::string through_c = SurveyThroughC();
  EXPECT_EQ(through_c, SurveyThroughCpp());
  EXPECT_THAT(through_c, testing::HasSubstr("gyrocompass"));
}

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

}  // namespace
}  // namespace wellgyro
