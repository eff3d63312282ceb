#include "wellgyro/io/plot/clearance_plot.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Core>
#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/plot/plot_text_internal.h"

namespace wellgyro {
namespace {

using Eigen::Vector2d;

constexpr double kLadderHeight = 560, kLadderWidth = 380, kLadderTop = 56, kLadderLeft = 70,
                 kLadderGap = 90;  // pixels
constexpr std::array kOffsetColours = {"#1b6ca8", "#c0392b", "#27804b", "#8e44ad", "#b9770e",
                                       "#117a8b", "#7b241c", "#566573", "#a04000", "#2e4053"};

const char* Colour(std::size_t i) { return kOffsetColours[i % kOffsetColours.size()]; }

std::string Open(double width, double height, const std::string& title) {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "viewBox=\"0 0 {0:.0f} {1:.0f}\" font-family=\"sans-serif\" font-size=\"11\">\n"
      "<style>.g{{stroke:#ddd;fill:none}}.s{{fill:none;stroke-width:1.6}}"
      ".a{{fill:none;stroke-width:1;stroke-dasharray:4 3}}</style>\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
      "<text x=\"{2:.0f}\" y=\"22\" font-size=\"15\">{3}</text>\n",
      width, height, kLadderLeft, SvgText(title));
}

/// A panel of something against MD, which goes down. What leaves it is cut off at its edge.
struct Ladder {
  const char* id = "";
  double left = 0, most = 1, md_begin = 0, md_end = 1;

  Vector2d operator()(double value, double md) const {
    const double x = std::clamp(value / most, 0.0, 1e3);
    return {left + kLadderWidth * x,
            kLadderTop + kLadderHeight * (md - md_begin) / (md_end - md_begin)};
  }
};

void DrawGrid(std::string& svg, const Ladder& panel, const char* name) {
  const double tick = RoundTick(panel.most / 6),
               step = RoundTick((panel.md_end - panel.md_begin) / 8);
  for (double v = 0; v <= panel.most * (1 + 1e-9); v += tick) {
    const Vector2d p = panel(v, panel.md_end);
    svg += fmt::format(
        "<path d=\"M{0:.1f} {1:.1f}V{2:.1f}\" class=\"g\"/><text x=\"{0:.1f}\" y=\"{3:.1f}\" "
        "text-anchor=\"middle\">{4:g}</text>\n",
        p.x(), kLadderTop, kLadderTop + kLadderHeight, kLadderTop + kLadderHeight + 16, v);
  }
  for (double md = step * std::ceil(panel.md_begin / step); md <= panel.md_end; md += step) {
    const Vector2d p = panel(0, md);
    svg += fmt::format(
        "<path d=\"M{0:.1f} {1:.1f}H{2:.1f}\" class=\"g\"/><text x=\"{3:.1f}\" y=\"{4:.1f}\" "
        "text-anchor=\"end\">{5:g}</text>\n",
        p.x(), p.y(), p.x() + kLadderWidth, p.x() - 6, p.y() + 4, md);
  }
  svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n",
                     panel.left + kLadderWidth / 2, kLadderTop + kLadderHeight + 34, name);
}

template <class Value>
std::string Line(const Ladder& panel, const std::vector<Separation>& rows, const Value& value) {
  std::string path;
  for (const Separation& s : rows) {
    const Vector2d p = panel(value(s), s.md);
    path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", p.x(), p.y());
  }
  return path;
}

std::string ClipOf(const Ladder& panel) {
  return fmt::format(
      "<clipPath id=\"{}\"><rect x=\"{:.0f}\" y=\"{:.0f}\" width=\"{:.0f}\" "
      "height=\"{:.0f}\"/></clipPath>\n",
      panel.id, panel.left, kLadderTop, kLadderWidth, kLadderHeight);
}

void DrawLimit(std::string& svg, const Ladder& panel, double value, const char* colour) {
  if (value > panel.most) return;
  const Vector2d p = panel(value, panel.md_begin);
  svg += fmt::format(
      "<path d=\"M{:.1f} {:.1f}V{:.1f}\" stroke=\"{}\" stroke-width=\"1.2\" fill=\"none\"/>\n",
      p.x(), kLadderTop, kLadderTop + kLadderHeight, colour);
}

void DrawNames(std::string& svg, std::span<const ClearanceSeries> series, double x) {
  constexpr std::size_t kMost = 30;  // lines of 16 pixels: 480
  for (std::size_t i = 0; i < std::min(series.size(), kMost); ++i) {
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" fill=\"{}\">{}</text>\n", x,
                       kLadderTop + 14 + 16 * static_cast<double>(i), Colour(i),
                       SvgText(series[i].name));
  }
  if (series.size() > kMost) {
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\">and {} more</text>\n", x,
                       kLadderTop + 14 + 16.0 * kMost, series.size() - kMost);
  }
}

