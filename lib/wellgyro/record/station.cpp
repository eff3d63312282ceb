#include "wellgyro/record/station.h"

#include <cmath>

#include "wellgyro/math/rotation.h"
#include "wellgyro/math/square.h"
#include "wellgyro/record/unknown_angle.h"

namespace wellgyro {

void DeriveAngles(double azimuth_at_vertical, Station& s) {
  const bool vertical = s.tangent_L.x() == 0 && s.tangent_L.y() == 0;
  s.inclination = InclinationOf(s.tangent_L);
  s.azimuth = vertical ? azimuth_at_vertical : AzimuthOf(s.tangent_L);
  // High side and right, of unit length.
  Eigen::Matrix<double, 3, 2> across_L = TangentByAngles(s.inclination, s.azimuth);
  across_L.col(1) << -std::sin(s.azimuth), std::cos(s.azimuth), 0;
  const Eigen::Matrix2d cov = across_L.transpose() * s.cov_tangent_L * across_L;
  const double sine = std::sin(s.inclination), azimuth = cov(1, 1) / Square(sine);
  const bool known = azimuth < kUnknownAngleVariance;
  s.cov_md_inc_azi(1, 1) = cov(0, 0);
  s.cov_md_inc_azi(2, 2) = known ? azimuth : kUnknownAngleVariance;
  s.cov_md_inc_azi(1, 2) = s.cov_md_inc_azi(2, 1) = known ? cov(0, 1) / sine : 0;
}

void DeriveTangent(Station& s) {
  const Eigen::Matrix<double, 3, 2> slope = TangentByAngles(s.inclination, s.azimuth);
  s.tangent_L = Tangent(s.inclination, s.azimuth);
  s.cov_tangent_L = slope * s.cov_md_inc_azi.bottomRightCorner<2, 2>() * slope.transpose();
}

}  // namespace wellgyro
