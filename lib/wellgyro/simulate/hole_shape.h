#pragma once

#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/simulate/simulation.h"

namespace wellgyro {

/// Direction of the hole at one depth, in L at that place.
struct HoleDirection {
  Eigen::Vector3d tangent_L = Eigen::Vector3d::UnitZ();   ///< unit, down-hole
  Eigen::Vector3d curvature_L = Eigen::Vector3d::Zero();  ///< d tangent / d md, in L [1/m]
};

/// Direction along the hole, twice differentiable and regular at vertical: by laws of inclination
/// and azimuth, or along stations. Those are joined by arcs, and the arcs' directions smoothed by
/// a uniform cubic B-spline of knots `smoothing` apart: no overshoot, an arc longer than four knots
/// is kept, and a station where the curvature changes by J is passed at J smoothing / 6. Where the
/// hole is straight and vertical, it stays so.
class WELLGYRO_EXPORT HoleShape {
 public:
  /// Throws std::invalid_argument, naming the field and the value: fewer than two stations, depths
  /// not increasing, more than 60 deg between neighbours, a term without the ramp it needs,
  /// ramps, quarter periods or smoothing below 0.1 m, a hole within 1 deg of straight up.
  explicit HoleShape(const SimulatedWell& well);

  double begin_md() const { return begin_md_; }  ///< [m]
  double end_md() const { return end_md_; }      ///< [m]
  /// Shortest length along the hole over which its direction has structure of its own [m].
  double detail() const { return detail_; }
  HoleDirection At(double md) const;

 private:
  struct Angle {
    double value, slope;
  };
  // w(md) of one term, with what else it takes.
  struct Term {
    double begin, length, ramp_in, ramp_out;
    double rate, amplitude, wave_number, phase;
  };
  struct Law {
    double start = 0;
    std::vector<Term> terms;
  };
  Law MakeLaw(const AngleLaw& law, const char* name);
  void MakeSpline(const SimulatedWell& well);
  static Angle Evaluate(const Law& law, double md);
  HoleDirection OnSpline(double md) const;

  double begin_md_ = 0;
  double end_md_ = 0;
  double detail_ = 0;
  Law inclination_;
  Law azimuth_;
  double spacing_ = 0;
  std::vector<Eigen::Vector3d> controls_L_;
};

}  // namespace wellgyro
