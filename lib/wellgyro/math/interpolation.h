#pragma once

#include "wellgyro/base/export.h"

namespace wellgyro {

/// Weighted least-squares parabola through values scattered about t = 0, for smoothing with
/// derivatives (Savitzky and Golay for uneven spacing). Feed the points, then ask. Sums are kept in
/// the caller's unit of t: scale t to about [-1, 1].
class WELLGYRO_EXPORT LocalFit {
 public:
  struct Value {
    double value = 0, slope = 0, curvature = 0;         ///< y, dy/dt, d2y/dt2 at t = 0
    double variance_value = 0;                          ///< for unit variance of every y ...
    double variance_slope = 0, variance_curvature = 0;  ///< ... and of the derivatives
    double scatter = 0;  ///< 1-sigma of one y, as the points scatter about the fit; 0: too few
    double freedom = 0;  ///< points beyond the unknowns that told it, by their weights
  };

  void Add(double t, double y, double weight);
  /// Points with weight above zero.
  int count() const { return count_; }
  /// A constant, straight line or parabola (degree 0, 1, 2). Needs degree + 1 points at different
  /// t, else falls to the degree that they determine; with no point at all, zero.
  Value Fit(int degree) const;

 private:
  int count_ = 0;
  double s_[5] = {};   ///< sum of w t^k
  double w2_[5] = {};  ///< sum of w^2 t^k
  double y_[3] = {};   ///< sum of w t^k y
  double yy_ = 0;      ///< sum of w y^2
};

}  // namespace wellgyro
