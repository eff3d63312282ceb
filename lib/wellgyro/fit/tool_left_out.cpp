#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Dense>

#include "wellgyro/fit/tool_choice_internal.h"
#include "wellgyro/fit/tool_left_out_internal.h"
#include "wellgyro/math/linear_algebra.h"

namespace wellgyro {
namespace {

/// What the readings leave of a bundle's coefficients.
struct BundleLeft {
  double there = 0;      ///< probability
  Eigen::VectorXd mean;  ///< if it is there
  Eigen::MatrixXd cov;
};

/// By its Bayes factor against none: with priors s of its coefficients, information W and
/// W theta = h of the readings,
///   ln B = (h' P h - ln det(1 + S W S)) / 2,   P = (W + S^-2)^-1,  S = diag s.
BundleLeft LeftOf(const Eigen::MatrixXd& W, const Eigen::VectorXd& h) {
  const Eigen::VectorXd s = InverseOfSymmetric(W).diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(h.size(), h.size());
  const Cholesky M(one + s.asDiagonal() * W * s.asDiagonal());
  const Eigen::VectorXd c = s.cwiseProduct(h);
  const double log_odds = (M.Whitened(c).squaredNorm() - M.LogDeterminant()) / 2;
  const Eigen::MatrixXd cov = s.asDiagonal() * M.Solve(one) * s.asDiagonal();
  return {1 / (1 + std::exp(-log_odds)), cov * h, cov};
}

}  // namespace

LeftOutErrors LeftOutErrorsOf(const std::vector<TermBundle>& bundles, const std::vector<int>& seen,
                              const std::vector<int>& kept, const ToolAdjustment& full) {
  LeftOutErrors left;
  std::vector<Eigen::Index> k, l, sizes;
  Eigen::Index terms = 0;
  for (const int place : seen) {
    const TermBundle& bundle = bundles[static_cast<std::size_t>(place)];
    const bool is_kept = std::count(kept.begin(), kept.end(), place) > 0;
    for (std::size_t i = 0; i < bundle.terms.size(); ++i) (is_kept ? k : l).push_back(terms++);
    if (is_kept) continue;
    left.terms.insert(left.terms.end(), bundle.terms.begin(), bundle.terms.end());
    sizes.push_back(static_cast<Eigen::Index>(bundle.terms.size()));
  }
  // Of the bench all is kept.
  for (Eigen::Index i = terms; i < full.x.size(); ++i) k.push_back(i);
  const auto m = static_cast<Eigen::Index>(k.size()), n = static_cast<Eigen::Index>(l.size());
  left.shift = Eigen::VectorXd::Zero(m + n);
  left.cov = Eigen::MatrixXd::Zero(m + n, m + n);
  if (n == 0) return left;
  const Eigen::MatrixXd& A = full.linear.A;
  const Eigen::VectorXd unit = A.colwise().norm().transpose().cwiseMax(1e-300).cwiseInverse();
  const Eigen::MatrixXd scaled = A * unit.asDiagonal();
  const Eigen::MatrixXd N = scaled.transpose() * scaled;
  const Eigen::MatrixXd K = SolveSymmetric(N(k, k), N(k, l));
  const Eigen::MatrixXd W = N(l, l) - N(l, k) * K;
  const Eigen::VectorXd h = W * full.x(l).cwiseQuotient(unit(l));
  Eigen::VectorXd mean(n);
  Eigen::MatrixXd in_kept = Eigen::MatrixXd::Zero(n, n), beyond = in_kept;
  Eigen::Index at = 0;
  for (const Eigen::Index size : sizes) {
    const BundleLeft b = LeftOf(W.block(at, at, size, size), h.segment(at, size));
    mean.segment(at, size) = b.there * b.mean;
    in_kept.block(at, at, size, size) =
        b.there * (b.cov + (1 - b.there) * b.mean * b.mean.transpose());
    beyond.block(at, at, size, size) = (1 - b.there) * b.cov;
    at += size;
  }
  Eigen::MatrixXd errors(m + n, n);
  errors << unit(k).asDiagonal() * K, -Eigen::MatrixXd(unit(l).asDiagonal());
  left.shift = -errors * mean;
  left.cov = errors * in_kept * errors.transpose();
  left.cov.bottomRightCorner(n, n) += unit(l).asDiagonal() * beyond * unit(l).asDiagonal();
  return left;
}

}  // namespace wellgyro
