#include "wellgyro/estimate/scatter.h"

#include <cmath>

#include <Eigen/Eigenvalues>

namespace wellgyro {
namespace {

// Least redundancy l, of a row, for its residual to count: its information on tau^2 goes as l^2, of
// what is left out less than 9 % of that of a row with l = 1.
constexpr double kOwn = 0.3;
// tau^2, in the variances that rows should have: of a sensor that is out of its class, up to five
// times its noise by steps of 1.5, and of bursts, by every second of these and on to shocks. What
// is noisier all the while thus never fits the bursts' better.
constexpr std::array<double, 12> kNoisier{0.3,  0.45, 0.675, 1.01, 1.52, 2.28,
                                          3.42, 5.13, 7.69,  11.5, 17.3, 25.9};
constexpr std::array<double, 12> kBurst{0.45, 1.01, 2.28, 5.13, 11.5, 25.9,
                                        60,   140,  400,  1000, 3000, 1e4};

}  // namespace

void Scatter::Add(std::size_t k, const Factor& f, const Eigen::Matrix3d& freedom) {
  const std::size_t at = k / stretch_;
  if (stretches_.size() <= at) stretches_.resize(at + 1);
  // Pseudo-measurements, and rows that the factor lacks, measure nothing.
  Eigen::Matrix3d own = Eigen::Matrix3d::Zero();
  own.topLeftCorner(f.measured, f.measured) = freedom.topLeftCorner(f.measured, f.measured);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(own);
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double l = eigen.eigenvalues()[i];
    if (!(l > kOwn)) continue;
    const double along = eigen.eigenvectors().col(i).head(f.measured).dot(f.r.head(f.measured));
    const double square = along * along / l;
    for (Sum* sum : {&stretches_[at], &all_}) {
      const std::array<double, kGrid>& grid = sum == &all_ ? kNoisier : kBurst;
      for (std::size_t g = 0; g < kGrid; ++g) {
        const double x = grid[g] * l;
        sum->ln_bayes[g] += 0.5 * (square * x / (1 + x) - std::log1p(x));
      }
      sum->residuals.squares += square;
      sum->residuals.count += 1;
    }
  }
}

double Scatter::Mean(const Sum& sum) {
  double most = -HUGE_VAL, mean = 0;
  for (const double x : sum.ln_bayes) most = std::max(most, x);
  for (const double x : sum.ln_bayes) mean += std::exp(x - most) / kGrid;
  return most + std::log(mean);
}

std::vector<ResidualSum> Scatter::Residuals() const {
  std::vector<ResidualSum> residuals;
  for (const Sum& sum : stretches_) residuals.push_back(sum.residuals);
  return residuals;
}

std::vector<double> Scatter::Stretches() const {
  std::vector<double> ln_bayes;
  Sum all;
  for (const Sum& sum : stretches_) {
    if (sum.residuals.count > 0) ln_bayes.push_back(Mean(sum));
    for (std::size_t g = 0; g < kGrid; ++g) all.ln_bayes[g] += sum.ln_bayes[g];
  }
  if (!ln_bayes.empty()) ln_bayes.push_back(Mean(all));
  return ln_bayes;
}

void Scatter::TestAll(CauseTest& test) const {
  const auto [squares, count] = all_.residuals;
  if (!(count > 0)) return;
  test.tested = test.told = true;
  test.ln_bayes = Mean(all_);
  test.size = std::sqrt(squares / count);
  test.sigma = test.size / std::sqrt(2 * count);
}

}  // namespace wellgyro
