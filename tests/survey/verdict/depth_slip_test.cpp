#include "wellgyro/survey/verdict/depth_slip.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/math/random.h"
#include "wellgyro/math/square.h"

namespace wellgyro {
namespace {

constexpr double kSigma = FromDegrees(0.01);
constexpr double kSigmaOfAll = 0.3, kSigmaScale = 1e-3;  // of depths: common [m], of scale [1]

/// A hole that is straight to 100 m, builds by `build` to 700 m, and is straight to its end.
struct PassedTwice {
  double build = 3 * units::kDegPer30m;
  double size = 0, from = 0, to = 0;  ///< marks lose it on the way in, evenly [m]
  double offset = 0;                  ///< of the way out's depths [m]
  double scatter = 0;                 ///< 1-sigma of each station's own depth [m]
  std::uint64_t seed = 1;

  double Inclination(double md) const {
    return FromDegrees(2) + build * std::clamp(md - 100, 0.0, 600.0);
  }
  /// What the tool's depth is where the way in reads `read`.
  double TrueIn(double read) const {
    const double rate = size / (to - from);
    if (read <= from) return read;
    return read + std::min((read - from) * rate / (1 - rate), size);
  }
  std::vector<Station> Stations() const {
    Random random(seed);
    std::vector<Station> stations;
    const auto add = [&](Pass pass, double read, double md) {
      Station& s = stations.emplace_back();
      s.run = 1;
      s.pass = pass;
      s.md = read;
      const double misread = scatter > 0 ? scatter * random.Normal() : 0;
      s.inclination = Inclination(md + misread) + kSigma * random.Normal();
      s.cov_md_inc_azi(0, 0) = Square(kSigmaOfAll) + Square(scatter) + Square(kSigmaScale * read);
      s.cov_md_inc_azi(1, 1) = kSigma * kSigma;
      s.tangent_L = {std::sin(s.inclination), 0, std::cos(s.inclination)};
    };
    for (double md = 0; md <= 900; md += 30) add(Pass::kIn, md, size > 0 ? TrueIn(md) : md);
    for (double md = 900; md >= 0; md -= 30) add(Pass::kOut, md, md + size + offset);
    return stations;
  }
  RunSlip Found() const {
    Job job;
    job.errors.depth_sigma = kSigmaOfAll;
    return FindSlip(job, kSigmaScale, Stations(), 1);
  }
};

TEST(DepthSlip, IsFoundWhereTheWheelSlipped) {
  const RunSlip slip = PassedTwice{.size = 2, .from = 440, .to = 460}.Found();
  ASSERT_TRUE(slip.cause.ln_bayes);
  EXPECT_GT(*slip.cause.ln_bayes, 20);
  EXPECT_NEAR(*slip.cause.size, 2, 4 * *slip.cause.sigma);
  EXPECT_NEAR(*slip.cause.begin_md, 450, 30);
  EXPECT_NEAR(slip.cause.shift_W->norm(), 2, 4 * *slip.cause.sigma);
  EXPECT_LT(slip.cause.shift_W->z(), 0) << "the end is given too shallow";
  EXPECT_EQ(CheckSlip(slip, 1).verdict, Verdict::kFail);
}

// Half in the bend above the middle, half below: what of it is a step there.
TEST(DepthSlip, ASlowOneIsFoundToo) {
  const RunSlip slip = PassedTwice{.size = 2, .from = 250, .to = 650}.Found();
  EXPECT_EQ(CheckSlip(slip, 1).verdict, Verdict::kFail);
  EXPECT_GT(*slip.cause.size, 0.5);
  EXPECT_LT(*slip.cause.size, 2.5);
  EXPECT_NEAR(*slip.cause.begin_md, 450, 120);
}

// Markov: of passes that do not slip at most a share 1e-3 passes odds of 1000.
TEST(DepthSlip, PassesThatDoNotSlipShowNone) {
  int alarms = 0;
  double odds = 0;
  constexpr int kRuns = 400;
  for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
    Random random(9000 + seed);
    const RunSlip slip = PassedTwice{.offset = 0.42 * random.Normal(), .seed = seed}.Found();
    alarms += CheckSlip(slip, 1).verdict == Verdict::kFail ? 1 : 0;
    odds += std::exp(*slip.cause.ln_bayes) / kRuns;
  }
  EXPECT_LE(alarms, 2);
  EXPECT_LT(odds, 2);
  EXPECT_GT(odds, 0.02) << "the test tells nothing";
}

// In the bend a decimetre of depth is a hundredth of a degree, what inclination is read to.
TEST(DepthSlip, DepthsThatScatterShowNoneAndHideNone) {
  int alarms = 0, found = 0;
  constexpr int kRuns = 400;
  for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
    const PassedTwice clean{.scatter = 0.5, .seed = seed};
    const PassedTwice slipped{.size = 2, .from = 440, .to = 460, .scatter = 0.2, .seed = seed};
    alarms += CheckSlip(clean.Found(), 1).verdict == Verdict::kFail ? 1 : 0;
    found += CheckSlip(slipped.Found(), 1).verdict == Verdict::kFail ? 1 : 0;
  }
  EXPECT_LE(alarms, 2);
  EXPECT_EQ(found, kRuns);
}

TEST(DepthSlip, TheSmallestIsNoticedFourTimesInFive) {
  const RunSlip slip = PassedTwice{}.Found();
  const RunReliability& told = slip.reliability;
  EXPECT_EQ(slip.unseen_W.norm(), 0)
      << "but in the top, straight tenth of the hole the largest shows";
  ASSERT_TRUE(told.smallest && told.md);
  EXPECT_NEAR(told.shift_W.norm(), *told.smallest, 1e-9);
  int noticed = 0;
  constexpr int kRuns = 200;
  for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
    const PassedTwice passed{
        .size = *told.smallest, .from = *told.md - 5, .to = *told.md + 5, .seed = seed};
    noticed += CheckSlip(passed.Found(), 1).verdict == Verdict::kFail ? 1 : 0;
  }
  // Binomial, 3 sigma .085; the offset, which these runs have not, is allowed for.
  EXPECT_NEAR(noticed / static_cast<double>(kRuns), 0.8, 0.12);
}

TEST(DepthSlip, NothingTellsItWhereTheHoleIsStraightOrPassedOnce) {
  const RunSlip straight = PassedTwice{.build = 0}.Found();
  EXPECT_FALSE(CheckSlip(straight, 1).verdict == Verdict::kFail);
  EXPECT_FALSE(straight.reliability.smallest);
  EXPECT_GT(straight.unseen_W.norm(), 5);
  std::vector<Station> in = PassedTwice{.size = 2, .from = 440, .to = 460}.Stations();
  std::erase_if(in, [](const Station& s) { return s.pass == Pass::kOut; });
  const RunSlip once = FindSlip(Job{}, 0, in, 1);
  EXPECT_EQ(CheckSlip(once, 1).verdict, Verdict::kNotDone);
  EXPECT_FALSE(once.reliability.smallest);
  EXPECT_GT(once.reliability.shift_W.norm(), 5) << "what may be there unseen";
}

}  // namespace
}  // namespace wellgyro
