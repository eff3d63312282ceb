#include "wellgyro/uncertainty/ellipse.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/statistics.h"

namespace wellgyro {

using Eigen::Matrix3d;
using Eigen::Vector3d;

double ConfidenceFactor(double confidence, int dimensions) {
  if (!(confidence > 0 && confidence < 1)) {
    throw std::domain_error("confidence " + std::to_string(confidence) + " is not within 0 and 1");
  }
  return std::sqrt(ChiSquareQuantile(confidence, dimensions));
}

ErrorEllipse HorizontalEllipse(const Matrix3d& cov_W, double confidence) {
  const double k = ConfidenceFactor(confidence, 2);
  const double mean = (cov_W(0, 0) + cov_W(1, 1)) / 2;
  const double half = (cov_W(0, 0) - cov_W(1, 1)) / 2;
  const double radius = std::hypot(half, cov_W(0, 1));
  ErrorEllipse ellipse;
  ellipse.semi_major = k * std::sqrt(std::max(0.0, mean + radius));
  ellipse.semi_minor = k * std::sqrt(std::max(0.0, mean - radius));
  if (radius > 0) {
    const double azimuth = std::atan2(cov_W(0, 1), half) / 2;
    ellipse.azimuth_major = azimuth < 0 ? azimuth + kPi : azimuth;
    if (ellipse.azimuth_major >= kPi) ellipse.azimuth_major = 0;
  }
  return ellipse;
}

Eigen::Matrix2d EllipseAboutSum(const Eigen::Matrix2d& a, const Eigen::Matrix2d& b) {
  const double of_a = std::sqrt(a.trace()), of_b = std::sqrt(b.trace());
  if (!(of_a > 0)) return b;
  if (!(of_b > 0)) return a;
  return (1 + of_b / of_a) * a + (1 + of_a / of_b) * b;
}

// The weight of a point grows as it stands out of the ellipse of all.
Eigen::Matrix2d EllipseAbout(std::span<const Eigen::Vector2d> points) {
  double most = 0;
  for (const Eigen::Vector2d& p : points) most = std::max(most, p.norm());
  if (!(most > 0) || !std::isfinite(most)) return Eigen::Matrix2d::Zero();
  // Points on one line have an ellipse of no width: given a thousandth.
  const double least = 1e-6 * most * most;
  std::vector<double> weight(points.size(), 1 / static_cast<double>(points.size()));
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (int i = 0; i < 200; ++i) {
    spread = least * Eigen::Matrix2d::Identity();
    for (std::size_t k = 0; k < points.size(); ++k) {
      spread += weight[k] * points[k] * points[k].transpose();
    }
    const Eigen::Matrix2d inverse = spread.inverse();
    for (std::size_t k = 0; k < points.size(); ++k) {
      weight[k] *= points[k].dot(inverse * points[k]) / 2;
    }
  }
  const Eigen::Matrix2d inverse = spread.inverse();
  double out = 0;
  for (const Eigen::Vector2d& p : points) out = std::max(out, p.dot(inverse * p));
  return out * spread;
}

SeenEllipse EllipseSeenAlong(const Matrix3d& cov, const Vector3d& sight, double sigmas) {
  const Vector3d u = sight.unitOrthogonal();
  const Vector3d v = sight.cross(u);
  const double uu = u.dot(cov * u), vv = v.dot(cov * v), uv = u.dot(cov * v);
  const double radius = std::hypot((uu - vv) / 2, uv);
  const double turn = radius > 0 ? std::atan2(uv, (uu - vv) / 2) / 2 : 0;
  const double major = std::sqrt(std::max(0.0, (uu + vv) / 2 + radius));
  const double minor = std::sqrt(std::max(0.0, (uu + vv) / 2 - radius));
  return {sigmas * major * (std::cos(turn) * u + std::sin(turn) * v),
          sigmas * minor * (std::cos(turn) * v - std::sin(turn) * u)};
}

ErrorEllipsoid Ellipsoid(const Matrix3d& cov, double confidence) {
  const double k = ConfidenceFactor(confidence, 3);
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(cov);
  ErrorEllipsoid ellipsoid;
  for (int i = 0; i < 3; ++i) {
    ellipsoid.semi_axes(i) = k * std::sqrt(std::max(0.0, solver.eigenvalues()(2 - i)));
    ellipsoid.axes.col(i) = solver.eigenvectors().col(2 - i);
  }
  ellipsoid.axes.col(2) = ellipsoid.axes.col(0).cross(ellipsoid.axes.col(1));
  return ellipsoid;
}

Matrix3d ToHighSide(const Matrix3d& cov_W, double inclination, double azimuth) {
  const double si = std::sin(inclination), ci = std::cos(inclination);
  const double sa = std::sin(azimuth), ca = std::cos(azimuth);
  Matrix3d turn;
  turn << ci * ca, ci * sa, -si, -sa, ca, 0, si * ca, si * sa, ci;
  return turn * cov_W * turn.transpose();
}

}  // namespace wellgyro
