#include <fmt/core.h>
#include <gtest/gtest.h>

#include "wellgyro/base/units.h"
#include "wellgyro/fit/affine_fit.h"
#include "wellgyro/fit/gyro_fit.h"
#include "wellgyro/fit/multi_station_fit.h"
#include "wellgyro/fit/position_fit.h"
#include "wellgyro/fit/roll_test.h"
#include "wellgyro/fit/scalar_fit.h"
#include "wellgyro/fit/thermometer_fit.h"

#include "fit/truth_file.h"

namespace wellgyro {
namespace {

using test::Apart;
using test::Found;
using test::HasResult;
using test::TruthOf;

/// One set of the reference bench data.
class ReferenceBench : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(test::BenchDir()))
      GTEST_SKIP() << "the reference bench data are not on this machine";
  }
  BenchTable Data(const std::string& set) {
    truth_ = test::TextOf(test::BenchDir() / set / "truth.json");
    auto table = ReadBenchTable(test::BenchDir() / set / "data.csv");
    EXPECT_TRUE(table.has_value()) << table.fault().text;
    return *table;
  }
  void Expect(const Result<BenchCalibration>& fit, const std::string& name, double tolerance) {
    ASSERT_TRUE(fit.has_value()) << fit.fault().text;
    const double apart = Apart(Found(fit->report, name), TruthOf(truth_, name));
    fmt::print("  {}: {:.1e}\n", name, apart);
    EXPECT_LT(apart, tolerance) << name;
  }
  std::string truth_;
};

// The files carry twelve digits.
constexpr double kDigits = 1e-8;

TEST_F(ReferenceBench, Thermometer) {
  const auto fit = FitThermometer(Data("thermometer"), {});
  Expect(fit, "c", kDigits);
  Expect(fit, "knee_C", kDigits);
  const auto free = FitThermometer(Data("thermometer"), {.knee = 100, .fit_knee = true});
  Expect(free, "c", 1e-6);
  Expect(free, "knee_C", 1e-6);
}

TEST_F(ReferenceBench, TwentyFourPositions) {
  const auto fit = FitTwentyFourPositions(Data("24_position"), {});
  Expect(fit, "S_V_per_g", kDigits);
  Expect(fit, "Vb_V", kDigits);
  EXPECT_LT(Found(fit->report, "K2_V_per_g2").norm(), 1e-11);
}

TEST_F(ReferenceBench, TwentyFourPositionsOnATiltedBench) {
  const auto fit = FitTwentyFourPositions(Data("24_position_tilted_bench"), {});
  Expect(fit, "S_V_per_g", 1e-8);
  Expect(fit, "Vb_V", 1e-6);
  Expect(fit, "K2_V_per_g2", 1e-3);
  EXPECT_NEAR(Found(fit->report, "tilt_deg")[0], std::hypot(0.3, 0.2), 1e-4);
}

TEST_F(ReferenceBench, TwentyFourPositionsAtSixTemperatures) {
  const auto fit = FitTwentyFourPositions(Data("24_position_temperature"), {});
  ASSERT_TRUE(fit.has_value()) << fit.fault().text;
  const std::string all = truth_;
  std::size_t at = 0;
  for (int i = 0; i < 6; ++i) {
    at = all.find("\"S_V_per_g\"", at + 1);
    truth_ = all.substr(at);
    const std::string prefix = fmt::format("per_T[{}].", i);
    for (const char* name : {"S_V_per_g", "Vb_V"})
      EXPECT_LT(Apart(Found(fit->report, prefix + name), TruthOf(truth_, name)), kDigits);
    // The polynomial, at this temperature.
    const double T = TruthOf(all.substr(all.find("\"S_V_per_g\"", at)), "T_C")[0];
    const double tau =
        (T - Found(fit->report, "T0_C")[0]) / Found(fit->report, "T_half_range_C")[0];
    const Eigen::VectorXd S =
        Found(fit->report, "S_V_per_g") + tau * Found(fit->report, "S_V_per_g_tau1");
    EXPECT_LT(Apart(S, TruthOf(truth_, "S_V_per_g")), kDigits);
  }
}

TEST_F(ReferenceBench, SixPositions) {
  for (const std::string set : {"six_position", "six_position_no_k2"}) {
    const auto fit = FitSixPositions(Data(set), {});
    for (const char* name : {"k_pulse_per_s_per_mps2", "a0_mps2", "E_rad"})
      Expect(fit, name, kDigits);
    if (set == "six_position") Expect(fit, "k2_g_per_g2", 1e-6);
  }
  // The published form, the bias of each axis's own pair.
  const auto own = FitSixPositions(Data("six_position_no_k2"), {.second_order = false});
  Expect(own, "a0_mps2", kDigits);
}

TEST_F(ReferenceBench, SixPositionsRotated) {
  const BenchTable data = Data("six_position_rotated");
  const auto fit = FitSixPositions(data, {});
  ASSERT_TRUE(fit.has_value()) << fit.fault().text;
  for (const char* name : {"k_pulse_per_s_per_mps2", "a0_mps2", "E_rad", "k2_g_per_g2"}) {
    const Eigen::VectorXd found = Found(fit->report, name), truth = TruthOf(truth_, name);
    const Eigen::VectorXd sigma = Found(fit->report, name, true);
    for (Eigen::Index i = 0; i < found.size(); ++i) {
      if (truth[i] == 0 && found[i] == 0) continue;
      EXPECT_LT(std::abs(found[i] - truth[i]), 4 * sigma[i]) << name << i;
    }
  }
}

BenchReference Magnetic() { return {.field = 50000.0, .dip = 60 * units::kDeg}; }

