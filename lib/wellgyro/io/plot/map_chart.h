#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/io/plot/chart.h"

/// Wells on plans and sections.
namespace wellgyro {

/// The path of a well as it is drawn, in any one unit of length.
struct MapPath {
  std::string name = {};
  std::vector<Eigen::Vector3d> points_W = {};  ///< north, east, TVD
  std::vector<double> md = {};                 ///< one a point
  /// Covariances of those points that have one, by their index, in the unit's square.
  std::vector<std::pair<std::size_t, Eigen::Matrix3d>> covs_W = {};
};

/// Directions of the paper, unit vectors at right angles to each other.
struct MapView {
  Eigen::Vector3d right_W = Eigen::Vector3d::UnitY();
  Eigen::Vector3d other_W = Eigen::Vector3d::UnitX();  ///< up, or down where the chart grows so

  Eigen::Vector2d operator()(const Eigen::Vector3d& p_W) const {
    return {right_W.dot(p_W), other_W.dot(p_W)};
  }
};

/// The vertical plane through the ends of `path`.
struct MapSection {
  double azimuth = 0;  ///< of its right-hand direction [rad], [0, 2 pi)
  MapView view;
};
WELLGYRO_EXPORT MapSection SectionThrough(const MapPath& path);

/// The round factor, at least 1, by which ellipses at `confidence` are drawn larger so that the
/// largest can be seen beside the path.
WELLGYRO_EXPORT double MagnificationOf(const MapPath& path, double confidence);

/// The ellipses that are drawn: indices into `path.covs_W` of some ten, the deepest among them.
WELLGYRO_EXPORT std::vector<std::size_t> EllipsesShown(const MapPath& path);

/// The path with its ellipses as they are seen across `view`, then a mark with its depth at round
/// measured depths, where `unit` names the unit of length.
WELLGYRO_EXPORT void DrawOnMap(Chart& chart, const MapPath& path, const MapView& view,
                               double confidence, double magnify, const std::string& unit);

/// Another well's path, in the colour of its number from 0.
WELLGYRO_EXPORT void DrawBeside(Chart& chart, const MapPath& path, const MapView& view, int number);

}  // namespace wellgyro
