#include "wellgyro/survey/compare.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <ostream>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/io/toml/model_catalogue.h"
#include "wellgyro/math/random.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/math/statistics.h"
#include "wellgyro/trajectory/trajectory.h"

namespace wellgyro {
namespace {

using Eigen::Vector3d;

using units::kDeg;
constexpr double kEnd = 1800;  // [m]

/// Arcs of 180 m, a whole number of which is between any stations of these tests, so that nothing
/// is lost between stations.
Trajectory TheHole() {
  std::vector<double> md, inclination, azimuth;
  for (int k = 0; k <= 10; ++k) {
    md.push_back(180.0 * k);
    inclination.push_back((30 + 20 * std::sin(md.back() / 500)) * kDeg);
    azimuth.push_back((40 + 30 * std::sin(md.back() / 600 + 1)) * kDeg);
  }
  return Trajectory(md, inclination, azimuth, Vector3d::Zero());
}

/// A hole by metres, from how fast its direction turns to the high side and to the right [rad/m].
template <typename Bend>
Trajectory Drilled(Bend bend) {
  std::vector<double> md = {0}, inclination = {45 * kDeg}, azimuth = {40 * kDeg};
  while (md.back() < kEnd + 10) {
    const auto [high, right] = bend(md.back(), inclination.back());
    const double i = inclination.back() + high;
    azimuth.push_back(azimuth.back() + right / std::sin(i));
    inclination.push_back(i);
    md.push_back(md.back() + 1);
  }
  return Trajectory(md, inclination, azimuth, Vector3d::Zero());
}

/// An S and a turn, by no arc at all.
Trajectory Smooth() {
  return Drilled([](double md, double inclination) {
    return std::pair(20 * kDeg / 300 * std::cos(md / 300),
                     30 * kDeg / 350 * std::cos(md / 350 + 1) * std::sin(inclination));
  });
}

/// Curvature walks at random, held to 1.5 deg/30 m over 100 m, and the inclination about 45 deg.
Trajectory Wandering(Random& random) {
  double high = 0, right = 0;
  const double step = 1.5 * kDeg / 30 * std::sqrt(2 / 100.0);
  return Drilled([=, &random](double, double inclination) mutable {
    high += -high / 100 + step * random.Normal() - (inclination - 45 * kDeg) / 2e4;
    right += -right / 100 + step * random.Normal();
    return std::pair(high, right);
  });
}

/// A motor slides for 9 m somewhere in every 30 m, with 6 deg/30 m in any direction.
Trajectory Slid(Random& random) {
  double toolface = 0, begin = 0;
  return Drilled([=, &random](double md, double inclination) mutable {
    const double in_stand = std::fmod(md, 30);
    if (in_stand == 0) {
      begin = 21 * random.Uniform();
      toolface = 2 * kPi * random.Uniform();
      const bool out = std::cos(toolface) * (inclination - 45 * kDeg) > 0;
      if (std::abs(inclination - 45 * kDeg) > 20 * kDeg && out) toolface += kPi;
    }
    const double bend = in_stand >= begin && in_stand < begin + 9 ? 6 * kDeg / 30 : 0;
    return std::pair(bend * std::cos(toolface), bend * std::sin(toolface));
  });
}

std::vector<SurveyPoint> StationsIn(const Trajectory& hole, double spacing, double offset = 0) {
  std::vector<SurveyPoint> stations;
  for (double md = 0; md <= kEnd; md += md == 0 && offset > 0 ? offset : spacing) {
    const TrajectoryPoint p = hole.AtMd(md);
    stations.push_back({md, p.inclination, p.azimuth, 0});
  }
  return stations;
}

std::vector<SurveyPoint> StationsEvery(double spacing) {
  static const Trajectory hole = TheHole();
  return StationsIn(hole, spacing);
}

Surroundings Somewhere() {
  Surroundings place;
  place.latitude = 60 * kDeg;
  place.field = 5e-5;
  place.dip = 70 * kDeg;
  place.declination = 0;
  return place;
}

/// A tool so good, times `scale`, that shifts of 0.3 m and 0.2 deg are seen sometimes.
ErrorModel GoodTool(double scale = 1) {
  ErrorModel model;
  model.name = "good";
  const auto add = [&](const char* name, const char* weight, double magnitude, Propagation reach) {
    model.terms.push_back({name, FindWeight(weight), scale * magnitude, reach});
  };
  add("AZ", "AZ", 0.05 * kDeg, Propagation::kSystematic);
  add("AZG", "AZ", 0.3 * kDeg, Propagation::kGlobal);
  add("XYM1", "XYM1", 0.03 * kDeg, Propagation::kSystematic);
  add("XYM2", "XYM2", 0.03 * kDeg, Propagation::kSystematic);
  add("DREF", "DREF", 0.1, Propagation::kSystematic);
  add("DSF", "DSF", 1e-4, Propagation::kSystematic);
  add("DRFR", "DREF", 0.02, Propagation::kRandom);
  add("AZR", "AZ", 0.03 * kDeg, Propagation::kRandom);
  model.max_inclination = kPi;
  model.vertical_limit = 1e-6;
  return model;
}

/// Draws of sources by name of term: those that reach beyond a run are drawn once for both.
using Draws = std::map<std::pair<std::string, std::int64_t>, double>;

/// A survey of a hole with errors drawn from the models of its legs.
ComparedSurvey Surveyed(std::vector<SurveyPoint> stations, const ErrorModel& model,
                        double local_sigma, Random& random, Draws& shared) {
  const ToolLeg leg{&model, 0, stations.size(), 1};
  const SurveyErrors errors = ErrorsAtStations(stations, Somewhere(), {&leg, 1});
  std::vector<Vector3d> direction;
  for (const SurveyPoint& p : stations) direction.push_back(Tangent(p.inclination, p.azimuth));
  std::map<std::pair<std::size_t, std::int64_t>, double> own;
  for (const StationError& e : errors.errors) {
    const NamedSource& source = errors.sources[e.source];
    const bool is_shared = source.propagation == Propagation::kGlobal;
    double u = 0;
    if (is_shared) {
      const auto [at, is_new] = shared.try_emplace({source.term, e.group}, 0);
      if (is_new) at->second = random.Normal();
      u = at->second;
    } else {
      const auto [at, is_new] = own.try_emplace({e.source, e.group}, 0);
      if (is_new) at->second = random.Normal();
      u = at->second;
    }
    direction[e.station] += u * e.direction_W;
    stations[e.station].md += u * e.md;
  }
  for (std::size_t k = 1; k < stations.size(); ++k) {
    const Vector3d local{random.Normal(), random.Normal(), random.Normal()};
    const Vector3d t = (direction[k] + local_sigma * local).normalized();
    stations[k].inclination = std::acos(t.z());
    stations[k].azimuth = WrapTwoPi(std::atan2(t.y(), t.x()));
  }
  stations[0].md = 0;
  ComparedSurvey survey;
  survey.well = SurveyWell(stations, Vector3d::Zero());
  const ToolLeg again{&model, 0, stations.size(), 1};
  survey.errors = ErrorsAtStations(survey.well.survey, Somewhere(), {&again, 1});
  return survey;
}

struct Pair {
  ComparedSurvey first, second;
};

/// The first at wider stations, so that these are compared, and carrying all that is local.
Pair Drawn(const ErrorModel& a, const ErrorModel& b, double local_sigma, Random& random,
           double finer = 20) {
  Draws shared;
  Pair pair{Surveyed(StationsEvery(60), a, local_sigma, random, shared),
            Surveyed(StationsEvery(finer), b, 0, random, shared)};
  return pair;
}

const Check& CheckOf(const Comparison& c, const std::string& code) {
  return *std::ranges::find(c.checks, code, &Check::code);
}

/// Sums over many pairs.
struct Tally {
  double sum = 0, freedom = 0;
  void Add(const Check& check) {
    if (check.freedom > 0) {
      sum += *check.value * check.freedom;
      freedom += check.freedom;
    } else {
      sum += std::pow(*check.value / *check.sigma, 2);
      freedom += 1;
    }
  }
};

/// What of many pairs without a difference has to be so.
class NoDifference {
 public:
  void Add(const Comparison& c) {
    ++pairs_;
    for (const Check& check : c.checks) {
      ASSERT_NE(check.verdict, Verdict::kNotDone) << check.code << " " << check.limit_source;
      tallies_[check.code].Add(check);
    }
    failed_ += c.verdict.verdict == Verdict::kFail;
    warned_ += c.verdict.verdict != Verdict::kPass;
  }

