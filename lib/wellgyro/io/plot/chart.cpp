#include "wellgyro/io/plot/chart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <set>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/number_text_internal.h"
#include "wellgyro/io/plot/plot_text_internal.h"

namespace wellgyro {
namespace {

using Eigen::Vector2d;
using Mark = ChartSeries::Mark;

constexpr double kChartLeft = 64, kChartRight = 14, kChartTop = 44,
                 kChartBottom = 42;  // pixels, around the plot
constexpr std::array kChartColours = {"#00558c", "#b34700", "#006b4f", "#8a3f70",
                                      "#222222", "#7a5c00", "#8c8c8c"};

bool Finite(const Vector2d& p) { return std::isfinite(p.x()) && std::isfinite(p.y()); }

/// From values to pixels.
struct Paper {
  Vector2d low, high;     ///< of the values
  Vector2d corner, size;  ///< of the plot [pixels]
  bool down = false;

  Vector2d operator()(const Vector2d& p) const {
    const Vector2d u = (p - low).cwiseQuotient(high - low);
    return {corner.x() + size.x() * u.x(), corner.y() + size.y() * (down ? u.y() : 1 - u.y())};
  }
};

Paper PaperOf(const Chart& chart) {
  const ChartFrame frame = FrameOf(chart);
  Paper paper{frame.low, frame.high, Vector2d(chart.axes ? kChartLeft : kChartRight, kChartTop),
              Vector2d::Zero(), chart.y_down};
  paper.size = Vector2d(chart.width - kChartRight,
                        chart.height - (chart.axes ? kChartBottom : kChartRight)) -
               paper.corner;
  if (!chart.equal) return paper;
  const Vector2d span = paper.high - paper.low, middle = (paper.low + paper.high) / 2;
  const double metres_per_pixel = span.cwiseQuotient(paper.size).maxCoeff();
  paper.low = middle - metres_per_pixel * paper.size / 2;
  paper.high = middle + metres_per_pixel * paper.size / 2;
  return paper;
}

std::string PointText(const Vector2d& p) { return Fixed(p.x(), 1) + ' ' + Fixed(p.y(), 1); }

std::string Text(const Vector2d& at, const char* anchor, const std::string& text) {
  return fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"{}\">{}</text>\n", Fixed(at.x(), 1),
                     Fixed(at.y(), 1), anchor, SvgText(text));
}

/// As few digits as tell ticks `tick` apart from each other.
std::string TickText(double value, double tick) {
  const int decimals = std::clamp(static_cast<int>(-std::floor(std::log10(tick) + 1e-9)), 0, 9);
  return Fixed(value, decimals);
}

void DrawAxis(std::string& svg, const Paper& paper, int axis) {
  const double span = paper.high(axis) - paper.low(axis);
  const double tick = RoundTick(span * (axis == 0 ? 70 : 34) / paper.size(axis));
  const Vector2d end = paper.corner + paper.size;
  for (double v = tick * std::ceil(paper.low(axis) / tick - 1e-9);
       v <= paper.high(axis) + 1e-9 * span; v += tick) {
    Vector2d at = paper.low;
    at(axis) = v;
    const Vector2d p = paper(at);
    if (axis == 0) {
      svg += fmt::format("<path fill=\"none\" stroke=\"#e2e2e2\" d=\"M{} {}V{}\"/>",
                         Fixed(p.x(), 1), Fixed(paper.corner.y(), 1), Fixed(end.y(), 1));
      svg += Text({p.x(), end.y() + 16}, "middle", TickText(v, tick));
    } else {
      svg += fmt::format("<path fill=\"none\" stroke=\"#e2e2e2\" d=\"M{} {}H{}\"/>",
                         Fixed(paper.corner.x(), 1), Fixed(p.y(), 1), Fixed(end.x(), 1));
      svg += Text({paper.corner.x() - 6, p.y() + 4}, "end", TickText(v, tick));
    }
  }
}

void DrawAxes(std::string& svg, const Paper& paper, const Chart& chart) {
  DrawAxis(svg, paper, 0);
  DrawAxis(svg, paper, 1);
  const Vector2d end = paper.corner + paper.size;
  svg += Text({paper.corner.x() + paper.size.x() / 2, end.y() + 34}, "middle", chart.x_name);
  svg += fmt::format(
      "<text transform=\"translate({} {}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n", 14,
      Fixed(paper.corner.y() + paper.size.y() / 2, 1), SvgText(chart.y_name));
}

/// A bar of a round length, for maps.
void DrawBar(std::string& svg, const Paper& paper) {
  const double per_pixel = (paper.high.x() - paper.low.x()) / paper.size.x();
  const double length = RoundTick(60 * per_pixel);
  const Vector2d at = paper.corner + Vector2d(12, paper.size.y() - 12);
  svg += fmt::format("<path fill=\"none\" stroke=\"#222\" d=\"M{}v4h{}v-4\"/>", PointText(at),
                     Fixed(length / per_pixel, 1));
  svg += Text(at + Vector2d(0, -4), "start", fmt::format("{:g}", length));
}

std::string PathOf(const Paper& paper, const ChartSeries& series) {
  std::string path;
  bool drawing = false;
  for (const Vector2d& p : series.points) {
    const bool finite = Finite(p);
    if (finite) path += (drawing ? 'L' : 'M') + PointText(paper(p));
    drawing = finite;
  }
  if (series.mark == Mark::kArea) path += 'Z';
  return path;
}

/// How a mark is drawn; attributes and no style sheet, which a page's policy may forbid.
std::string AttributesOf(const ChartSeries& series) {
  const char* const colour = ChartColour(series.colour);
  switch (series.mark) {
    case Mark::kLine:
      return fmt::format("fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\"", colour);
    case Mark::kDash:
      return fmt::format("fill=\"none\" stroke=\"{}\" stroke-dasharray=\"5 3\"", colour);
    case Mark::kArea:
      return fmt::format("fill=\"{0}\" fill-opacity=\"0.15\" stroke=\"{0}\" stroke-width=\"0.8\"",
                         colour);
    case Mark::kDots:
      return fmt::format("fill=\"{}\"", colour);
    case Mark::kFlag:
      return fmt::format("fill=\"none\" stroke=\"{}\" stroke-width=\"2\"", colour);
  }
  return {};
}

bool IsRound(Mark mark) { return mark == Mark::kDots || mark == Mark::kFlag; }

std::string Circle(const Vector2d& at, double radius) {
  return fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{:g}\"/>", Fixed(at.x(), 1), Fixed(at.y(), 1),
                     radius);
}

