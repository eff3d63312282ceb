#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/estimate/diagnosis.h"
#include "wellgyro/estimate/normal_block.h"

namespace wellgyro {

/// Bayes factor of excess noise in rows of one kind: variance 1 + tau^2 of each whitened row.
///
/// With l, e the eigenvalues and eigenvectors of P of a factor's rows, u = e'P r / sqrt(l) has the
/// variance 1 + tau^2 l, and
///   ln B = sum of u^2 tau^2 l / (2 (1 + tau^2 l)) - ln(1 + tau^2 l) / 2,
/// averaged over a grid of tau. Correlations of residuals between knots are neglected. Where the
/// unknowns absorb most of a row (l below 0.3) that would overstate ln B: such parts are left out.
class Scatter {
 public:
  /// `stretch`: knots that are looked at together.
  explicit Scatter(std::size_t stretch) : stretch_(stretch) {}

  /// Rows P r of knot `k`, in any order of knots, and P of them, in no frame.
  void Add(std::size_t k, const Factor& f, const Eigen::Matrix3d& freedom);
  /// Of every stretch the squares of its rows, as far as the unknowns leave them.
  std::vector<ResidualSum> Residuals() const;
  /// ln B of every stretch, and of all rows.
  std::vector<double> Stretches() const;
  /// Fills in the test of more noise all the while; its size is the factor of the noise.
  void TestAll(CauseTest& test) const;

 private:
  static constexpr std::size_t kGrid = 12;
  struct Sum {
    std::array<double, kGrid> ln_bayes{};
    ResidualSum residuals;
  };
  static double Mean(const Sum& sum);

  std::size_t stretch_;
  std::vector<Sum> stretches_;
  Sum all_;  ///< on a grid of noise that is a little more
};

}  // namespace wellgyro
