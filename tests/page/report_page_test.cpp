#include "wellgyro/page/report_page.h"

#include <string>

#include <gmock/gmock.h>

namespace wellgyro {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr const char* kLeast = R"({"format": "wellgyro.survey/1"})";

TEST(ReportPage, SaysOfAllThatIsNotThereThatItWasNotMeasured) {
  const auto page = ReportPage(kLeast);
  ASSERT_TRUE(page) << page.fault().text;
  for (const char* what :
       {"Verdict: not given", "End of survey: not measured", "Path: not measured",
        "North at rest: not measured", "Runs: not measured", "Checks: not measured",
        "Diagnosis: not measured", "Reliability: not measured", "Stations: not measured"}) {
    EXPECT_THAT(*page, HasSubstr(what));
  }
}

TEST(ReportPage, ForbidsEveryRequestAndEveryOtherScript) {
  const auto page = ReportPage(kLeast);
  ASSERT_TRUE(page);
  EXPECT_THAT(*page, HasSubstr("content=\"default-src 'none'; script-src 'sha256-"));
  EXPECT_THAT(*page, Not(HasSubstr("unsafe")));
  EXPECT_THAT(*page, Not(HasSubstr(" src=")));
  EXPECT_THAT(*page, HasSubstr("Redistribution and use in source and binary forms"));
}

TEST(ReportPage, IsTheSameTwice) { EXPECT_EQ(*ReportPage(kLeast), *ReportPage(kLeast)); }

TEST(ReportPage, ShowsTextAsText) {
  const auto page = ReportPage(
      R"({"format": "wellgyro.survey/1", "run": {"well": {"name": "</script><b>&\u0000"}}})");
  ASSERT_TRUE(page);
  EXPECT_THAT(*page, Not(HasSubstr("<b>")));
  EXPECT_THAT(*page, HasSubstr("<h1>Gyro survey report: "
                               "<bdi>&lt;/script&gt;&lt;b&gt;&amp;\uFFFD</bdi></h1>"));
}

// Members of any type stand where others are expected.
TEST(ReportPage, OddDocumentsDoNoHarm) {
  for (const char* odd :
       {R"("stations": 3)", R"("stations": {"columns": 1, "rows": [[1]]})",
        R"("stations": {"columns": ["MD[m]", 5], "rows": [3, [], [1, 2, 3], ["x"]]})",
        R"("run": {"run": [1, "x", {"north_fix": {"a": 1}, "fit": [], "number": "1"}]})",
        R"("run": {"verdict": {"causes": [1, {}], "verdict": 7}, "tool": [[]], "input": [3]})",
        R"("checks": {"columns": ["CODE", "VERDICT"], "rows": [["gravity", "odd"], [1, 2]]})",
        R"("pass_differences": [1, {"columns": ["MD[m]"], "rows": [[1]]}], "others": [1, {}])",
        R"("diagnosis": {"columns": [1], "rows": [[{}], 3]}, "losses": [3], "source": [])",
        R"("stations": {"columns": ["MD[m]","N[m]","E[m]","TVD[m]"],
            "rows": [[0,0,0,0],[1e300,1e300,-1e300,1e300]]})",
        R"("run": {"run": [{"begin_utime_us": 1e300, "end_utime_us": -1e300}]})"}) {
    const auto page = ReportPage(std::string(R"({"format": "wellgyro.survey/1", )") + odd + "}");
    ASSERT_TRUE(page) << odd;
    EXPECT_TRUE(page->ends_with("</html>\n")) << odd;
  }
}

TEST(ReportPage, RefusesWhatIsNoSurvey) {
  for (const char* text : {"", "{", "[]", "3", R"({"format": "wellgyro.survey/2"})"}) {
    EXPECT_FALSE(ReportPage(text)) << text;
  }
  EXPECT_FALSE(ReportPage(std::string(100000, '[')));
}

}  // namespace
}  // namespace wellgyro
