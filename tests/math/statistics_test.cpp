#include "wellgyro/math/statistics.h"

#include <cmath>
#include <stdexcept>
#include <utility>

#include <gtest/gtest.h>

namespace wellgyro {
namespace {

// Reference values: mpmath, 30 digits, by quadrature of the densities where a is large.

struct GammaCase {
  double a, x, p, q;
};

TEST(Statistics, IncompleteGammaKeepsBothTails) {
  for (const auto& c : {
           GammaCase{0.5, 1e-6, 0.00112837879096923635, 0.998871621209030764},
           GammaCase{0.5, 2, 0.954499736103641586, 0.0455002638963584144},
           GammaCase{1, 3, 0.950212931632136057, 0.049787068367863943},
           GammaCase{2.5, 0.1, 0.000886138788812442607, 0.999113861211187557},
           GammaCase{7, 20, 0.999744877504143699, 0.000255122495856300733},
           GammaCase{50, 30, 0.000518891462548034293, 0.999481108537451966},
           GammaCase{123.4, 123.4, 0.511971551246670244, 0.488028448753329756},
           GammaCase{1000, 1100, 0.998940676746070023, 0.00105932325392997735},
           GammaCase{19999, 19700, 0.016894876793181314, 0.983105123206818686},
           GammaCase{20000, 20600, 0.99998684700177773, 1.3152998222272686e-5},
           GammaCase{20001, 20001, 0.500940292726711933, 0.499059707273288067},
           GammaCase{20001, 20500, 0.999768939980894067, 0.000231060019105932945},
           GammaCase{3e5, 2.98e5, 0.00012659034276665402, 0.99987340965723335},
           GammaCase{5e7, 5.001e7, 0.92134347928483453, 0.078656520715165467},
       }) {
    EXPECT_NEAR(GammaP(c.a, c.x) / c.p, 1, 1e-10) << c.a << " " << c.x;
    EXPECT_NEAR(GammaQ(c.a, c.x) / c.q, 1, 1e-10) << c.a << " " << c.x;
  }
  EXPECT_EQ(GammaP(3, 0), 0);
  EXPECT_EQ(GammaQ(3, 0), 1);
}

struct QuantileCase {
  double p, dof, x;
};

TEST(Statistics, ChiSquareQuantileFromAFractionOfADegreeToAHundredMillion) {
  for (const auto& c : {
           QuantileCase{0.025, 0.3, 2.6300743566293618e-11},
           QuantileCase{0.975, 0.3, 2.5450554374525478},
           QuantileCase{0.025, 1, 0.00098206911717525602},
           QuantileCase{0.975, 1, 5.0238861873148874},
           QuantileCase{0.025, 1.7, 0.024578860686948401},
           QuantileCase{0.5, 2, 1.3862943611198906},
           QuantileCase{0.025, 3, 0.21579528262389788},
           QuantileCase{0.975, 3, 9.3484036044961458},
           QuantileCase{1e-6, 4, 0.0028297613229586858},
           QuantileCase{0.95, 10, 18.307038053275144},
           QuantileCase{0.025, 33.3, 19.274158609714203},
           QuantileCase{0.975, 1000, 1089.5309127749135},
           QuantileCase{0.025, 5e4, 49382.101443275024},
           QuantileCase{0.975, 1e6, 1002773.701467926},
           QuantileCase{0.025, 1e8, 99972283.817867522},
           QuantileCase{1e-10, 2, 2.0000000001000001e-10},
           QuantileCase{0.999999, 7, 40.521831234114719},
       }) {
    EXPECT_NEAR(ChiSquareQuantile(c.p, c.dof) / c.x, 1, 1e-10) << c.p << " " << c.dof;
    EXPECT_NEAR(ChiSquareCdf(c.x, c.dof) / c.p, 1, 1e-8) << c.p << " " << c.dof;
  }
}

// Student's t of JCGM 100:2008, table G.2: half of 100 - 95.45 %.
TEST(Statistics, StudentLimitsAreThoseOfTheGuide) {
  const double p = NormalCdf(-2);
  for (const auto& [dof, t] : {std::pair(2.0, 4.53), std::pair(3.0, 3.31), std::pair(5.0, 2.65),
                               std::pair(10.0, 2.28), std::pair(100.0, 2.025)}) {
    EXPECT_NEAR(StudentLimit(p, dof) / t, 1, 0.01) << dof;
  }
  EXPECT_NEAR(StudentLimit(p, 1e12), 2, 1e-9);
}

TEST(Statistics, NormalQuantileIntoTheFarTail) {
  EXPECT_NEAR(NormalQuantile(1e-300), -37.047096299361199, 1e-12);
  EXPECT_NEAR(NormalQuantile(1e-10), -6.3613409024040562, 1e-13);
  EXPECT_NEAR(NormalQuantile(0.025), -1.9599639845400542, 1e-14);
  EXPECT_NEAR(NormalQuantile(0.3), -0.52440051270804082, 1e-14);
  EXPECT_EQ(NormalQuantile(0.5), 0);
  EXPECT_NEAR(NormalQuantile(0.6), 0.25334710313579974, 1e-14);
  EXPECT_NEAR(NormalQuantile(0.999999), 4.7534243088170878, 1e-9);
}

TEST(Statistics, RefusesWhatIsOutsideTheDomain) {
  EXPECT_THROW(ChiSquareQuantile(0, 3), std::domain_error);
  EXPECT_THROW(ChiSquareQuantile(1, 3), std::domain_error);
  EXPECT_THROW(ChiSquareQuantile(0.5, 0), std::domain_error);
  EXPECT_THROW(ChiSquareQuantile(0.5, std::nan("")), std::domain_error);
  EXPECT_THROW(GammaP(1, -1), std::domain_error);
  EXPECT_THROW(NormalQuantile(-0.1), std::domain_error);
}

}  // namespace
}  // namespace wellgyro
