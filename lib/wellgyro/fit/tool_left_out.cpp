#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Dense>

#include "wellgyro/fit/tool_choice_internal.h"
#include "wellgyro/fit/tool_left_out_internal.h"
#include "wellgyro/math/linear_algebra.h"
#include "wellgyro/math/statistics.h"

namespace wellgyro {
namespace {

/// Mean and variance of the share k by which noise hides n coefficients, of which Q = theta' W
/// theta is found: its density is that of chi-square of n + 2 degrees at k Q, cut at k = 1.
struct HiddenShare {
  double mean = 0, variance = 0;
};
HiddenShare ShareHidden(double n, double Q) {
  // With less the cut density is k^(n/2) to 1e-9.
  constexpr double kNothing = 1e-9;
  if (Q < kNothing) {
    const double mean = (n + 2) / (n + 4);
    return {mean, (n + 2) / (n + 6) - mean * mean};
  }
  const double all = ChiSquareCdf(Q, n + 2);
  const double mean = (n + 2) / Q * ChiSquareCdf(Q, n + 4) / all;
  const double square = (n + 2) * (n + 4) / (Q * Q) * ChiSquareCdf(Q, n + 6) / all;
  return {mean, std::max(0.0, square - mean * mean)};
}

/// What the readings leave of a bundle's coefficients.
struct BundleLeft {
  Eigen::VectorXd mean;
  Eigen::MatrixXd cov;
};
BundleLeft LeftOf(const Eigen::MatrixXd& W, const Eigen::VectorXd& h) {
  const Eigen::MatrixXd cov = InverseOfSymmetric(W);
  const Eigen::VectorXd theta = cov * h;
  const HiddenShare k = ShareHidden(static_cast<double>(h.size()), theta.dot(h));
  return {(1 - k.mean) * theta, (1 - k.mean) * cov + k.variance * theta * theta.transpose()};
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
  Eigen::MatrixXd cov = Eigen::MatrixXd::Zero(n, n);
  Eigen::Index at = 0;
  for (const Eigen::Index size : sizes) {
    const BundleLeft b = LeftOf(W.block(at, at, size, size), h.segment(at, size));
    mean.segment(at, size) = b.mean;
    cov.block(at, at, size, size) = b.cov;
    at += size;
  }
  Eigen::MatrixXd errors(m + n, n);
  errors << unit(k).asDiagonal() * K, -Eigen::MatrixXd(unit(l).asDiagonal());
  left.shift = -errors * mean;
  left.cov = errors * cov * errors.transpose();
  return left;
}

}  // namespace wellgyro
