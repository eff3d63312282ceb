#pragma once

#include <vector>

#include <Eigen/Core>

#include "wellgyro/uncertainty/survey_point.h"

namespace wellgyro {

/// The circular arc between two stations, by length along it.
class HoleArc {
 public:
  HoleArc(const SurveyPoint& from, const SurveyPoint& to);

  double length() const { return length_; }
  double Dogleg(double length) const { return curvature_ * length; }
  Eigen::Vector3d Tangent(double s) const;
  /// Change of the tangent per metre.
  Eigen::Vector3d Bend(double s) const;
  /// Adds the places, in order, where the arc crosses `inclination`.
  void Crossings(double inclination, std::vector<double>& places) const;

 private:
  double length_ = 0;
  double curvature_ = 0;             ///< [rad/m]
  Eigen::Vector3d from_W_, side_W_;  ///< tangent at the begin, and across it towards the end
};

}  // namespace wellgyro
