#pragma once

#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/fit/tool_adjust_internal.h"

namespace wellgyro {

/// Places of a bundle's coefficients in x, where `kept` are the bundles that x holds, in order.
std::vector<Eigen::Index> PlacesIn(const std::vector<TermBundle>& bundles,
                                   const std::vector<int>& kept, int bundle);

/// Which of the bundles that are seen are kept, by the adjustment of all of them: its coefficients
/// theta of covariance C, where a kept bundle's have a prior of zero mean and one variance, found
/// from them, and the others are zero. Twice the evidence's logarithm, but for what all choices
/// share (theta ~ N(0, C + P), W = C^-1, h = W theta, P of the kept alone):
///   c' (I + M)^-1 c - ln det(I + M),   M = P^1/2 W P^1/2,   c = P^1/2 h
class TermChoice {
 public:
  TermChoice(const std::vector<TermBundle>& bundles, const std::vector<int>& seen,
             const ToolAdjustment& full);

  /// Backward elimination from all that is seen, then exchanges as long as they lower the cost: a
  /// bundle that went is put back, and elimination goes on beside it. Elimination alone is greedy:
  /// of nearly collinear bundles chance decides which goes first. A loop and a bend of drift, two
  /// bundles, can so stay in place of heating, which is one.
  std::vector<int> Best() const;

  /// Alternatives to `best`, as sentences: sets that lack one of its bundles and have others
  /// instead, with an evidence of at least a thousandth of its.
  std::vector<std::string> Rivals(const std::vector<int>& best) const;

 private:
  const TermBundle& At(int place) const { return bundles_[static_cast<std::size_t>(place)]; }
  std::string NamesOf(const std::vector<int>& places, const std::vector<int>& others) const;
  std::vector<int> WithBases(int place) const;
  std::vector<int> Joined(const std::vector<int>& kept, const std::vector<int>& more) const;
  std::vector<int> Without(int base) const;
  std::vector<int> Eliminated(std::vector<int> kept, const std::vector<int>& held) const;
  Eigen::VectorXd PriorSigmas(const std::vector<int>& kept, const Eigen::VectorXd& theta) const;
  double Cost(const std::vector<int>& kept) const;

  const std::vector<TermBundle>& bundles_;
  const std::vector<int>& seen_;
  std::map<int, std::vector<Eigen::Index>> free_;  ///< places in theta, by bundle
  Eigen::VectorXd sigma_, h_;                      ///< theta's unit; W theta
  Eigen::MatrixXd W_;
};

}  // namespace wellgyro
