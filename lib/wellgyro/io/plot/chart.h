#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"

namespace wellgyro {

/// One thing drawn on a chart.
struct ChartSeries {
  enum class Mark {
    kLine,
    kDash,  ///< a limit or a model
    kDots,
    kArea,  ///< a closed outline, filled faintly
    kFlag,  ///< what has to be looked at: large open marks
  };
  std::string name = {};  ///< in the legend, once a name; empty: not there
  Mark mark = Mark::kLine;
  int colour = 0;  ///< of ChartColour
  std::vector<Eigen::Vector2d> points = {};
  std::vector<double> md = {};  ///< measured depth at each point [m]; empty: none
};

/// Text beside a point.
struct ChartNote {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  std::string text = {};
};

/// A chart with two linear axes: what is drawn, not how. Values are in the units that the names of
/// the axes state.
struct Chart {
  std::string title = {}, x_name = {}, y_name = {};
  bool y_down = false;  ///< the second axis grows downwards, as depth does
  bool equal = false;   ///< one scale for both axes, as on a map, with a bar that states it
  bool axes = true;     ///< false: a view without numbers along its sides
  double width = 720, height = 260;  ///< [pixels], of the whole picture
  std::vector<ChartSeries> series = {};
  std::vector<ChartNote> notes = {};
};

/// Colours that readers who do not see red and green can tell apart too (after Okabe and Ito, dark
/// enough for thin lines on white); the last is for lines that only help the eye.
inline constexpr int kHelpColour = 6;
WELLGYRO_EXPORT const char* ChartColour(int index);

/// The range of the axes: all points with a margin, a tenth of a unit in the last digit at least.
struct ChartFrame {
  Eigen::Vector2d low = Eigen::Vector2d::Zero(), high = Eigen::Vector2d::Ones();
};
WELLGYRO_EXPORT ChartFrame FrameOf(const Chart& chart);

/// The chart as an SVG picture, as a file of its own or within a page. Texts are escaped here.
/// Points that are not finite are left out, a line goes on behind them; without any finite point
/// the picture says that nothing was measured.
WELLGYRO_EXPORT std::string ChartSvg(const Chart& chart);

/// Charts side by side as one picture, below its title and lines of facts.
WELLGYRO_EXPORT std::string ChartSheetSvg(const std::string& title,
                                          const std::vector<std::string>& facts,
                                          const std::vector<Chart>& charts);

/// Points of the outline of an ellipse about `middle` with the half axes `a` and `b`.
WELLGYRO_EXPORT std::vector<Eigen::Vector2d> EllipseOutline(const Eigen::Vector2d& middle,
                                                            const Eigen::Vector2d& a,
                                                            const Eigen::Vector2d& b);

}  // namespace wellgyro
