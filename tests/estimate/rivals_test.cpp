// Which solutions stay beside the chosen one.
#include "wellgyro/estimate/rivals.h"

#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/math/rotation.h"
#include "wellgyro/record/decides.h"

namespace wellgyro {
namespace {

/// Three nodes, the last of which is turned by `heading` [rad].
Solution Headed(double heading, double evidence) {
  Solution s;
  s.evidence = evidence;
  s.nodes.resize(3);
  s.nodes.back().R_LT = RotationZ(heading);
  return s;
}

TEST(Rivals, AreThoseThatComeNearAndStandElsewhere) {
  const Solution best = Headed(0, -100);
  std::vector<Solution> rivals;
  const auto add = [&](double heading, double evidence) {
    AddRival(Headed(heading, evidence), best.evidence, best.nodes, rivals);
  };
  add(0.5, -100 + kDecides + 0.1);  // too far behind
  add(0.001, -99);                  // the same, from another side
  add(0.5, HUGE_VAL);               // did not converge
  EXPECT_TRUE(rivals.empty());
  add(0.5, -100 + kDecides - 0.1);
  add(1, -95);
  ASSERT_EQ(rivals.size(), 2u);
}

TEST(Rivals, AreKeptOnceAsTheBetterOfTwo) {
  const Solution best = Headed(0, -100);
  std::vector<Solution> rivals;
  for (const double evidence : {-95., -97., -96.}) {
    AddRival(Headed(0.5, evidence), best.evidence, best.nodes, rivals);
  }
  ASSERT_EQ(rivals.size(), 1u);
  EXPECT_EQ(rivals.front().evidence, -97);
}

}  // namespace
}  // namespace wellgyro