TEST_F(ReferenceBench, Orthogonality) {
  const auto fit = FitOrthogonality(Data("orthogonality"), {.reference = Magnetic()});
  ASSERT_TRUE(fit.has_value()) << fit.fault().text;
  for (const char* name : {"E_G", "b_G", "E_M", "b_M_nT", "x_kj"})
    Expect(fit->calibration, name, kDigits);
  const OrthogonalityCheck& check = *fit->check;
  for (const auto& e : {check.raw, check.trigonometric, check.affine})
    fmt::print("  G {:.2e} mg, M {:.2e} nT, inc {:.2e} deg, azi {:.2e} deg\n", e.G_mg, e.M_nT,
               e.inclination_deg, e.azimuth_deg);
  fmt::print("  fell back {} of {}\n", check.fell_back, check.attitudes);
  // Errors of some mg that are affine: what is left of them is roundoff.
  EXPECT_GT(check.raw.G_mg, 1);
  EXPECT_LT(check.affine.G_mg, 1e-6 * check.raw.G_mg);
  EXPECT_LT(check.affine.M_nT, 1e-6 * check.raw.M_nT);
}

TEST_F(ReferenceBench, OrthogonalityOfFreeFrequency) {
  const auto fit = FitOrthogonality(Data("orthogonality_trigonometric"),
                                    {.reference = Magnetic(), .free_frequency = true});
  ASSERT_TRUE(fit.has_value()) << fit.fault().text;
  Expect(fit->calibration, "x_kj", kDigits);
}

TEST_F(ReferenceBench, ScalarAndItsOutliers) {
  BenchReference reference = Magnetic();
  reference.field = 48000.0;
  reference.dip = 62 * units::kDeg;
  for (const std::string set : {"scalar", "scalar_outliers"}) {
    const BenchTable data = Data(set);
    const auto alone = FitScalar(data, {.reference = reference});
    const auto both = FitScalarDip(data, {.reference = reference});
    reference.dip.reset();
    const auto free = FitScalarDip(data, {.reference = reference, .free_dip = true});
    reference.dip = 62 * units::kDeg;
    for (const auto* fit : {&alone, &both, &free}) {
      Expect(*fit, "Ka", kDigits);
      Expect(*fit, "ba", kDigits);
      // Rows 0 to 3: lines 2 to 5.
      EXPECT_EQ((*fit)->report.outlier_lines,
                set == "scalar" ? std::vector<int>{} : (std::vector<int>{2, 3, 4, 5}));
      if (fit == &alone) continue;
      Expect(*fit, "Km", kDigits);
      Expect(*fit, "bm", kDigits);
    }
    Expect(free, "dip_deg", kDigits);
  }
}

TEST_F(ReferenceBench, RollTest) {
  const auto fit = FitRollTest(Data("roll_test"), {});
  Expect(fit, "axis_in_sensor", kDigits);
}

TEST_F(ReferenceBench, Gyros) {
  const BenchTable rest = Data("gyro_multi_position"), table = Data("gyro_rate_table");
  const GyroFitSetup setup{.reference = {.latitude = 45 * units::kDeg}};
  for (const auto& fit : {FitGyro(rest, {}, setup), FitGyro(rest, table, setup)}) {
    for (const char* name : {"b_degh", "U", "G_degh_per_g", "MQ", "aniso_degh_per_g2"})
      Expect(fit, name, kDigits);
  }
  // The table alone, x, y and z up: no force along two axes at once. Its readings of 360000 deg/h
  // end at 5e-7.
  const auto alone = FitGyro({}, table, setup);
  Expect(alone, "U", kDigits);
  for (const char* name : {"b_degh", "MQ"}) Expect(alone, name, 1e-6);
  EXPECT_FALSE(HasResult(alone->report, "aniso_degh_per_g2"));
}

TEST_F(ReferenceBench, MultiStation) {
  const BenchTable data = Data("multi_station");
  const auto fit =
      FitMultiStation(data, {.reference = {.field = TruthOf(truth_, "B_nT")[0],
                                           .dip = TruthOf(truth_, "dip_deg")[0] * units::kDeg}});
  for (const char* name : {"bm_nT", "sm"}) Expect(fit, name, kDigits);
}

TEST_F(ReferenceBench, PublicImuScalar) {
  // Means of imu_tk's public data at rest; its results with mean_of_intervals, g = 9.81744.
  const auto path = test::BenchDir().parent_path() / "xsens_imu_tk" / "xsens_static_means.csv";
  std::string text = "start,end,n,ax,ay,az,gx,gy,gz\n" + test::TextOf(path);
  const auto data = ParseBenchTable(text, path.string());
  ASSERT_TRUE(data.has_value()) << data.fault().text;
  const auto fit = FitScalar(*data, {.reference = {.gravity = 9.81744}});
  ASSERT_TRUE(fit.has_value()) << fit.fault().text;
  EXPECT_NEAR(fit->report.half_square_sum, 1.80104e-5, 0.5e-10);
  const Eigen::VectorXd MtM = Found(fit->report, "MtM");
  const double published[] = {5.822657, -0.019869, -0.054104, 5.890379, -0.124889, 5.820145};
  const int places[] = {0, 1, 2, 4, 5, 8};
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(MtM[places[i]] * 1e6, published[i], 0.6e-6);
  const Eigen::VectorXd bias = Found(fit->report, "ba");
  EXPECT_NEAR(bias[0], 33123.8383, 1e-3);
  EXPECT_NEAR(bias[1], 33275.1630, 1e-3);
  EXPECT_NEAR(bias[2], 32364.4946, 1e-3);
}

}  // namespace
}  // namespace wellgyro
