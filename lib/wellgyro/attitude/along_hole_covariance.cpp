#include "wellgyro/attitude/along_hole_covariance.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/Eigenvalues>

#include "wellgyro/math/rotation.h"

namespace wellgyro {
namespace {

// Eigenvalues of a correlation matrix below this are rounding of zero, of states that determine
// each other or are known: n eps |C| <= n^2 eps = 2.6e-12 at n = kStationErrorsMax, four times
// that.
constexpr double kSingular = 1e-11;

using StationVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kStationErrorsMax, 1>;

Eigen::Matrix3d PlusTransposed(const Eigen::Matrix3d& m) { return m + m.transpose(); }

}  // namespace

StationMatrix SolveCovariance(const StationMatrix& cov, const StationMatrix& cross) {
  const StationVector scale =
      cov.diagonal().unaryExpr([](double v) { return v > 0 ? 1 / std::sqrt(v) : 0.0; });
  const StationMatrix correlation = scale.asDiagonal() * cov * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<StationMatrix> eigen(correlation);
  const StationVector inverse =
      eigen.eigenvalues().unaryExpr([](double v) { return v > kSingular ? 1 / v : 0.0; });
  const StationMatrix& v = eigen.eigenvectors();
  return scale.asDiagonal() * v * inverse.asDiagonal() * v.transpose() * scale.asDiagonal() * cross;
}

AlongHoleCovariance::AlongHoleCovariance(const Eigen::Matrix3d& cov_tie_in_W, double depth_sigma,
                                         TimeAlongHole order)
    : order_(order), depth_sigma_(depth_sigma), cov_W_(cov_tie_in_W) {}

// Carries the two covariances with the state from the station last seen to this one.
void AlongHoleCovariance::Advance(const StationState& station) {
  const bool with_depth = order_ == TimeAlongHole::kWithDepth;
  const StationMatrix link =
      with_depth ? StationMatrix(station.cov_with_previous) : state_cov_with_previous_;
  if (link.size() == 0) {
    cov_with_state_ = Rows::Zero(3, station.cov.rows());
    slope_with_state_ = Rows::Zero(3, station.cov.rows());
    return;
  }
  if (with_depth ? station.knot <= knot_ : station.knot >= knot_) {
    throw std::invalid_argument("AlongHoleCovariance: knot " + std::to_string(station.knot) +
                                " comes after knot " + std::to_string(knot_));
  }
  const auto here = station.cov.rows(), last = state_cov_.rows();
  if (link.rows() != (with_depth ? last : here) || link.cols() != (with_depth ? here : last)) {
    throw std::invalid_argument("AlongHoleCovariance: knot " + std::to_string(station.knot) +
                                " is not linked to knot " + std::to_string(knot_));
  }
  const StationMatrix cross = with_depth ? link : StationMatrix(link.transpose());
  const StationMatrix carry = SolveCovariance(state_cov_, cross);
  cov_with_state_ = (cov_with_state_ * carry).eval();
  slope_with_state_ = (slope_with_state_ * carry).eval();
}

void AlongHoleCovariance::Skip(const StationState& station) {
  if (any_) Advance(station);
  knot_ = station.knot;
  state_cov_ = station.cov;
  state_cov_with_previous_ = station.cov_with_previous;
}

Eigen::Matrix3d AlongHoleCovariance::Add(const StationState& station) {
  Rows by_x = Rows::Zero(3, station.cov.rows());
  by_x.leftCols<3>() = station.tangent_by_phi_L;
  const Rows rows_cov = by_x * station.cov;
  const Eigen::Matrix3d cov_slope_W = rows_cov * by_x.transpose();
  const bool first = !any_;
  if (!first && !(station.along.md > md_)) {
    throw std::invalid_argument("AlongHoleCovariance: depth " + std::to_string(station.along.md) +
                                " m is not below " + std::to_string(md_) + " m");
  }
  Skip(station);
  if (first) {
    any_ = true;
    cov_with_slope_W_.setZero();
    cov_with_state_ = Rows::Zero(3, station.cov.rows());
  } else {
    // r' = (r + half s) + half s'
    const double half = (station.along.md - md_) / 2;
    const Rows upper = cov_with_state_ + half * slope_with_state_;
    const Eigen::Matrix3d upper_slope = upper * by_x.transpose();
    cov_W_ += half * PlusTransposed(cov_with_slope_W_ + upper_slope) +
              half * half * (cov_slope_W_ + cov_slope_W);
    cov_with_slope_W_ = upper_slope + half * cov_slope_W;
    cov_with_state_ = upper + half * rows_cov;
  }
  md_ = station.along.md;
  cov_slope_W_ = cov_slope_W;
  slope_with_state_ = rows_cov;

  const double sigma = std::max(depth_sigma_, station.along.sigma_md);
  const Eigen::Vector3d tangent = Tangent(station.attitude.inclination, station.attitude.azimuth);
  return cov_W_ + sigma * sigma * tangent * tangent.transpose();
}

}  // namespace wellgyro
