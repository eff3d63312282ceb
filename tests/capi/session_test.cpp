#include <cmath>
#include <cstdint>
#include <string>

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

}  // namespace
}  // namespace wellgyro
