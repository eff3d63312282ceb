#include <algorithm>
#include <utility>

#include <Eigen/Dense>

#include "wellgyro/fit/tool_choice_internal.h"
#include "wellgyro/fit/tool_left_out_internal.h"

namespace wellgyro {

LeftOutErrors LeftOutErrorsOf(const std::vector<TermBundle>& bundles, const std::vector<int>& seen,
                              const std::vector<int>& kept, const ToolAdjustment& full) {
  LeftOutErrors left;
  std::vector<Eigen::Index> k, l;
  Eigen::Index terms = 0;
  for (const int place : seen) {
    const TermBundle& bundle = bundles[static_cast<std::size_t>(place)];
    const bool is_kept = std::count(kept.begin(), kept.end(), place) > 0;
    for (std::size_t i = 0; i < bundle.terms.size(); ++i) (is_kept ? k : l).push_back(terms++);
    if (!is_kept) left.terms.insert(left.terms.end(), bundle.terms.begin(), bundle.terms.end());
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
  const Eigen::MatrixXd K = Eigen::MatrixXd(N(k, k)).ldlt().solve(Eigen::MatrixXd(N(k, l)));
  const Eigen::VectorXd s = full.cov.diagonal()(l).cwiseSqrt().cwiseQuotient(unit(l));
  const Eigen::MatrixXd W = N(l, l) - N(l, k) * K;
  Eigen::MatrixXd whole = W;
  whole.diagonal() += s.cwiseAbs2().cwiseInverse();
  const Eigen::MatrixXd P = whole.ldlt().solve(Eigen::MatrixXd::Identity(n, n));
  const Eigen::VectorXd mean = P * (W * full.x(l).cwiseQuotient(unit(l)));
  Eigen::MatrixXd errors(m + n, n);
  errors << unit(k).asDiagonal() * K, -Eigen::MatrixXd(unit(l).asDiagonal());
  left.cov = errors * (P + mean * mean.transpose()) * errors.transpose();
  return left;
}

}  // namespace wellgyro
