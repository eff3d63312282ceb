#include "wellgyro/io/result/certificate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace wellgyro {
namespace {

using testing::HasSubstr;
using testing::Not;

FitReport Fitted() {
  FitReport report;
  report.method = "tool";
  report.parameters = {"gyro_b[0]", "gyro_b[1]"};
  report.result.push_back({"gyro_b", FitQuantity::Shape::kVector, Eigen::Vector2d(1.5, -0.25),
                           Eigen::Vector2d(0.05, 0.02)});
  report.readings = 20;
  report.dof = 10;
  return report;
}

// 3, 4 and 5: the contributions' squares add up.
UncertaintyBudget Sources() {
  UncertaintyBudget budget;
  budget.sources = {"readings", "north", "seat"};
  budget.n_type_a = 1;
  budget.contributions.resize(2, 3);
  budget.contributions << 0.03, 0.04, 0, 0.02, 0, 0;
  budget.dof = Eigen::Vector2d(UncertaintyBudget::kManyDof, 10.4);
  return budget;
}

TEST(CertificatePage, BudgetSaysWhatEachSourceContributes) {
  FitReport report = Fitted();
  report.budget = Sources();
  const std::string html = CertificateHtml(CertificateOf(report));
  EXPECT_THAT(html, HasSubstr("<h2>Uncertainty budget</h2>"));
  EXPECT_THAT(html, HasSubstr("<th>result</th><th>unit</th><th>readings (A)</th><th>north (B)</th>"
                              "<th>u</th><th>dof</th><th>k</th><th>U</th>"));
  EXPECT_THAT(html, HasSubstr("<tr><td>gyro_b[0]</td><td>deg/h</td><td>0.0300</td><td>0.0400</td>"
                              "<td>0.050</td><td>&infin;</td><td>2.00</td><td>0.10</td></tr>"));
  // Ten degrees of freedom: k = 2.28 (JCGM 100, table G.2).
  EXPECT_THAT(html, HasSubstr("<tr><td>gyro_b[1]</td><td>deg/h</td><td>0.0200</td><td>0</td>"
                              "<td>0.020</td><td>10</td><td>2.27</td><td>0.045</td></tr>"));
  EXPECT_THAT(html, HasSubstr("<td>deg/h</td><td>budget</td>"));
  // A source that contributes to none of them has no column.
  EXPECT_THAT(html, Not(HasSubstr("seat (B)")));
  EXPECT_THAT(html, Not(HasSubstr("A, B")));
}

TEST(CertificatePage, WithoutPriorsAllIsOfTypeA) {
  const std::string html = CertificateHtml(CertificateOf(Fitted()));
  EXPECT_THAT(html, Not(HasSubstr("Uncertainty budget")));
  EXPECT_THAT(html, HasSubstr("<td>0.050</td><td>2.00</td><td>0.10</td><td>deg/h</td><td>A</td>"));
}

TEST(CertificatePage, ErrorsOfSamplesAndTheirBudgetAreInTheUnitsOfPeople) {
  CalibrationSources sources;
  sources.names = {"accel_scale_x", "gyro_scale_x"};
  sources.cov = Eigen::Vector2d(25e-12, 0).asDiagonal();
  UncertaintyBudget budget = Sources();
  budget.contributions << 3e-6, 4e-6, 0, 0, 0, 0;
  const auto lines = SampleErrors(sources, budget);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].unit, "1e-6");
  EXPECT_NEAR(lines[0].uncertainty, 5, 1e-12);
  ASSERT_EQ(lines[0].budget.size(), 3u);
  EXPECT_EQ(lines[0].budget[1].source, "north");
  EXPECT_NEAR(lines[0].budget[1].uncertainty, 4, 1e-12);
  EXPECT_TRUE(lines[0].budget[0].type_a);
  EXPECT_FALSE(lines[0].budget[1].type_a);
}

}  // namespace
}  // namespace wellgyro
