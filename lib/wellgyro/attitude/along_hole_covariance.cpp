#include "wellgyro/attitude/along_hole_covariance.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/Eigenvalues>

#include "wellgyro/math/rotation.h"

namespace wellgyro {
namespace {

// Eigenvalues of a correlation matrix below this are rounding of zero: states that determine each
// other, or that are known.
constexpr double kSingular = 1e-11;

// The X with E[x1 x2'] = cov X, so that E[r x2'] = E[r x1'] X for every r that depends on x2 by x1
// alone. Where cov is singular any solution will do; the smallest is taken.
FilterMatrix SolveCovariance(const FilterMatrix& cov, const FilterMatrix& cross) {
  const FilterVector scale =
      cov.diagonal().unaryExpr([](double v) { return v > 0 ? 1 / std::sqrt(v) : 0.0; });
  const FilterMatrix correlation = scale.asDiagonal() * cov * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<FilterMatrix> eigen(correlation);
  const FilterVector inverse =
      eigen.eigenvalues().unaryExpr([](double v) { return v > kSingular ? 1 / v : 0.0; });
  const FilterMatrix& v = eigen.eigenvectors();
  return scale.asDiagonal() * v * inverse.asDiagonal() * v.transpose() * scale.asDiagonal() * cross;
}

// d tangent / d(inclination, azimuth).
Eigen::Matrix<double, 3, 2> TangentSlope(double inclination, double azimuth) {
  const double ci = std::cos(inclination), si = std::sin(inclination);
  const double ca = std::cos(azimuth), sa = std::sin(azimuth);
  return (Eigen::Matrix<double, 3, 2>() << ci * ca, -si * sa, ci * sa, si * ca, -si, 0).finished();
}

Eigen::Matrix3d PlusTransposed(const Eigen::Matrix3d& m) { return m + m.transpose(); }

}  // namespace

AlongHoleCovariance::AlongHoleCovariance(const Eigen::Matrix3d& cov_tie_in, double depth_sigma,
                                         TimeAlongHole order)
    : order_(order), depth_sigma_(depth_sigma), cov_(cov_tie_in) {}

// Carries the two covariances with the state from the station last seen to this one.
void AlongHoleCovariance::Advance(const StationState& station) {
  const bool with_depth = order_ == TimeAlongHole::kWithDepth;
  const FilterMatrix& link = with_depth ? station.cov_with_previous : state_cov_with_previous_;
  if (link.size() == 0) {
    cov_with_state_ = Rows::Zero(3, station.cov.rows());
    slope_with_state_ = Rows::Zero(3, station.cov.rows());
    cov_with_lean_.setZero();
    slope_with_lean_.setZero();
    return;
  }
  if (with_depth ? station.epoch <= epoch_ : station.epoch >= epoch_) {
    throw std::invalid_argument("AlongHoleCovariance: epoch " + std::to_string(station.epoch) +
                                " comes after epoch " + std::to_string(epoch_));
  }
  const FilterMatrix cross = with_depth ? link : FilterMatrix(link.transpose());
  const FilterMatrix carry = SolveCovariance(state_cov_, cross);
  cov_with_state_ = (cov_with_state_ * carry).eval();
  slope_with_state_ = (slope_with_state_ * carry).eval();
  const double seconds = std::abs((station.attitude.time - time_).seconds());
  const double lasts = station.lean_seconds > 0 ? std::exp(-seconds / station.lean_seconds) : 0;
  const double lean =
      lean_variance_ > 0 ? lasts * std::sqrt(station.cov_white(0, 0) / lean_variance_) : 0;
  cov_with_lean_ *= lean;
  slope_with_lean_ *= lean;
}

void AlongHoleCovariance::Skip(const StationState& station) {
  if (any_) Advance(station);
  epoch_ = station.epoch;
  state_cov_ = station.cov;
  state_cov_with_previous_ = station.cov_with_previous;
  lean_variance_ = station.cov_white(0, 0);
  time_ = station.attitude.time;
}

Eigen::Matrix3d AlongHoleCovariance::Add(const StationState& station) {
  const double inclination = station.attitude.inclination, azimuth = station.attitude.azimuth;
  const Eigen::Matrix<double, 3, 2> slope = TangentSlope(inclination, azimuth);
  const Rows rows = slope * station.angles;
  const Rows rows_cov = rows * station.cov;
  const Eigen::Matrix3d cov_slope =
      rows_cov * rows.transpose() + slope * station.cov_white * slope.transpose();
  const bool first = !any_;
  if (!first && !(station.along.md > md_)) {
    throw std::invalid_argument("AlongHoleCovariance: depth " + std::to_string(station.along.md) +
                                " m is not below " + std::to_string(md_) + " m");
  }
  Skip(station);
  if (first) {
    any_ = true;
    cov_with_slope_.setZero();
    cov_with_lean_.setZero();
    cov_with_state_ = Rows::Zero(3, station.cov.rows());
  } else {
    // r' = (r + half s) + half s'
    const double half = (station.along.md - md_) / 2;
    const Rows upper = cov_with_state_ + half * slope_with_state_;
    const Eigen::Vector3d upper_lean = cov_with_lean_ + half * slope_with_lean_;
    const Eigen::Matrix3d upper_slope =
        upper * rows.transpose() + upper_lean * slope.col(0).transpose();
    cov_ += half * PlusTransposed(cov_with_slope_ + upper_slope) +
            half * half * (cov_slope_ + cov_slope);
    cov_with_slope_ = upper_slope + half * cov_slope;
    cov_with_state_ = upper + half * rows_cov;
    cov_with_lean_ = upper_lean + half * lean_variance_ * slope.col(0);
  }
  md_ = station.along.md;
  cov_slope_ = cov_slope;
  slope_with_state_ = rows_cov;
  slope_with_lean_ = lean_variance_ * slope.col(0);

  const double sigma = std::max(depth_sigma_, station.along.sigma_md);
  const Eigen::Vector3d tangent = Tangent(inclination, azimuth);
  return cov_ + sigma * sigma * tangent * tangent.transpose();
}

std::vector<Eigen::Matrix3d> CovarianceAlongHole(std::span<const StationState> in_depth_order,
                                                 TimeAlongHole order,
                                                 const Eigen::Matrix3d& cov_tie_in,
                                                 double depth_sigma) {
  AlongHoleCovariance along(cov_tie_in, depth_sigma, order);
  std::vector<Eigen::Matrix3d> covariances;
  covariances.reserve(in_depth_order.size());
  for (const StationState& station : in_depth_order) covariances.push_back(along.Add(station));
  return covariances;
}

}  // namespace wellgyro
