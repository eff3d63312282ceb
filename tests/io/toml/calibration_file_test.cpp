#include "wellgyro/io/toml/calibration_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace wellgyro {
namespace {

using Shape = FitQuantity::Shape;

CalibrationFile Example() {
  CalibrationFile file;
  file.program = "wellgyro 0";
  file.inputs.push_back({"data", "bench.csv", "bench.csv", std::string(64, 'a')});
  file.references = {"gravity-g 1"};
  FitReport& r = file.report;
  r.method = "24-position";
  Eigen::MatrixXd S(2, 3);
  S << 1, 2.5, -3, 4e-7, 5, 6;
  r.result.push_back({"S_V_per_g", Shape::kMatrix, S, S.cwiseAbs() * 1e-6});
  r.result.push_back({"Vb_V", Shape::kVector, Eigen::Vector2d(0.1, 0.2), {}});
  r.result.push_back({"tilt_deg", Shape::kNumber, Eigen::MatrixXd::Constant(1, 1, 0.25), {}});
  for (const char* name : {"per_T[0].T_C", "per_T[1].T_C"})
    r.result.push_back({name, Shape::kNumber, Eigen::MatrixXd::Constant(1, 1, 20),
                        Eigen::MatrixXd::Constant(1, 1, 0.5)});
  r.parameters = {"S_V_per_g[0,0]", "Vb_V[0]"};
  r.values = Eigen::Vector2d(1, 0.1);
  r.cov = Eigen::Matrix2d::Identity() * 1e-12;
  r.budget.sources = {"readings", "level", "north"};
  r.budget.n_type_a = 1;
  r.budget.contributions.resize(2, 3);
  r.budget.contributions << 6e-7, 8e-7, 0, 1e-6, 0, 0;
  r.budget.dof = Eigen::Vector2d(77, UncertaintyBudget::kManyDof);
  r.readings = 9;
  r.dof = 7;
  r.sigma_given = true;
  r.chi_square = 7.5;
  r.chi_low = 1.7;
  r.chi_high = 16;
  r.scatter = 1.03;
  r.half_square_sum = 1e-5;
  r.condition = 3;
  r.residuals = {{2, "x", 1e-6, 0.7, 0.2}, {3, "y", -5e-6, -3.4, 0.97}};
  r.studentised_limit = 3.2;
  r.outlier_lines = {17};
  r.correlations = {"a and b: +0.990"};
  r.remarks = {"a remark"};
  return file;
}

TEST(CalibrationFile, ComesBackAsItWasWritten) {
  CalibrationFile file = Example();
  file.check =
      OrthogonalityCheck{40, 1, {9, 400, 0.7, 1.4}, {7, 350, 0.4, 1.0}, {0.1, 19, 7e-3, 0.03}};
  const std::string text = CalibrationToml(file);
  EXPECT_THAT(text, testing::StartsWith("format = \"wellgyro.calibration/1\"\n"));
  EXPECT_THAT(text, testing::HasSubstr("[result]\nS_V_per_g = [\n  [1.0, 2.5, -3.0],"));
  EXPECT_THAT(text, testing::HasSubstr("[[result.per_T]]\nT_C = 20.0\n"));
  EXPECT_THAT(text, testing::HasSubstr("[result_sigma]\n"));
  const auto back = ParseCalibration(text, "c.toml");
  ASSERT_TRUE(back.has_value()) << back.fault().text << back.fault().line;
  EXPECT_EQ(CalibrationToml(*back), text);
  EXPECT_EQ(back->report.result[0].value, file.report.result[0].value);
  EXPECT_EQ(back->report.result[0].sigma, file.report.result[0].sigma);
  EXPECT_EQ(back->report.result[1].shape, Shape::kVector);
  EXPECT_EQ(back->report.result[4].name, "per_T[1].T_C");
  EXPECT_EQ(back->report.cov, file.report.cov);
  EXPECT_EQ(back->report.budget.contributions, file.report.budget.contributions);
  EXPECT_EQ(back->report.budget.dof, file.report.budget.dof);
  EXPECT_EQ(back->check->affine.M_nT, 19);
}

// 2026-11-22: a million readings made a file of 85 MB.
TEST(CalibrationFile, OfManyResidualsTheLargestAndSomeOfTheRest) {
  CalibrationFile file = Example();
  std::vector<FitResidual>& residuals = file.report.residuals;
  residuals.clear();
  for (int i = 0; i < 200'000; ++i) residuals.push_back({i + 2, "x", 1e-6, 0.7, 0.2});
  residuals[150'001] = {150'003, "y", -5e-6, -3.4, 0.97};
  const std::string text = CalibrationToml(file);
  EXPECT_LT(text.size(), 400'000u);
  const auto back = ParseCalibration(text, "c.toml");
  ASSERT_TRUE(back.has_value()) << back.fault().text;
  ASSERT_EQ(back->report.residuals.size(), 4000u);
  EXPECT_THAT(back->report.residuals,
              testing::Contains(testing::Field(&FitResidual::line, 150'003)));
  EXPECT_GT(back->report.residuals.back().line, 190'000);
}

TEST(CalibrationFile, RefusesWhatIsCut) {
  const std::string text = CalibrationToml(Example());
  for (const char* key : {"method = ", "[statistics]", "[covariance]", "[residuals]",
                          "values = ", "sources = ", "type_a = ", "dof = [7"}) {
    const std::size_t at = text.find(key);
    ASSERT_NE(at, std::string::npos) << key;
    std::string cut = text;
    cut.replace(at, 1, "#");
    EXPECT_FALSE(ParseCalibration(cut, "c.toml").has_value()) << key;
  }
}

TEST(CalibrationFile, SummarySaysWhatAPersonAsks) {
  const std::string text = CalibrationSummary(Example());
  for (const char* part :
       {"24-position\n", "  S_V_per_g\n", "2.5 +- 2.5e-06", "tilt_deg = 0.25",
        "chi-square 7.5, inside 95 % of 1.7 to 16.0", "worst residual: line 3, y", "BEYOND",
        "line 3, y, cannot be checked", "left out: line 17", "note: a remark"})
    EXPECT_THAT(text, testing::HasSubstr(part));
  EXPECT_THAT(text, testing::Not(testing::HasSubstr("per_T")));
}

}  // namespace
}  // namespace wellgyro