void DrawSeries(std::string& svg, const Paper& paper, const ChartSeries& series) {
  svg += fmt::format("<g {}>", AttributesOf(series));
  if (IsRound(series.mark)) {
    std::string dots;
    for (const Vector2d& p : series.points) {
      if (!Finite(p)) continue;
      if (series.mark == Mark::kFlag) {
        svg += Circle(paper(p), 6);
      } else {
        dots += 'M' + PointText(paper(p)) + "h0";
      }
    }
    // One path of round ends is a fraction of as many circles.
    if (!dots.empty()) {
      svg += fmt::format(
          "<path fill=\"none\" stroke=\"{}\" stroke-width=\"4.4\" stroke-linecap=\"round\" "
          "d=\"{}\"/>",
          ChartColour(series.colour), dots);
    }
  } else {
    svg += fmt::format("<path d=\"{}\"/>", PathOf(paper, series));
  }
  svg += "</g>\n";
}

/// Samples and names in one row above the plot.
void DrawLegend(std::string& svg, const Chart& chart) {
  constexpr double kLetter = 6;  // pixels, on average
  std::set<std::string> told;
  double x = chart.axes ? kChartLeft : kChartRight;
  for (const ChartSeries& series : chart.series) {
    if (series.name.empty() || !told.insert(series.name).second) continue;
    const std::string outline = series.mark == Mark::kArea ? "v6h-18Z" : "";
    const std::string sample = IsRound(series.mark)
                                   ? Circle({x + 9, 31}, series.mark == Mark::kFlag ? 5 : 3)
                                   : fmt::format("<path d=\"M{} {}h18{}\"/>", Fixed(x, 1),
                                                 outline.empty() ? 31 : 28, outline);
    svg += fmt::format("<g {}>{}</g>", AttributesOf(series), sample);
    svg += Text({x + 23, 35}, "start", series.name);
    x += 40 + kLetter * static_cast<double>(series.name.size());
  }
}

}  // namespace

const char* ChartColour(int index) {
  return kChartColours[static_cast<std::size_t>(std::max(index, 0)) % kChartColours.size()];
}

