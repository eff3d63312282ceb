#include "wellgyro/survey/wells/compare.h"

#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/base/units.h"
#include "wellgyro/math/random.h"

#include "survey/wells/compared_surveys.h"

namespace wellgyro {
namespace {

using Eigen::Vector3d;

using test::CheckOf;
using test::ComparedPair;
using test::Drawn;
using test::GoodTool;
using test::kComparedEnd;
using test::Somewhere;
using test::StationsEvery;
using units::kDeg;

// What is global in both drops out of the difference: 0.3 deg there leaves the sigma of 0.05 deg
// systematic and 0.03 deg random twice, beside what is local. XYM2 is one of azimuth times sin I.
TEST(Compare, SharedErrorsAreTakenOutOnce) {
  const ErrorModel tool = GoodTool();
  Random random(1);
  const ComparedPair pair = Drawn(tool, tool, 1e-9, random);
  CompareOptions options;
  options.at = {900};
  const ComparedPlace place = Compare(pair.first, pair.second, options).places.front();
  const double sin_inc = std::sin(place.inclination[0]);
  const double twice = 2 * (0.05 * 0.05 + 0.03 * 0.03 / (sin_inc * sin_inc) + 0.03 * 0.03);
  const double local = 0.05 * 0.05 / (sin_inc * sin_inc);
  const double expected = std::sqrt(twice + local) * kDeg;
  // Depth errors times the turn of the hole, and errors between stations, make the rest.
  EXPECT_NEAR(*place.sigma_azimuth, expected, 0.05 * expected);
  options.same_run = true;
  const ComparedPlace same = Compare(pair.first, pair.second, options).places.front();
  const double random_only = std::sqrt(2 * 0.03 * 0.03 + local) * kDeg;
  EXPECT_NEAR(*same.sigma_azimuth, random_only, 0.05 * random_only);
}

TEST(Compare, TheOtherWayRoundEverythingChangesItsSign) {
  const ErrorModel tool = GoodTool();
  Random random(2);
  const ComparedPair pair = Drawn(tool, tool, 1e-3, random);
  const Comparison ab = Compare(pair.first, pair.second), ba = Compare(pair.second, pair.first);
  ASSERT_EQ(ab.places.size(), ba.places.size());
  for (std::size_t i = 0; i < ab.places.size(); ++i) {
    EXPECT_LT((ab.places[i].position_difference_W + ba.places[i].position_difference_W).norm(),
              1e-12);
    EXPECT_LT((ab.places[i].cov_position_W - ba.places[i].cov_position_W).norm(), 1e-12);
    EXPECT_NEAR(*ab.places[i].azimuth_difference, -*ba.places[i].azimuth_difference, 1e-15);
  }
  EXPECT_NEAR(ab.depth_offset->value, -ba.depth_offset->value, 1e-3 * ab.depth_offset->sigma);
  EXPECT_NEAR(ab.azimuth_offset->sigma, ba.azimuth_offset->sigma, 1e-3 * ab.azimuth_offset->sigma);
}

// In a straight hole no direction shows a depth offset; it is not done, and not a giant number.
TEST(Compare, AStraightHoleShowsNoDepthOffset) {
  const ErrorModel tool = GoodTool();
  std::vector<SurveyPoint> stations;
  for (int k = 0; k < 20; ++k) stations.push_back({100.0 * k, 0.7, 1.0, 0});
  const ToolLeg leg{&tool, 0, stations.size(), 1};
  ComparedSurvey survey;
  survey.well = SurveyWell(stations, Vector3d::Zero());
  survey.errors = ErrorsAtStations(survey.well.survey, Somewhere(), {&leg, 1});
  const Comparison c = Compare(survey, survey);
  EXPECT_FALSE(c.depth_offset);
  ASSERT_TRUE(c.azimuth_offset);
  EXPECT_EQ(CheckOf(c, "compare_depth_offset").verdict, Verdict::kNotDone);
  EXPECT_EQ(c.verdict.verdict, Verdict::kPass);
}

TEST(Compare, SigmasOfTheSurveysOwnAreHeldAgainstTheWorstDepth) {
  ComparedSurvey a, b;
  a.well = SurveyWell(StationsEvery(30), Vector3d::Zero());
  std::vector<SurveyPoint> moved = StationsEvery(30);
  moved[40].azimuth += 2.0 * kDeg;
  b.well = SurveyWell(moved, Vector3d::Zero());
  a.own.assign(a.well.survey.size(), {0.1 * kDeg, 0.2 * kDeg, Eigen::Matrix3d::Identity()});
  b.own = a.own;
  const Comparison c = Compare(a, b);
  const Check& azimuth = CheckOf(c, "compare_azimuth");
  EXPECT_EQ(azimuth.verdict, Verdict::kFail);
  EXPECT_NEAR(*azimuth.md, 40 * 30, 1e-9);
  const double level = std::sin(moved[40].inclination);
  const double sigma = std::hypot(std::sqrt(2.0) * 0.2 * level, 0.05);
  EXPECT_NEAR(*azimuth.value, 2.0 * level / sigma, 1e-3 * *azimuth.value);
  EXPECT_EQ(CheckOf(c, "compare_depth_offset").verdict, Verdict::kNotDone);
}

TEST(Compare, RefusesWhatMakesNoSense) {
  const ErrorModel tool = GoodTool();
  Random random(3);
  const ComparedPair pair = Drawn(tool, tool, 1e-3, random);
  CompareOptions options;
  options.at = {kComparedEnd + 100};
  EXPECT_THROW(Compare(pair.first, pair.second, options), std::invalid_argument);
  options.at = {std::nan("")};
  EXPECT_THROW(Compare(pair.first, pair.second, options), std::invalid_argument);
  options.at.clear();
  options.every = 1e-3;
  EXPECT_THROW(Compare(pair.first, pair.second, options), std::invalid_argument);
  options.every = 0;
  options.local_sigma = 0;
  EXPECT_THROW(Compare(pair.first, pair.second, options), std::invalid_argument);
  ComparedSurvey bare;
  bare.well = pair.first.well;
  EXPECT_THROW(Compare(bare, pair.second), std::invalid_argument);
}

}  // namespace
}  // namespace wellgyro
