#include <algorithm>
#include <cmath>
#include <set>

#include <Eigen/Core>

#include "wellgyro/fit/added_terms_internal.h"
#include "wellgyro/math/linear_algebra.h"
#include "wellgyro/math/statistics.h"

namespace wellgyro {
namespace {

// What the model holds already cannot be tested, nor what it holds but for a thousandth: the noise
// of its own columns makes such a remainder, as where temperatures rise from row to row.
constexpr double kHeld = 1e-3;

}  // namespace

AddedTerms::AddedTerms(const LinearProblem& problem, const LinearSolution& solution)
    : problem_(problem), solution_(solution) {
  const std::set<int> out(solution.outlier_lines.begin(), solution.outlier_lines.end());
  for (std::size_t i = 0; i < problem.rows.size(); ++i) {
    place_.push_back(static_cast<Eigen::Index>(used_.size()));
    if (out.count(problem.rows[i].line) == 0) used_.push_back(static_cast<Eigen::Index>(i));
  }
  A_ = problem.sigma(used_).cwiseInverse().asDiagonal() * problem.A(used_, Eigen::all);
}

double AddedTerms::Variance() const {
  return problem_.sigma_given ? 1 : solution_.chi_square / static_cast<double>(solution_.dof);
}

ReadingUnit AddedTerms::UnitOf(std::size_t row) const {
  const FitRow& label = problem_.rows[row];
  if (label.spread.size() == 0) {
    return {place_[row], Eigen::VectorXd::Constant(1, 1 / label.unit)};
  }
  // All rows of a line are used, or none.
  std::size_t first = row;
  while (first > 0 && problem_.rows[first - 1].line == label.line) --first;
  return {place_[first], label.spread};
}

std::size_t AddedTerms::LikeliestStep(const std::vector<ReadingUnit>& readings) const {
  const double variance = Variance();
  if (solution_.cov.size() == 0 || !(variance > 0)) return 0;
  Eigen::VectorXd h = Eigen::VectorXd::Zero(problem_.size());
  double zz = 0, zr = 0, most = 0;
  std::size_t first = 0;
  for (std::size_t k = readings.size(); k-- > kBesideStep;) {
    const ReadingUnit& unit = readings[k];
    h += A_.middleRows(unit.first, unit.z.size()).transpose() * unit.z;
    zz += unit.z.squaredNorm();
    zr += unit.z.dot(solution_.residual.segment(unit.first, unit.z.size()));
    if (readings.size() - k < kBesideStep) continue;
    const double left = zz - h.dot(solution_.cov * h) / variance;
    if (!(left > kHeld * zz) || !(zr * zr / left > most)) continue;
    most = zr * zr / left;
    first = k;
  }
  return first;
}

Eigen::MatrixXd AddedTerms::WhitenedColumns(const Eigen::MatrixXd& Z) const {
  Eigen::MatrixXd z = Eigen::MatrixXd::Zero(A_.rows(), Z.cols());
  for (const Eigen::Index row : used_) {
    if (Z.row(row).isZero(0)) continue;
    const ReadingUnit unit = UnitOf(static_cast<std::size_t>(row));
    z.middleRows(unit.first, unit.z.size()) += unit.z * Z.row(row);
  }
  return z;
}

std::vector<AddedTerm> AddedTerms::Test(const Eigen::MatrixXd& Z, double probability) const {
  return TestWhitened(WhitenedColumns(Z), probability);
}

std::vector<AddedTerm> AddedTerms::TestWhitened(const Eigen::MatrixXd& z,
                                                double probability) const {
  std::vector<AddedTerm> terms(static_cast<std::size_t>(z.cols()));
  if (solution_.dof < 1 || solution_.cov.size() == 0) return terms;
  const double variance = Variance();
  if (!(variance > 0)) return terms;
  // r is at right angles to the model's columns, so that z'r needs no projection; z'z does.
  const Eigen::MatrixXd moves = solution_.cov / variance * (A_.transpose() * z);
  const Eigen::MatrixXd left = z.transpose() * z - z.transpose() * A_ * moves;
  std::vector<Eigen::Index> seen;
  for (Eigen::Index i = 0; i < z.cols(); ++i) {
    if (left(i, i) > kHeld * z.col(i).squaredNorm()) seen.push_back(i);
  }
  const double dof = solution_.dof - static_cast<double>(seen.size());
  if (seen.empty() || dof < 1) return terms;
  const Eigen::VectorXd zr = (z.transpose() * solution_.residual)(seen);
  const Eigen::MatrixXd cov = InverseOfSymmetric(left(seen, seen));
  const Eigen::VectorXd beta = cov * zr;
  const double freed = std::max(solution_.chi_square - zr.dot(beta), 0.0);
  const double found = std::sqrt(freed / dof),
               scatter = problem_.sigma_given ? std::max(1.0, found) : found;
  const Eigen::VectorXd sigma = solution_.cov.diagonal().cwiseMax(0).cwiseSqrt();
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    AddedTerm& term = terms[static_cast<std::size_t>(seen[k])];
    term.coefficient = beta[at];
    term.sigma = scatter * std::sqrt(std::max(0.0, cov(at, at)));
    term.sigmas = term.sigma > 0 ? std::abs(beta[at]) / term.sigma : 0;
    term.limit =
        problem_.sigma_given ? -NormalQuantile(probability) : StudentLimit(probability, dof);
    for (Eigen::Index i = 0; i < sigma.size(); ++i) {
      const double moved = sigma[i] > 0 ? std::abs(beta[at] * moves(i, seen[k])) / sigma[i] : 0;
      if (moved <= term.moved_sigmas) continue;
      term.moved_sigmas = moved;
      term.moved = problem_.parameters[static_cast<std::size_t>(i)];
    }
  }
  return terms;
}

}  // namespace wellgyro