ChartFrame FrameOf(const Chart& chart) {
  constexpr double kMost = std::numeric_limits<double>::max();
  ChartFrame frame{Vector2d::Constant(kMost), Vector2d::Constant(-kMost)};
  for (const ChartSeries& series : chart.series) {
    for (const Vector2d& p : series.points) {
      if (!Finite(p)) continue;
      frame.low = frame.low.cwiseMin(p);
      frame.high = frame.high.cwiseMax(p);
    }
  }
  if (frame.low.x() > frame.high.x()) return {};
  for (int axis = 0; axis < 2; ++axis) {
    const double size = std::max(std::abs(frame.low(axis)), std::abs(frame.high(axis)));
    const double span = frame.high(axis) - frame.low(axis);
    // What does not change has no scale of its own: a twentieth of it to either side.
    const bool flat = span <= 1e-6 * size;
    const double margin = size == 0 ? 1 : std::max(flat ? 0.05 * size : 0.04 * span, 1e-9);
    frame.low(axis) -= margin;
    frame.high(axis) += margin;
  }
  return frame;
}

std::string ChartSvg(const Chart& chart) {
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:g} {1:g}\" width=\"{0:g}\" "
      "height=\"{1:g}\" role=\"img\" aria-label=\"{2}\" font-family=\"sans-serif\" "
      "font-size=\"11\" fill=\"#222\">\n",
      chart.width, chart.height, SvgText(chart.title));
  svg += fmt::format("<rect width=\"{:g}\" height=\"{:g}\" fill=\"#fff\"/>\n", chart.width,
                     chart.height);
  svg += fmt::format("<text x=\"{:g}\" y=\"16\" font-size=\"13\" font-weight=\"bold\">{}</text>\n",
                     chart.axes ? kChartLeft : kChartRight, SvgText(chart.title));
  const bool empty = std::ranges::none_of(
      chart.series, [](const ChartSeries& s) { return std::ranges::any_of(s.points, Finite); });
  if (empty) {
    return svg + Text({chart.width / 2, chart.height / 2}, "middle", "not measured") + "</svg>\n";
  }
  const Paper paper = PaperOf(chart);
  if (chart.axes) DrawAxes(svg, paper, chart);
  svg += fmt::format(
      "<rect fill=\"none\" stroke=\"#777\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n",
      Fixed(paper.corner.x(), 1), Fixed(paper.corner.y(), 1), Fixed(paper.size.x(), 1),
      Fixed(paper.size.y(), 1));
  for (const ChartSeries& series : chart.series) DrawSeries(svg, paper, series);
  for (const ChartNote& note : chart.notes) {
    if (Finite(note.at)) svg += Text(paper(note.at) + Vector2d(7, -4), "start", note.text);
  }
  DrawLegend(svg, chart);
  if (chart.equal && chart.axes) DrawBar(svg, paper);
  return svg + "</svg>\n";
}

std::string ChartSheetSvg(const std::string& title, const std::vector<std::string>& facts,
                          const std::vector<Chart>& charts) {
  constexpr double kTitle = 34, kLine = 15;  // pixels
  const double top = kTitle + kLine * static_cast<double>(facts.size()) + 6;
  double width = 0, height = 0;
  std::string drawn;
  for (const Chart& chart : charts) {
    drawn += fmt::format("<svg x=\"{:g}\" y=\"{:g}\"", width, top) + ChartSvg(chart).substr(4);
    width += chart.width;
    height = std::max(height, chart.height);
  }
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:g} {1:g}\" width=\"{0:g}\" "
      "height=\"{1:g}\" font-family=\"sans-serif\" font-size=\"11\" fill=\"#222\">\n"
      "<rect width=\"{0:g}\" height=\"{1:g}\" fill=\"#fff\"/>\n"
      "<text x=\"{2:g}\" y=\"22\" font-size=\"15\" font-weight=\"bold\">{3}</text>\n",
      width, top + height, kChartRight, SvgText(title));
  double y = kTitle + kLine - 6;
  for (const std::string& fact : facts) {
    svg += Text({kChartRight, y}, "start", fact);
    y += kLine;
  }
  return svg + drawn + "</svg>\n";
}

std::vector<Vector2d> EllipseOutline(const Vector2d& middle, const Vector2d& a, const Vector2d& b) {
  constexpr int kPoints = 36;  // chords fall short by 1 - cos 5 deg = 0.4 % of the half axis
  std::vector<Vector2d> outline;
  for (int i = 0; i < kPoints; ++i) {
    const double angle = kTwoPi * i / kPoints;
    outline.emplace_back(middle + std::cos(angle) * a + std::sin(angle) * b);
  }
  return outline;
}

}  // namespace wellgyro
