// What compare says of many pairs of surveys, held against chance.
#include <array>
#include <cmath>
#include <map>
#include <ostream>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/toml/model_catalogue.h"
#include "wellgyro/math/random.h"
#include "wellgyro/math/statistics.h"
#include "wellgyro/survey/wells/compare.h"

#include "survey/wells/compared_surveys.h"

namespace wellgyro {
namespace {

using Eigen::Vector3d;

using test::CheckOf;
using test::ComparedPair;
using test::Drawn;
using test::Draws;
using test::GoodTool;
using test::Slid;
using test::Smooth;
using test::StationsIn;
using test::Surveyed;
using test::Wandering;
using units::kDeg;

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
    const ComparedPair pair = Drawn(a, b, options.local_sigma, random);
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
    ComparedPair pair = Drawn(tool, tool, options.local_sigma, random);
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

}  // namespace
}  // namespace wellgyro
