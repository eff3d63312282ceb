#include "wellgyro/io/plot/well_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/plot/plot_text_internal.h"
#include "wellgyro/uncertainty/ellipse.h"

namespace wellgyro {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kPanel = 460, kMargin = 64, kTop = 56, kGap = 84;  // pixels

/// A square window on a plane, first axis to the right, second up or down.
struct Panel {
  double left = 0;
  bool second_down = false;
  Vector2d middle = Vector2d::Zero();
  double span = 1;  ///< [m] across

  Vector2d operator()(const Vector2d& p) const {
    const Vector2d u = (p - middle) / span;
    return {left + kPanel * (0.5 + u.x()), kTop + kPanel * (0.5 + (second_down ? u.y() : -u.y()))};
  }
};

/// Two coordinates of a position and two half axes of its ellipse.
struct Flat {
  std::vector<Vector2d> path;
  std::vector<std::array<Vector2d, 2>> ellipses;  ///< one a station that has a covariance
};

Flat OnPlane(const SurveyedWell& well, const PositionUncertainty& errors, double sigmas,
             const Vector3d& right, const Vector3d& other) {
  Flat flat;
  const auto drop = [&](const Vector3d& p) { return Vector2d(right.dot(p), other.dot(p)); };
  for (const Vector3d& p : well.position) flat.path.push_back(drop(p));
  for (const Eigen::Matrix3d& cov : errors.cov_p) {
    const SeenEllipse seen = EllipseSeenAlong(cov, right.cross(other), sigmas);
    flat.ellipses.push_back({drop(seen.major), drop(seen.minor)});
  }
  return flat;
}

void Frame(Panel& panel, const Flat& flat, double magnify) {
  Vector2d low = flat.path[0], high = low;
  for (std::size_t k = 0; k < flat.path.size(); ++k) {
    const bool known = k < flat.ellipses.size();
    const double reach = known ? magnify * flat.ellipses[k][0].norm() : 0;
    low = low.cwiseMin(flat.path[k].array().matrix() - Vector2d::Constant(reach));
    high = high.cwiseMax(flat.path[k] + Vector2d::Constant(reach));
  }
  panel.middle = (low + high) / 2;
  panel.span = std::max(1.0, 1.08 * (high - low).maxCoeff());
}

void DrawGrid(std::string& svg, const Panel& panel, const char* x_name, const char* y_name) {
  svg += fmt::format(
      "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"#fff\" "
      "stroke=\"#888\"/>\n",
      panel.left, kTop, kPanel, kPanel);
  const double tick = RoundTick(panel.span / 7);
  for (int axis = 0; axis < 2; ++axis) {
    const double from = panel.middle(axis) - panel.span / 2, to = from + panel.span;
    for (double v = tick * std::ceil(from / tick); v <= to; v += tick) {
      Vector2d at = panel.middle;
      at(axis) = v;
      const Vector2d p = panel(at);
      const double value = std::abs(v) < tick / 2 ? 0 : v;
      svg += axis == 0
                 ? fmt::format(
                       "<path d=\"M{:.1f} {:.1f}V{:.1f}\" class=\"g\"/><text x=\"{:.1f}\" "
                       "y=\"{:.1f}\" text-anchor=\"middle\">{:g}</text>\n",
                       p.x(), kTop, kTop + kPanel, p.x(), kTop + kPanel + 16, value)
                 : fmt::format(
                       "<path d=\"M{:.1f} {:.1f}H{:.1f}\" class=\"g\"/><text x=\"{:.1f}\" "
                       "y=\"{:.1f}\" text-anchor=\"end\">{:g}</text>\n",
                       panel.left, p.y(), panel.left + kPanel, panel.left - 6, p.y() + 4, value);
    }
  }
  svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n",
                     panel.left + kPanel / 2, kTop + kPanel + 36, x_name);
  svg += fmt::format(
      "<text transform=\"translate({:.1f} {:.1f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
      panel.left - 50, kTop + kPanel / 2, y_name);
}

