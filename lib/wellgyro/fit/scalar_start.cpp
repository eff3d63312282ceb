#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "wellgyro/fit/scalar_start_internal.h"
#include "wellgyro/math/linear_algebra.h"
#include "wellgyro/math/median.h"

namespace wellgyro {
namespace {

Eigen::VectorXd Packed(const Eigen::Matrix3d& M, const Eigen::Vector3d& b) {
  Eigen::VectorXd x(9);
  x << M(0, 0), M(1, 0), M(1, 1), M(2, 0), M(2, 1), M(2, 2), b;
  return x;
}

// A sphere about the middle of what the channels read.
Eigen::VectorXd Sphere(const Eigen::MatrixX3d& v, double length) {
  const Eigen::Vector3d middle = (v.colwise().maxCoeff() + v.colwise().minCoeff()).transpose() / 2;
  std::vector<double> radii;
  for (const auto& row : v.rowwise()) radii.push_back((row.transpose() - middle).norm());
  return Packed(length / std::max(Median(radii), 1e-300) * Eigen::Matrix3d::Identity(), middle);
}

// M' M = A with M lower triangular: Cholesky from the last corner.
Eigen::Matrix3d LowerRoot(const Eigen::Matrix3d& A) {
  const Eigen::Matrix3d turned = A.reverse();
  const Eigen::Matrix3d L = Cholesky(turned).L();
  return Eigen::Matrix3d(L.reverse()).transpose();
}

}  // namespace

Eigen::Matrix3d LowerOf(const Eigen::VectorXd& x) {
  Eigen::Matrix3d M = Eigen::Matrix3d::Zero();
  M(0, 0) = x[0];
  M(1, 0) = x[1];
  M(1, 1) = x[2];
  M(2, 0) = x[3];
  M(2, 1) = x[4];
  M(2, 2) = x[5];
  return M;
}

std::vector<Eigen::VectorXd> ScalarStarts(const Eigen::MatrixX3d& v, double length) {
  std::vector<Eigen::VectorXd> starts{Sphere(v, length)};
  // The ellipsoid w' Q w + 2 u' w = 1 through the readings, about the sphere's centre and in units
  // of its radius.
  const Eigen::Vector3d centre = starts[0].tail<3>();
  const double unit = length / starts[0][0];
  Eigen::MatrixXd A(v.rows(), 9);
  for (Eigen::Index i = 0; i < v.rows(); ++i) {
    const Eigen::Vector3d w = (v.row(i).transpose() - centre) / unit;
    A.row(i) << w.x() * w.x(), w.y() * w.y(), w.z() * w.z(), 2 * w.x() * w.y(), 2 * w.y() * w.z(),
        2 * w.z() * w.x(), 2 * w.x(), 2 * w.y(), 2 * w.z();
  }
  const Eigen::VectorXd q = SolveLeastSquares(A, Eigen::VectorXd::Ones(v.rows()));
  Eigen::Matrix3d Q;
  Q << q[0], q[3], q[5], q[3], q[1], q[4], q[5], q[4], q[2];
  const Eigen::Vector3d b = -Q.inverse() * q.tail<3>();
  Q *= length * length / (1 + b.dot(Q * b));
  if (!Q.allFinite() || !Cholesky(Q).positive()) return starts;
  const Eigen::Matrix3d M = LowerRoot(Q) / unit;
  if (M.allFinite() && b.allFinite()) starts.push_back(Packed(M, centre + unit * b));
  return starts;
}

}  // namespace wellgyro
