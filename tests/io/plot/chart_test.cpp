#include "wellgyro/io/plot/chart.h"

#include <cmath>
#include <limits>
#include <regex>
#include <string>

#include <gmock/gmock.h>
#include <pugixml.hpp>

namespace wellgyro {
namespace {

using Eigen::Vector2d;
using testing::HasSubstr;
using testing::Not;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

TEST(ChartSvg, WithoutAPointNothingWasMeasured) {
  Chart chart{.title = "T"};
  EXPECT_THAT(ChartSvg(chart), HasSubstr("not measured"));
  chart.series = {{.points = {{kNone, 1}, {1, kNone}}}};
  EXPECT_THAT(ChartSvg(chart), HasSubstr("not measured"));
}

TEST(ChartSvg, IsWellFormedWhateverTheTexts) {
  const std::string odd = "<a href=\"x\">&'\x01";
  const Chart chart{.title = odd,
                    .x_name = odd,
                    .y_name = odd,
                    .series = {{.name = odd, .points = {{0, 0}, {1, 1}}}},
                    .notes = {{{0, 0}, odd}}};
  const std::string svg = ChartSvg(chart);
  pugi::xml_document document;
  EXPECT_TRUE(document.load_string(svg.c_str()));
  EXPECT_THAT(svg, Not(HasSubstr("<a ")));
}

TEST(ChartSvg, ALineGoesOnBehindAPointThatIsNone) {
  const Chart chart{.series = {{.points = {{0, 0}, {1, 0}, {kNone, 0}, {2, 0}, {3, 0}}}}};
  const std::string svg = ChartSvg(chart);
  EXPECT_TRUE(std::regex_search(svg, std::regex("d=\"M[^LM]*L[^LM]*M[^LM]*L[^LM]*\"")));
}

// A circle on a map is one on paper.
TEST(ChartSvg, EqualScalesAreEqual) {
  const Chart chart{.equal = true,
                    .width = 900,
                    .height = 300,
                    .series = {{.mark = ChartSeries::Mark::kFlag,
                                .points = {{0, 0}, {100, 0}, {0, 100}, {50, 40}}}}};
  const std::string svg = ChartSvg(chart);
  const std::regex circle("cx=\"([-0-9.]+)\" cy=\"([-0-9.]+)\"");
  std::vector<Vector2d> at;
  for (std::sregex_iterator i(svg.begin(), svg.end(), circle), end; i != end; ++i) {
    at.emplace_back(std::stod((*i)[1]), std::stod((*i)[2]));
  }
  ASSERT_EQ(at.size(), 4u);
  EXPECT_NEAR(at[1].x() - at[0].x(), at[0].y() - at[2].y(), 0.2);
  EXPECT_GT(at[1].x() - at[0].x(), 100);
}

TEST(ChartSvg, AnyRangeHasAFrame) {
  for (const double size : {0.0, 1e-300, 1.0, 1e300}) {
    const Chart chart{.series = {{.points = {{size, -size}, {-size, size}}}}};
    const ChartFrame frame = FrameOf(chart);
    EXPECT_LT(frame.low.x(), frame.high.x()) << size;
    EXPECT_LT(ChartSvg(chart).size(), 20000u) << size;
    EXPECT_THAT(ChartSvg(chart), Not(HasSubstr("nan"))) << size;
  }
}

TEST(EllipseOutline, LiesOnTheEllipse) {
  for (const Vector2d& p : EllipseOutline({1, 2}, {3, 0}, {0, 0.5})) {
    EXPECT_NEAR(std::pow((p.x() - 1) / 3, 2) + std::pow((p.y() - 2) / 0.5, 2), 1, 1e-12);
  }
}

}  // namespace
}  // namespace wellgyro
