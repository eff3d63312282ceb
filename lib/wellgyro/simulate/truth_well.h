#pragma once

#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/simulate/hole_shape.h"
#include "wellgyro/simulate/simulation.h"

namespace wellgyro {

/// Where one depth of the hole lies.
struct HolePlace {
  /// North, east, TVD [m]: the tangent summed along the hole after its azimuth was turned back by
  /// the convergence of the meridians, TVD along the local vertical.
  Eigen::Vector3d p_WT_W = Eigen::Vector3d::Zero();
  double latitude = 0;     ///< [rad]
  double longitude = 0;    ///< [rad]
  double convergence = 0;  ///< of the meridian here against W's, clockwise positive [rad]
  double height() const { return height_of_w - p_WT_W.z(); }
  double height_of_w = 0;  ///< of the origin of W [m]
};

/// The true hole on the ellipsoid. Directions are closed form; places are integrated along the hole
/// and right to 1e-6 m where the hole turns by less than 0.02 rad/m.
class WELLGYRO_EXPORT TruthWell {
 public:
  TruthWell(const SimulatedWell& well, const SimulatedEarth& earth);

  const HoleShape& shape() const { return shape_; }
  double begin_md() const { return shape_.begin_md(); }
  double end_md() const { return shape_.end_md(); }
  HoleDirection DirectionAt(double md) const { return shape_.At(md); }
  HolePlace PlaceAt(double md) const;
  /// Inclination and azimuth at `md`, azimuth in [0, 2 pi) and 0 at vertical.
  WellPoint PointAt(double md) const;

 private:
  // North, east, TVD, latitude, longitude, convergence, and their slopes along the hole.
  using State = Eigen::Matrix<double, 6, 1>;
  struct Node {
    State value, slope;
  };
  State SlopeAt(double md, const State& state) const;
  void Integrate(const State& begin);

  HoleShape shape_;
  SimulatedEarth earth_;
  double step_ = 0;
  std::vector<Node> nodes_;
};

}  // namespace wellgyro
