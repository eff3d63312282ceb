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

/// Of n coefficients that are there, of which Q = theta' W theta is found: mean and variance of the
/// share k by which noise hides them, whose density is that of chi-square of n + 2 degrees at k Q,
/// cut at k = 1; and ln of the Bayes factor against none, of the integral of
/// k^(n/2) exp((1 - k) Q / 2).
struct HiddenShare {
  double mean = 0, variance = 0, ln_bayes = 0;
};
HiddenShare ShareHidden(double n, double Q) {
  // With less the cut density is k^(n/2) to 1e-9.
  constexpr double kNothing = 1e-9;
  if (Q < kNothing) {
    const double mean = (n + 2) / (n + 4);
    return {mean, (n + 2) / (n + 6) - mean * mean, std::log(2 / (n + 2))};
  }
  const double all = ChiSquareCdf(Q, n + 2), a = n / 2 + 1;
  const double mean = (n + 2) / Q * ChiSquareCdf(Q, n + 4) / all;
  const double square = (n + 2) * (n + 4) / (Q * Q) * ChiSquareCdf(Q, n + 6) / all;
  return {mean, std::max(0.0, square - mean * mean),
          Q / 2 + a * std::log(2 / Q) + std::lgamma(a) + std::log(all)};
}

/// What the readings leave of a bundle's coefficients.
struct BundleLeft {
  double there = 0;      ///< probability, of even odds before
  Eigen::VectorXd mean;  ///< if it is there
  Eigen::MatrixXd cov;
};
BundleLeft LeftOf(const Eigen::MatrixXd& W, const Eigen::VectorXd& h) {
  const Eigen::MatrixXd cov = InverseOfSymmetric(W);
  const Eigen::VectorXd theta = cov * h;
  const HiddenShare k = ShareHidden(static_cast<double>(h.size()), theta.dot(h));
  return {1 / (1 + std::exp(-k.ln_bayes)), (1 - k.mean) * theta,
          (1 - k.mean) * cov + k.variance * theta * theta.transpose()};
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
