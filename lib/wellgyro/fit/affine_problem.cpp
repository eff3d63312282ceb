#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "wellgyro/fit/affine_internal.h"
#include "wellgyro/math/linear_algebra.h"
#include "wellgyro/math/so3.h"
#include "wellgyro/record/products.h"

namespace wellgyro {
namespace {

// The three rows of one group at one position.
void Fill(const Eigen::Vector3d& u, SecondOrder order, int first, int row, Eigen::MatrixXd& A) {
  const VectorProducts q = ProductsOf(u);
  for (int c = 0; c < 3; ++c) {
    A(row + c, first + c) = 1;
    A.block<1, 3>(row + c, first + 3 + 3 * c) = u.transpose();
    if (order == SecondOrder::kOwn) A(row + c, first + 12 + c) = u[c] * u[c];
    if (order == SecondOrder::kFull) A.block<1, 6>(row + c, first + 12 + 6 * c) = q.transpose();
  }
}

// Sensitivity by plain least squares, for the weights alone.
Eigen::Matrix3d Rough(const AffineReadings& readings) {
  Eigen::MatrixXd A(readings.u.rows(), 4);
  A << Eigen::VectorXd::Ones(readings.u.rows()), readings.u;
  const Eigen::MatrixXd x = SolveLeastSquares(A, readings.v);
  return x.bottomRows<3>().transpose();
}

std::vector<std::string> Names(const std::vector<AffineReadings>& groups) {
  std::vector<std::string> names;
  for (const AffineReadings& group : groups) {
    Append(names, VectorNames("b_" + group.suffix, 3));
    Append(names, MatrixNames("S_" + group.suffix, 3, 3));
    if (group.order == SecondOrder::kOwn) Append(names, VectorNames("K2_" + group.suffix, 3));
    if (group.order == SecondOrder::kFull) Append(names, MatrixNames("K2_" + group.suffix, 3, 6));
  }
  if (groups.front().by_zero.rows() > 0) names.emplace_back("inclination_deg");
  return names;
}

// Whitens one position's rows by the Cholesky factor of 1 + tilt tilt', in units of their sigmas.
void Whiten(const Eigen::MatrixXd& tilt, int row, LinearProblem& problem) {
  const Eigen::Index width = tilt.rows();
  const Eigen::MatrixXd cov = Eigen::MatrixXd::Identity(width, width) + tilt * tilt.transpose();
  const Eigen::VectorXd weight = problem.sigma.segment(row, width).cwiseInverse();
  const Eigen::MatrixXd whitener = Cholesky(cov).Whitened(Eigen::MatrixXd(weight.asDiagonal()));
  for (Eigen::Index k = 0; k < width; ++k) {
    problem.rows[static_cast<std::size_t>(row + k)].spread = whitener.col(k);
  }
  problem.A.middleRows(row, width) = (whitener * problem.A.middleRows(row, width)).eval();
  problem.y.segment(row, width) = (whitener * problem.y.segment(row, width)).eval();
  problem.sigma.segment(row, width).setOnes();
}

}  // namespace

LinearProblem AffineProblem(const std::vector<AffineReadings>& groups,
                            const std::vector<int>& lines, double tilt_sigma) {
  const int n = static_cast<int>(lines.size()), width = 3 * static_cast<int>(groups.size());
  LinearProblem problem(Names(groups), n * width);
  problem.sigma_given = std::all_of(groups.begin(), groups.end(),
                                    [](const AffineReadings& g) { return g.sigma.has_value(); });
  std::vector<Eigen::Matrix3d> rough;
  rough.reserve(groups.size());
  for (const AffineReadings& group : groups) rough.push_back(Rough(group));
  for (int i = 0; i < n; ++i) {
    Eigen::MatrixXd tilt(width, 3);
    int first = 0;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const int row = i * width + 3 * static_cast<int>(g);
      const Eigen::Vector3d u = groups[g].u.row(i).transpose();
      Fill(u, groups[g].order, first, row, problem.A);
      first += groups[g].size();
      if (groups[g].by_zero.rows() > 0) {
        problem.A.col(problem.size() - 1).segment<3>(row) = groups[g].by_zero.row(i).transpose();
      }
      problem.y.segment<3>(row) = groups[g].v.row(i).transpose();
      const double sigma = groups[g].sigma.value_or(1);
      problem.sigma.segment<3>(row).setConstant(sigma);
      tilt.middleRows<3>(row - i * width) = tilt_sigma / sigma * rough[g] * Skew(u);
      for (int c = 0; c < 3; ++c) {
        const int at = row + c;
        FitRow& label = problem.rows[static_cast<std::size_t>(at)];
        label.line = lines[static_cast<std::size_t>(i)];
        label.channel = groups[g].channels[static_cast<std::size_t>(c)];
        label.unit = sigma;
      }
    }
    if (tilt_sigma > 0) Whiten(tilt, i * width, problem);
  }
  return problem;
}

}  // namespace wellgyro
