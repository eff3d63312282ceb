#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <Eigen/Dense>

#include "wellgyro/fit/tool_choice_internal.h"
#include "wellgyro/fit/tool_left_out_internal.h"
#include "wellgyro/math/linear_algebra.h"

namespace wellgyro {
namespace {

/// Root of the probability that a bundle is there, by its Bayes factor against none: with priors s
/// of its coefficients, information W and W theta = h of the readings,
///   ln B = (h' P h - ln det(1 + S W S)) / 2,   P = (W + S^-2)^-1,  S = diag s.
Eigen::VectorXd RootOdds(const std::vector<int>& bundle_of, const Eigen::MatrixXd& W,
                         const Eigen::VectorXd& h, const Eigen::VectorXd& s) {
  Eigen::VectorXd root(h.size());
  for (std::size_t begin = 0, end = 0; begin < bundle_of.size(); begin = end) {
    while (end < bundle_of.size() && bundle_of[end] == bundle_of[begin]) ++end;
    const auto at = static_cast<Eigen::Index>(begin), n = static_cast<Eigen::Index>(end - begin);
    const auto S = s.segment(at, n).asDiagonal();
    const Cholesky M(Eigen::MatrixXd::Identity(n, n) +
                     S * Eigen::MatrixXd(W.block(at, at, n, n)) * S);
    const Eigen::VectorXd c = S * h.segment(at, n);
    const double log_odds = (M.Whitened(c).squaredNorm() - M.LogDeterminant()) / 2;
    root.segment(at, n).setConstant(std::sqrt(1 / (1 + std::exp(-log_odds))));
  }
  return root;
}

}  // namespace

LeftOutErrors LeftOutErrorsOf(const std::vector<TermBundle>& bundles, const std::vector<int>& seen,
                              const std::vector<int>& kept, const ToolAdjustment& full) {
  LeftOutErrors left;
  std::vector<Eigen::Index> k, l;
  std::vector<int> bundle_of;
  Eigen::Index terms = 0;
  for (const int place : seen) {
    const TermBundle& bundle = bundles[static_cast<std::size_t>(place)];
    const bool is_kept = std::count(kept.begin(), kept.end(), place) > 0;
    for (std::size_t i = 0; i < bundle.terms.size(); ++i) (is_kept ? k : l).push_back(terms++);
    if (is_kept) continue;
    left.terms.insert(left.terms.end(), bundle.terms.begin(), bundle.terms.end());
    bundle_of.insert(bundle_of.end(), bundle.terms.size(), place);
  }
  // Of the bench all is kept.
  for (Eigen::Index i = terms; i < full.x.size(); ++i) k.push_back(i);
  const auto m = static_cast<Eigen::Index>(k.size()), n = static_cast<Eigen::Index>(l.size());
  left.cov = Eigen::MatrixXd::Zero(m + n, m + n);
  if (n == 0) return left;
  const Eigen::MatrixXd& A = full.linear.A;
  const Eigen::VectorXd unit = A.colwise().norm().transpose().cwiseMax(1e-300).cwiseInverse();
  const Eigen::MatrixXd scaled = A * unit.asDiagonal();
  const Eigen::MatrixXd N = scaled.transpose() * scaled;
  const Eigen::MatrixXd K = SolveSymmetric(N(k, k), N(k, l));
  const Eigen::VectorXd s = full.cov.diagonal()(l).cwiseSqrt().cwiseQuotient(unit(l));
  const Eigen::MatrixXd W = N(l, l) - N(l, k) * K;
  Eigen::MatrixXd whole = W;
  whole.diagonal() += s.cwiseAbs2().cwiseInverse();
  const Eigen::MatrixXd P = InverseOfSymmetric(whole);
  const Eigen::VectorXd h = W * full.x(l).cwiseQuotient(unit(l)), mean = P * h;
  const Eigen::VectorXd root = RootOdds(bundle_of, W, h, s);
  Eigen::MatrixXd errors(m + n, n);
  errors << unit(k).asDiagonal() * K, -Eigen::MatrixXd(unit(l).asDiagonal());
  errors = (errors * root.asDiagonal()).eval();
  left.cov = errors * (P + mean * mean.transpose()) * errors.transpose();
  return left;
}

}  // namespace wellgyro
