#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/base/units.h"
#include "wellgyro/math/random.h"
#include "wellgyro/survey/hole/common_courses_internal.h"
#include "wellgyro/survey/hole/hole_roughness_internal.h"

namespace wellgyro {
namespace {

using Eigen::Vector3d;

using units::kDeg;

/// A hole about the horizontal north whose curvature is white noise and walks at random by 0.5 m;
/// stations are where `spacing` leads, with a noise of their own.
SurveyedWell Drawn(const HoleRoughness& is, double noise, double length, Random& random) {
  constexpr double kStep = 0.5;
  double direction[2] = {0, 0}, bend[2] = {0, 0}, md = 0, next = 0;
  std::vector<SurveyPoint> stations;
  for (; md <= length; md += kStep) {
    if (md >= next) {
      stations.push_back({md, 90 * kDeg - direction[0] + noise * random.Normal(),
                          direction[1] + noise * random.Normal(), 0});
      next += 20 + 20 * random.Uniform();
    }
    for (int i = 0; i < 2; ++i) {
      direction[i] += kStep * bend[i] + std::sqrt(is.kink * kStep) * random.Normal();
      bend[i] += std::sqrt(is.wander * kStep) * random.Normal();
    }
  }
  return SurveyWell(stations, Vector3d::Zero());
}

RoughListing Listing(const SurveyedWell& well, double noise) {
  return {&well, std::vector<double>(well.survey.size(), noise * noise)};
}

class Roughness : public testing::TestWithParam<HoleRoughness> {};

// Of 60 holes of 50 stations each: the mean of what is estimated between stations is within three
// tenths of the truth (1.23 where curvature walks only, .78 where both do). As neither part may be
// below 0, each takes some of the other.
TEST_P(Roughness, IsFoundBesideTheNoiseOfStations) {
  const HoleRoughness is = GetParam();
  Random random(7);
  double sum = 0, square = 0;
  constexpr int kHoles = 60;
  for (int i = 0; i < kHoles; ++i) {
    const SurveyedWell well = Drawn(is, 0.03 * kDeg, 1500, random);
    const HoleRoughness found = RoughnessOf(std::vector{Listing(well, 0.03 * kDeg)}, 0, 1500);
    const double ratio = found.OffSpline(30, 0.5, 0.5) / is.OffSpline(30, 0.5, 0.5);
    sum += ratio;
    square += ratio * ratio;
  }
  const double mean = sum / kHoles;
  const double sigma = std::sqrt((square / kHoles - mean * mean) / kHoles);
  EXPECT_NEAR(mean, 1, 0.3);
  EXPECT_LT(sigma, 0.1);
  RecordProperty("mean", std::to_string(mean) + " +- " + std::to_string(sigma));
}
INSTANTIATE_TEST_SUITE_P(Holes, Roughness,
                         testing::Values(HoleRoughness{0.01 * kDeg * kDeg, 0},
                                         HoleRoughness{0, 3e-5 * kDeg* kDeg},
                                         HoleRoughness{0.005 * kDeg * kDeg, 2e-5 * kDeg* kDeg}));

// A hole of arcs is not rough, nor is one of which there are too few stations.
TEST(RoughnessOf, ArcsAndFewStationsHaveNone) {
  std::vector<SurveyPoint> stations;
  for (int k = 0; k < 20; ++k) stations.push_back({30.0 * k, (10 + 3 * k) * kDeg, 40 * kDeg, 0});
  SurveyedWell well = SurveyWell(stations, Vector3d::Zero());
  EXPECT_EQ(RoughnessOf(std::vector{Listing(well, 0)}, 0, 1000).OffSpline(30, 0.5, 0.5), 0);
  stations.resize(4);
  stations[2].azimuth += 1;
  well = SurveyWell(stations, Vector3d::Zero());
  EXPECT_EQ(RoughnessOf(std::vector{Listing(well, 0)}, 0, 1000).OffSpline(30, 0.5, 0.5), 0);
}

// By hand: of 10 and 25 m, from the second survey's begin to where the first ends.
TEST(CommonStations, AreOfTheCoarserWhereverItIsSo) {
  const auto of = [](std::vector<double> md) {
    SurveyedWell well;
    for (const double d : md) well.survey.push_back({d, 0.5, 0, 0});
    return well;
  };
  const std::vector<double> expected = {5, 30, 55, 60, 70, 80, 90, 95};
  EXPECT_EQ(CommonStations(of({0, 10, 20, 30, 40, 50, 60, 70, 80, 90, 95}),
                           of({5, 30, 55, 60, 65, 70, 75, 80, 85, 90, 100}), 5, 95),
            expected);
}

}  // namespace
}  // namespace wellgyro
