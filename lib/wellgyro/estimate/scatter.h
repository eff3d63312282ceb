#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/estimate/diagnosis.h"
#include "wellgyro/estimate/normal_block.h"

namespace wellgyro {

/// Whether rows of one kind scatter more than they should, by a random disturbance of variance
/// tau^2 of each whitened row.
///
/// P of a factor's rows has eigenvalues l and vectors e; u = e'P r / sqrt(l) is then of variance
/// 1 + tau^2 l, and ln B the sum of u^2 tau^2 l / (2 (1 + tau^2 l)) - ln(1 + tau^2 l) / 2, averaged
/// over a grid of tau. What the unknowns link between knots is left out, and with it the parts of
/// rows that they mostly absorb (l below 0.3), of which it would make too much.
class Scatter {
 public:
  /// `stretch`: knots that are looked at together.
  explicit Scatter(std::size_t stretch) : stretch_(stretch) {}

  /// Rows P r of knot `k`, in any order of knots, and P of them.
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
