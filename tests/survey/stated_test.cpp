// What a job states that its samples do not meet.
#include <string>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"

#include "support/simulated_survey.h"
#include "support/small_hole.h"

namespace wellgyro {
namespace {

const testing::SmallHole kHole{.to_md = 100};

Survey SurveyBy(const Job& job) {
  testing::CollectingSink sink;
  return testing::SurveyOf(SimulationOf(kHole), job, sink);
}

void ExpectTold(const Job& job, const std::string& what) {
  const Survey survey = SurveyBy(job);
  const Check* check = testing::Find(survey, "stated_unmet");
  ASSERT_NE(check, nullptr);
  EXPECT_EQ(check->verdict, what.empty() ? Verdict::kPass : Verdict::kWarn);
  EXPECT_NE(check->limit_source.find(what), std::string::npos) << check->limit_source;
}

TEST(Stated, AMisrunThatIsNotThereIsTold) {
  Job job = JobOf(kHole);
  EXPECT_EQ(testing::Find(SurveyBy(job), "stated_unmet"), nullptr);
  job.runs = {{.number = 1, .remark = "as planned"}};
  ExpectTold(job, "");
  job.runs.push_back({.number = 7, .misrun = true});
  ExpectTold(job, "[[run]] number = 7");
}

TEST(Stated, AnAzimuthWhosePlaceIsNeverReachedIsTold) {
  Job job = JobOf(kHole);
  job.alignment.method = AlignmentSpec::Method::kExternal;
  job.alignment.azimuth = FromDegrees(kHole.azimuth_deg);
  job.alignment.sigma_azimuth = FromDegrees(1);
  job.alignment.use_fixes = true;
  job.alignment.at_md = 50;
  ExpectTold(job, "");
  job.alignment.at_md = 5'000;
  ExpectTold(job, "[alignment]");
}

}  // namespace
}  // namespace wellgyro
