#include <cmath>

#include <Eigen/QR>

#include "wellgyro/fit/shift_estimate_internal.h"
#include "wellgyro/math/linear_algebra.h"

namespace wellgyro {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Least squares of the columns of B by the eigenvectors of their information, of columns of unit
// length: x, cov, told and rank. A shift with a part in the null space is not told, whatever value
// the others would leave it.
void SolveShifts(const MatrixXd& B, const VectorXd& e, ToolShiftEstimate& found) {
  // Squared sine of the angle that leaves nothing to tell; squared part of a unit vector.
  constexpr double kNull = 1e-6, kPart = 1e-6;
  const VectorXd scale = B.colwise().norm().transpose().cwiseMax(1e-300).cwiseInverse();
  const MatrixXd scaled = B * scale.asDiagonal();
  const SymmetricEigen eigen = EigenOfSymmetric(scaled.transpose() * scaled);
  VectorXd inverse = VectorXd::Zero(B.cols()), null = inverse;
  for (Index i = 0; i < B.cols(); ++i) {
    if (eigen.values[i] > kNull) {
      inverse[i] = 1 / eigen.values[i];
      ++found.rank;
    } else {
      null += eigen.vectors.col(i).cwiseAbs2();
    }
  }
  for (const double part : null) found.told.push_back(part < kPart ? 1 : 0);
  const MatrixXd V = scale.asDiagonal() * eigen.vectors;
  found.cov = V * inverse.asDiagonal() * V.transpose();
  found.x = found.cov * (B.transpose() * e);
}

}  // namespace

ToolShiftEstimator::ToolShiftEstimator(Index common, Index shifts)
    : common_(common), shifts_(shifts) {
  const Index columns = common + shifts + 1;
  constexpr Index kAtOnce = 4;  // rows a column: the triangle is then a fifth of the work
  rows_ = MatrixXd::Zero((1 + kAtOnce) * columns, columns);
  rows_.topLeftCorner(common, common).setIdentity();
  filled_ = columns;
}

void ToolShiftEstimator::Add(const MatrixXd& cov_noise, const MatrixXd& F, const MatrixXd& B,
                             const VectorXd& e) {
  if (filled_ + e.size() > rows_.rows()) Reduce();
  MatrixXd block(e.size(), rows_.cols());
  block << F, B, e;
  rows_.middleRows(filled_, e.size()) = Cholesky(cov_noise).Whitened(block);
  filled_ += e.size();
  dof_ += static_cast<int>(e.size());
}

void ToolShiftEstimator::Reduce() {
  const Index columns = rows_.cols();
  const Eigen::HouseholderQR<MatrixXd> qr(rows_.topRows(filled_));
  rows_.topRows(columns) = qr.matrixQR().topRows(columns).triangularView<Eigen::Upper>();
  filled_ = columns;
}

ToolShiftEstimate ToolShiftEstimator::Estimate() {
  Reduce();
  const MatrixXd B = rows_.block(common_, common_, shifts_, shifts_);
  const VectorXd e = rows_.block(common_, common_ + shifts_, shifts_, 1);
  const double beyond = std::pow(rows_(common_ + shifts_, common_ + shifts_), 2);
  ToolShiftEstimate found;
  SolveShifts(B, e, found);
  found.chi_square = e.squaredNorm() + beyond;
  found.left = (e - B * found.x).squaredNorm() + beyond;
  found.dof = dof_;
  const MatrixXd by_shifts = rows_.block(0, common_, common_, shifts_);
  found.common = rows_.topLeftCorner(common_, common_)
                     .triangularView<Eigen::Upper>()
                     .solve(rows_.block(0, common_ + shifts_, common_, 1) - by_shifts * found.x);
  return found;
}

MatrixXd FactorOf(const MatrixXd& cov) {
  if (cov.rows() == 0) return cov;
  const VectorXd sigma = cov.diagonal().cwiseMax(0).cwiseSqrt();
  const VectorXd per_sigma = sigma.cwiseMax(1e-300).cwiseInverse();
  const SymmetricEigen eigen =
      EigenOfSymmetric(per_sigma.asDiagonal() * cov * per_sigma.asDiagonal());
  return sigma.asDiagonal() * eigen.vectors * eigen.values.cwiseMax(0).cwiseSqrt().asDiagonal();
}

}  // namespace wellgyro