  /// Every statistic within four of its sigmas, or no lower than `timid`, and no more pairs fail
  /// and warn than promised.
  void Judge(double timid = 1) const {
    for (const auto& [code, tally] : tallies_) {
      const double band = 4 * std::sqrt(2 / tally.freedom), mean = tally.sum / tally.freedom;
      EXPECT_LT(mean, 1 + band) << code;
      EXPECT_GT(mean, timid - band) << code;
      testing::Test::RecordProperty(code, std::to_string(tally.sum / tally.freedom));
    }
    EXPECT_EQ(tallies_.size(), 6u);
    EXPECT_LE(failed_, pairs_ / 100 + 4 * std::sqrt(pairs_ * 0.01));
    EXPECT_LE(warned_, pairs_ / 10 + 4 * std::sqrt(pairs_ * 0.09));
    EXPECT_GT(warned_, 0);
  }

 private:
  std::map<std::string, Tally> tallies_;
  int pairs_ = 0, failed_ = 0, warned_ = 0;
};

class Closure : public testing::TestWithParam<std::tuple<std::string, int>> {};

// Nothing but the models' own errors, drawn: every statistic lies in its band of four sigmas, 150
// pairs each, 500 with --long, and of the pairs no more fail and warn than were promised.
TEST_P(Closure, UnderNoDifferenceEveryStatisticIsInItsBand) {
  const auto& [model, pairs] = GetParam();
  const bool good = model == "good";
  const ErrorModel a = good ? GoodTool() : *OwnModel(model);
  const ErrorModel b = good ? GoodTool() : *OwnModel("ISCWSA MWD Rev 4");
  Random random(20261122);
  NoDifference none;
  CompareOptions options;
  for (int i = 0; i < pairs; ++i) {
    const Pair pair = Drawn(a, b, options.local_sigma, random);
    none.Add(Compare(pair.first, pair.second, options));
  }
  none.Judge();
}
const std::array<std::string, 2> kModels{"good", "GYRO-NS-CT"};
INSTANTIATE_TEST_SUITE_P(Models, Closure,
                         testing::Combine(testing::ValuesIn(kModels), testing::Values(150)));
INSTANTIATE_TEST_SUITE_P(MorePairs, Closure,
                         testing::Combine(testing::ValuesIn(kModels), testing::Values(500)));

struct Sampling {
  const char* hole;
  double first, second, offset;  // spacings, and where the second begins [m]
  double timid = 1;              // the least that a statistic may be
  int pairs = 500;
};
void PrintTo(const Sampling& s, std::ostream* out) {
  *out << s.hole << " every " << s.first << " and " << s.second << " m from " << s.offset;
}
class Sampled : public testing::TestWithParam<Sampling> {};

// The same where what is between stations is no arc, and the surveys see other parts of it. Where a
// motor slides, or no depth is a station of both, sigmas are too large by what a few dozen stations
// do not tell of the hole between them.
TEST_P(Sampled, UnderNoDifferenceEveryStatisticIsInItsBand) {
  const Sampling& is = GetParam();
  const ErrorModel tool = GoodTool();
  Random random(20261124);
  NoDifference none;
  CompareOptions options;
  for (int i = 0; i < is.pairs; ++i) {
    const Trajectory hole = *is.hole == 's'   ? Slid(random)
                            : *is.hole == 'w' ? Wandering(random)
                                              : Smooth();
    Draws shared;
    const ComparedSurvey a =
        Surveyed(StationsIn(hole, is.first), tool, options.local_sigma, random, shared);
    const ComparedSurvey b =
        Surveyed(StationsIn(hole, is.second, is.offset), tool, 0, random, shared);
    none.Add(Compare(a, b, options));
  }
  none.Judge(is.timid);
}
INSTANTIATE_TEST_SUITE_P(Holes, Sampled,
                         testing::Values(Sampling{"bends", 60, 20, 0, 1, 150},
                                         Sampling{"walks", 60, 20, 0, 1, 150},
                                         Sampling{"walks", 30, 20, 7, 0.85, 150}));
INSTANTIATE_TEST_SUITE_P(MoreHoles, Sampled,
                         testing::Values(Sampling{"bends", 60, 20, 0}, Sampling{"walks", 60, 20, 0},
                                         Sampling{"walks", 30, 20, 7, 0.85},
                                         Sampling{"bends", 30, 10, 0}, Sampling{"bends", 20, 20, 0},
                                         Sampling{"bends", 20, 20, 7, 0.95},
                                         Sampling{"walks", 30, 10, 0}, Sampling{"walks", 20, 20, 0},
                                         Sampling{"slides", 60, 20, 0, 0.85},
                                         Sampling{"slides", 30, 10, 0, 0.85},
                                         Sampling{"slides", 20, 20, 0, 0.85}));

/// How often a check of `shift` fails by chance and shift together.
double PowerOf(const Check& check, double shift) {
  return NormalCdf((shift - *check.limit) / *check.sigma) +
         NormalCdf((-shift - *check.limit) / *check.sigma);
}

struct Shifted {
  double scale;
  const char* code;
  double size;
};
void PrintTo(const Shifted& s, std::ostream* out) { *out << s.code << " of " << s.size; }
class Power : public testing::TestWithParam<Shifted> {};

// Shifts are found as often as their sigmas say, within four sigmas of that number, by tools with
// which that is neither always nor never.
TEST_P(Power, ShiftsAreFoundAsOftenAsPredicted) {
  const auto& [scale, code, size] = GetParam();
  const ErrorModel tool = GoodTool(scale);
  Random random(5);
  CompareOptions options;
  options.local_sigma = 0.01 * kDeg;
  double expected = 0;
  int found = 0;
  constexpr int kPairs = 150;
  for (int i = 0; i < kPairs; ++i) {
    Pair pair = Drawn(tool, tool, options.local_sigma, random);
    for (std::size_t k = 1; k < pair.second.well.survey.size(); ++k) {
      pair.second.well.survey[k].md += 0.3;
      pair.second.well.survey[k].azimuth += 0.2 * kDeg;
    }
    pair.second.well = SurveyWell(pair.second.well.survey, Vector3d::Zero());
    const Comparison c = Compare(pair.first, pair.second, options);
    const Check& check = CheckOf(c, code);
    expected += PowerOf(check, size);
    found += std::abs(*check.value) > *check.limit;
  }
  EXPECT_GT(expected, 15);
  EXPECT_LT(expected, 135);
  EXPECT_NEAR(found, expected, 4 * std::sqrt(expected * (1 - expected / kPairs)));
  RecordProperty("found", std::to_string(found) + " of " + std::to_string(expected));
}
INSTANTIATE_TEST_SUITE_P(Compare, Power,
                         testing::Values(Shifted{1.0, "compare_azimuth_offset", 0.2},
                                         Shifted{0.5, "compare_depth_offset", 0.3}));

// What is global in both drops out of the difference: 0.3 deg there leaves the sigma of 0.05 deg
// systematic and 0.03 deg random twice, beside what is local. XYM2 is one of azimuth times sin I.
TEST(Compare, SharedErrorsAreTakenOutOnce) {
  const ErrorModel tool = GoodTool();
  Random random(1);
  const Pair pair = Drawn(tool, tool, 1e-9, random);
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
  const Pair pair = Drawn(tool, tool, 1e-3, random);
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
  const Pair pair = Drawn(tool, tool, 1e-3, random);
  CompareOptions options;
  options.at = {kEnd + 100};
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
