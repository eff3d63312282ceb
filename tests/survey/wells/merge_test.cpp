#include "wellgyro/survey/wells/merge.h"

#include <cmath>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/io/toml/model_catalogue.h"
#include "wellgyro/math/random.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/uncertainty/ellipse.h"
#include "wellgyro/uncertainty/station_errors.h"

namespace wellgyro {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using testing::HasSubstr;

using units::kDeg;

Surroundings MergePlace() {
  Surroundings place;
  place.latitude = 60 * kDeg;
  place.field = 5e-5;
  place.dip = 70 * kDeg;
  place.declination = 0;
  return place;
}

SurveyPoint MergeHoleAt(double md) {
  const double inclination = md < 300 ? 0 : 50 * (1 - std::exp(-(md - 300) / 600));
  return {md, inclination * kDeg, (70 + 40 * std::sin(md / 900)) * kDeg, 0};
}

MergeLeg Leg(const char* name, const ErrorModel& model, int run, double from, double to,
             double spacing) {
  MergeLeg leg;
  leg.name = name;
  leg.model = &model;
  leg.run = run;
  for (double md = from; md <= to; md += spacing) leg.stations.push_back(MergeHoleAt(md));
  return leg;
}

double SemiMajor(const Matrix3d& cov) {
  return HorizontalEllipse(cov, 0.5).semi_major / ConfidenceFactor(0.5, 2);
}

MergedSurvey Merged(const std::vector<MergeLeg>& legs, const MergePolicy& policy = {}) {
  return Merge(legs, Vector3d::Zero(), Matrix3d::Zero(), MergePlace(), policy);
}

class MergeLegs : public testing::Test {
 protected:
  const ErrorModel mwd_ = *OwnModel("ISCWSA MWD Rev 4");
  const ErrorModel gyro_ = *OwnModel("GYRO-NS-CT");
};

// Half of the runs of the definitive survey are another tool's: its covariance at the end is never
// larger than that of any leg that reaches all the way, but for the gain that a change must bring.
TEST_F(MergeLegs, IsNeverLessSureThanItsBestLeg) {
  Random random(7);
  for (int i = 0; i < 30; ++i) {
    const double end = 1500 + 1000 * random.Uniform();
    const double shoe = 600 + 900 * random.Uniform(), tie_in = 500 * random.Uniform();
    const ErrorModel& second = random.Uniform() < 0.5 ? mwd_ : gyro_;
    std::vector<MergeLeg> legs = {Leg("mwd", mwd_, 1, 0, end, 30),
                                  Leg("gyro", gyro_, 2, 0, shoe, 25),
                                  Leg("second", second, 3, tie_in, end, 30)};
    if (i % 3 == 0) legs.push_back(Leg("whole", gyro_, 4, 0, end, 30));
    const MergedSurvey merged = Merged(legs);
    for (const MergeLeg& leg : legs) {
      if (leg.stations.front().md > 0 || leg.stations.back().md < end - 60) continue;
      const MergedSurvey alone = Merged({leg});
      EXPECT_LE(merged.measure, alone.measure * 1.05 + 1e-12) << leg.name;
    }
    EXPECT_NEAR(merged.measure, SemiMajor(merged.errors.cov_p_W.back()), 1e-12);
    EXPECT_EQ(merged.choices.size(), merged.legs.size());
  }
}

// The true hole is that of the stations; each leg draws its own errors. Error squared over its
// covariance at the end of 200 wells: mean 3, within four sigmas of that mean.
TEST_F(MergeLegs, ItsErrorsAreAsLargeAsItsCovarianceSays) {
  Random random(11);
  double sum = 0;
  constexpr int kWells = 200;
  for (int w = 0; w < kWells; ++w) {
    std::vector<MergeLeg> legs = {Leg("gyro", gyro_, 1, 0, 1200, 60),
                                  Leg("mwd", mwd_, 2, 900, 2100, 60)};
    std::vector<SurveyPoint> truth;
    Vector3d of_courses = Vector3d::Zero();
    for (double md = 0; md <= 2100; md += 60) truth.push_back(MergeHoleAt(md));
    for (MergeLeg& leg : legs) {
      const ToolLeg whole{leg.model, 0, leg.stations.size(), leg.run};
      // The tool's mode is that of a tool which has run in from the top.
      std::vector<SurveyPoint> from_top = truth;
      const ToolLeg all{leg.model, 0, from_top.size(), leg.run};
      const SurveyErrors errors = ErrorsAtStations(from_top, MergePlace(), {&all, 1});
      std::map<std::pair<std::size_t, std::int64_t>, double> drawn;
      std::map<double, Vector3d> direction;
      std::map<double, double> depth;
      for (const StationError& e : errors.errors) {
        const auto [u, is_new] = drawn.try_emplace({e.source, e.group}, 0);
        if (is_new) u->second = random.Normal();
        direction.try_emplace(from_top[e.station].md, Vector3d::Zero());
        direction[from_top[e.station].md] += u->second * e.direction_W;
        const double md = from_top[e.station].md;
        const bool taken = leg.name == "gyro" ? md <= 1200 : md > 1200;
        if (taken) of_courses += u->second * e.displacement_W;
        depth[from_top[e.station].md] += u->second * e.md;
      }
      for (SurveyPoint& p : leg.stations) {
        if (p.md == 0) continue;
        const double md = p.md;
        const Vector3d t = (Tangent(p.inclination, p.azimuth) +
                            direction.try_emplace(md, Vector3d::Zero()).first->second)
                               .normalized();
        p.inclination = std::acos(std::min(1.0, t.z()));
        p.azimuth = WrapTwoPi(std::atan2(t.y(), t.x()));
        p.md += depth[md];
      }
      ASSERT_EQ(whole.end, leg.stations.size());
    }
    MergePolicy policy;
    policy.in_order = true;
    const MergedSurvey merged = Merged(legs, policy);
    ASSERT_EQ(merged.legs.size(), 2u);
    const SurveyedWell true_well = SurveyWell(truth, Vector3d::Zero());
    const Vector3d error = merged.well.position_W.back() + of_courses - true_well.position_W.back();
    sum += error.dot(merged.errors.cov_p_W.back().llt().solve(error));
  }
  EXPECT_NEAR(sum / kWells, 3, 4 * std::sqrt(6.0 / kWells));
  RecordProperty("mean", std::to_string(sum / kWells));
}

TEST_F(MergeLegs, InOrderTheFirstInTheListWinsWhereverItReaches) {
  MergePolicy policy;
  policy.in_order = true;
  const MergedSurvey merged =
      Merged({Leg("mwd", mwd_, 1, 600, 1800, 30), Leg("gyro", gyro_, 2, 0, 1500, 25)}, policy);
  ASSERT_EQ(merged.choices.size(), 2u);
  EXPECT_EQ(merged.choices[0].leg, 1u);
  EXPECT_NEAR(merged.choices[0].to_md, 600, 1e-9);  // the gyro's own station there
  EXPECT_EQ(merged.choices[1].leg, 0u);
  EXPECT_NEAR(merged.choices[1].from_md, 630, 1e-9);
  EXPECT_THAT(merged.choices[1].reason, HasSubstr("first in the list"));
  EXPECT_EQ(merged.well.survey.size(), 25u + 40u);
}

TEST_F(MergeLegs, WhatIsRuledOutIsNotTakenAndSaysWhy) {
  std::vector<MergeLeg> legs = {Leg("mwd", mwd_, 1, 0, 1800, 30),
                                Leg("gyro", gyro_, 2, 0, 1800, 25)};
  legs[1].left_out = "misrun";
  const MergedSurvey merged = Merged(legs);
  ASSERT_EQ(merged.choices.size(), 1u);
  EXPECT_EQ(merged.choices[0].leg, 0u);
  ASSERT_EQ(merged.unused.size(), 1u);
  EXPECT_THAT(merged.unused[0], HasSubstr("gyro: ruled out: misrun"));
  legs[0].left_out = "too";
  EXPECT_THROW(Merged(legs), std::invalid_argument);
}

// Two of one run are one survey cut in two: the same covariance as uncut. Of two runs, less, as
// what is systematic is drawn twice.
TEST_F(MergeLegs, LegsOfOneRunShareTheirErrorsThroughTheTie) {
  const MergedSurvey whole = Merged({Leg("whole", mwd_, 1, 0, 1800, 30)});
  const MergedSurvey cut =
      Merged({Leg("upper", mwd_, 1, 0, 900, 30), Leg("lower", mwd_, 1, 930, 1800, 30)});
  ASSERT_EQ(cut.legs.size(), 2u);
  EXPECT_LT((cut.errors.cov_p_W.back() - whole.errors.cov_p_W.back()).norm(),
            1e-12 * whole.errors.cov_p_W.back().norm());
  const MergedSurvey runs =
      Merged({Leg("upper", mwd_, 1, 0, 900, 30), Leg("lower", mwd_, 2, 930, 1800, 30)});
  EXPECT_LT(runs.measure, 0.95 * whole.measure);
}

TEST_F(MergeLegs, AParentIsKeptAboveTheKickOff) {
  std::vector<MergeLeg> legs = {Leg("parent", mwd_, 1, 0, 900, 30),
                                Leg("side", gyro_, 2, 0, 1800, 25)};
  legs[0].kept = true;
  const MergedSurvey merged = Merged(legs);
  ASSERT_EQ(merged.choices.size(), 2u);
  EXPECT_EQ(merged.choices[0].leg, 0u);
  EXPECT_NEAR(merged.choices[0].to_md, 900, 1e-9);
  EXPECT_THAT(merged.choices[0].reason, HasSubstr("parent"));
}

TEST_F(MergeLegs, AGapIsRefusedByItsDepths) {
  const std::vector<MergeLeg> legs = {Leg("upper", mwd_, 1, 0, 900, 30),
                                      Leg("lower", mwd_, 2, 1200, 1800, 30)};
  try {
    Merged(legs);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("MD 900.00 to 1200.00 m"));
  }
  MergePolicy policy;
  policy.max_gap = 400;
  EXPECT_EQ(Merged(legs, policy).legs.size(), 2u);
}

TEST_F(MergeLegs, ManyLegsStillEndInOneSurvey) {
  std::vector<MergeLeg> legs;
  const std::vector<std::string> names = {"a", "b", "c", "d", "e", "f", "g"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    const double from = 100.0 * static_cast<double>(i);
    legs.push_back(
        Leg(names[i].c_str(), i % 2 ? gyro_ : mwd_, static_cast<int>(i) + 1, from, from + 700, 50));
  }
  const MergedSurvey merged = Merged(legs);
  EXPECT_NEAR(merged.well.survey.back().md, 1300, 1e-9);
  EXPECT_LT(merged.legs.size(), 7u);
}

}  // namespace
}  // namespace wellgyro