/// The distance that shows what matters: twice the largest allowed, not more than there is.
double MostDistance(std::span<const ClearanceSeries> series) {
  double allowed = 1, most = 1;
  for (const ClearanceSeries& s : series) {
    for (const Separation& row : *s.rows) {
      allowed = std::max(allowed, row.allowed);
      most = std::max(most, row.distance);
    }
  }
  return std::min(3 * allowed, 1.05 * most);
}

Vector2d DepthRange(std::span<const ClearanceSeries> series) {
  Vector2d range(1e300, -1e300);
  for (const ClearanceSeries& s : series) {
    range.x() = std::min(range.x(), s.rows->front().md);
    range.y() = std::max(range.y(), s.rows->back().md);
  }
  if (series.empty()) return {0, 1};
  if (range.y() - range.x() < 1) range.y() = range.x() + 1;
  return range;
}

}  // namespace

std::string LadderSvg(const std::string& reference, std::span<const ClearanceSeries> series,
                      double stop, double alert) {
  const Vector2d depths = DepthRange(series);
  const Ladder far{"distances", kLadderLeft, MostDistance(series), depths.x(), depths.y()};
  const Ladder factor{"factors", kLadderLeft + kLadderWidth + kLadderGap, 5 * stop, depths.x(),
                      depths.y()};
  const double names = factor.left + kLadderWidth + 16;
  std::string svg = Open(names + 160, kLadderTop + kLadderHeight + 50,
                         reference + ": ladder; dashed, the distance at a separation factor of 1");
  svg += ClipOf(far) + ClipOf(factor);
  DrawGrid(svg, far, "distance between the wells [m], against MD [m]");
  DrawGrid(svg, factor, "separation factor, against MD [m]");
  DrawLimit(svg, factor, stop, "#c00");
  DrawLimit(svg, factor, alert, "#d90");
  for (std::size_t i = 0; i < series.size(); ++i) {
    const auto& rows = *series[i].rows;
    const auto draw = [&](const char* kind, const Ladder& panel, const auto& value) {
      svg += fmt::format("<path class=\"{}\" stroke=\"{}\" clip-path=\"url(#{})\" d=\"{}\"/>\n",
                         kind, Colour(i), panel.id, Line(panel, rows, value));
    };
    draw("s", far, [](const Separation& s) { return s.distance; });
    draw("a", far, [](const Separation& s) { return s.allowed; });
    const double beyond = 2 * factor.most;
    draw("s", factor, [&](const Separation& s) { return s.factor.value_or(beyond); });
  }
  DrawNames(svg, series, names);
  return svg + "</svg>\n";
}

std::string TravellingCylinderSvg(const std::string& reference,
                                  std::span<const ClearanceSeries> series) {
  constexpr double kRadius = 280, kMiddle = kLadderLeft + kRadius;  // pixels
  const Vector2d centre(kMiddle, kLadderTop + kRadius + 10);
  const double most = MostDistance(series);
  std::string svg = Open(kMiddle + kRadius + 220, kLadderTop + 2 * kRadius + 50,
                         reference + ": travelling cylinder, north up; distances [m], MD [m]");
  const double tick = RoundTick(most / 4);
  for (double r = tick; r <= most * (1 + 1e-9); r += tick) {
    const double pixels = kRadius * r / most;
    svg += fmt::format(
        "<circle cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"{2:.1f}\" class=\"g\"/><text x=\"{3:.1f}\" "
        "y=\"{4:.1f}\">{5:g}</text>\n",
        centre.x(), centre.y(), pixels, centre.x() + 3, centre.y() - pixels - 3, r);
  }
  for (std::size_t i = 0; i < series.size(); ++i) {
    std::string path;
    bool drawing = false;
    double labelled = -1e300;
    std::string labels;
    const auto& rows = *series[i].rows;
    const double every = RoundTick(std::max(1.0, rows.back().md - rows.front().md) / 8);
    for (const Separation& s : rows) {
      if (s.distance > most) {
        drawing = false;
        continue;
      }
      const double angle = s.toolface + s.high_side;
      const Vector2d p =
          centre + kRadius * s.distance / most * Vector2d(std::sin(angle), -std::cos(angle));
      path += fmt::format("{}{:.1f} {:.1f}", drawing ? "L" : "M", p.x(), p.y());
      drawing = true;
      if (s.md < labelled + every) continue;
      labelled = s.md;
      labels += fmt::format(
          "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2\" fill=\"{}\"/><text "
          "x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"8\" fill=\"{}\">{:.0f}</text>\n",
          p.x(), p.y(), Colour(i), p.x() + 4, p.y() + 3, Colour(i), s.md);
    }
    if (path.empty()) continue;
    svg += fmt::format("<path class=\"s\" stroke=\"{}\" d=\"{}\"/>\n", Colour(i), path) + labels;
  }
  DrawNames(svg, series, kMiddle + kRadius + 40);
  return svg + "</svg>\n";
}

}  // namespace wellgyro