void DrawEllipse(std::string& svg, const Panel& panel, const Vector2d& middle,
                 const std::array<Vector2d, 2>& half, double magnify) {
  constexpr double kThin = 0.5;  // pixels; one without breadth would not be drawn at all
  const Vector2d at = panel(middle);
  const Vector2d a = panel(middle + magnify * half[0]) - at;
  const Vector2d b = panel(middle + magnify * half[1]) - at;
  svg += fmt::format(
      "<ellipse rx=\"{:.2f}\" ry=\"{:.2f}\" transform=\"translate({:.2f} {:.2f}) "
      "rotate({:.2f})\" class=\"e\"/>\n",
      std::max(a.norm(), kThin), std::max(b.norm(), kThin), at.x(), at.y(),
      ToDegrees(std::atan2(a.y(), a.x())));
}

/// Ellipses far enough apart on the paper to be told from each other, the deepest among them.
void DrawEllipses(std::string& svg, const Panel& panel, const Flat& flat, double magnify) {
  constexpr double kLeast = 28;  // pixels
  Vector2d last(-1e9, -1e9);
  for (std::size_t back = flat.ellipses.size(); back-- > 0;) {
    const Vector2d at = panel(flat.path[back]);
    if ((at - last).norm() < kLeast) continue;
    last = at;
    DrawEllipse(svg, panel, flat.path[back], flat.ellipses[back], magnify);
  }
}

void DrawPath(std::string& svg, const Panel& panel, const Flat& flat) {
  svg += "<path class=\"w\" d=\"";
  for (std::size_t k = 0; k < flat.path.size(); ++k) {
    const Vector2d p = panel(flat.path[k]);
    svg += fmt::format("{}{:.2f} {:.2f}", k == 0 ? "M" : "L", p.x(), p.y());
  }
  svg += "\"/>\n";
}

double Magnification(const Flat& flat, double span) {
  double greatest = 0;
  for (const auto& half : flat.ellipses) greatest = std::max(greatest, half[0].norm());
  constexpr double kShare = 0.03;  // of the panel, for the greatest semi-axis
  if (!(greatest > 0) || greatest >= kShare * span) return 1;
  return std::min(1000.0, RoundTick(kShare * span / greatest));
}

void Draw(std::string& svg, Panel& panel, const Flat& flat, double confidence, const char* name,
          const char* x_name, const char* y_name) {
  Frame(panel, flat, 0);
  const double magnify = Magnification(flat, panel.span);
  Frame(panel, flat, magnify);
  svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\">{}, error ellipses at {:g} %{}</text>\n",
                     panel.left, kTop - 10, name, 100 * confidence,
                     magnify > 1 ? fmt::format(", drawn {:g} times as large", magnify) : "");
  DrawGrid(svg, panel, x_name, y_name);
  DrawEllipses(svg, panel, flat, magnify);
  DrawPath(svg, panel, flat);
}

}  // namespace

std::string WellPlotSvg(const SurveyedWell& well, const PositionUncertainty& errors,
                        double confidence, const std::string& title) {
  const double sigmas = ConfidenceFactor(confidence, 2);
  const Vector3d reach = well.position.back() - well.position.front();
  const double azimuth = std::atan2(reach.y(), reach.x());
  const Vector3d along(std::cos(azimuth), std::sin(azimuth), 0);
  const Flat plan = OnPlane(well, errors, sigmas, Vector3d::UnitY(), Vector3d::UnitX());
  const Flat section = OnPlane(well, errors, sigmas, along, Vector3d::UnitZ());
  Panel left{kMargin}, right{kMargin + kPanel + kGap, true};
  const double width = right.left + kPanel + 24, height = kTop + kPanel + 52;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "viewBox=\"0 0 {0:.0f} {1:.0f}\" font-family=\"sans-serif\" font-size=\"11\">\n"
      "<style>.g{{stroke:#ddd}}.w{{stroke:#124;stroke-width:1.6;fill:none}}"
      ".e{{stroke:#c33;fill:#c33;fill-opacity:0.12}}</style>\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
      width, height);
  svg += fmt::format("<text x=\"{:.0f}\" y=\"22\" font-size=\"15\">{}</text>\n", kMargin,
                     SvgText(title));
  const std::string along_name =
      fmt::format("along azimuth {:.1f} deg [m]", ToDegrees(WrapTwoPi(azimuth)));
  Draw(svg, left, plan, confidence, "plan", "east [m]", "north [m]");
  Draw(svg, right, section, confidence, "vertical section", along_name.c_str(), "TVD [m]");
  return svg + "</svg>\n";
}

}  // namespace wellgyro
