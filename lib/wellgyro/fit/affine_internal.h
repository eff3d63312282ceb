#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/fit/least_squares_internal.h"

namespace wellgyro {

enum class SecondOrder {
  kNone,
  kOwn,   ///< of each channel's own axis
  kFull,  ///< squares and products
};

/// Readings v = b + S u + K q(u) of three channels at known u. Parameters: b (3), S (9), K (3, 18
/// or none).
struct AffineReadings {
  std::string suffix;  ///< of the parameters' names: S_G, b_G, K2_G
  std::vector<std::string> channels;
  Eigen::MatrixX3d u, v;        ///< a row a position
  std::optional<double> sigma;  ///< of a reading [unit of v]
  /// S du/dI: by how much a reading changes with the zero of the stand's inclination [unit of v per
  /// deg]; empty where that is taken as known.
  Eigen::MatrixX3d by_zero;
  SecondOrder order = SecondOrder::kNone;

  int size() const {
    return order == SecondOrder::kNone ? 12 : order == SecondOrder::kOwn ? 15 : 30;
  }
};

/// One problem over all groups, their parameters one behind the other, and where they have
/// `by_zero` behind these `inclination_deg`, by how much more than stated the stand is inclined,
/// about zero. A position's attitude may be off by three small angles of `tilt_sigma` [rad] each,
/// the same for all groups: they are marginalised, which to first order is what estimating them
/// with that prior gives.
LinearProblem AffineProblem(const std::vector<AffineReadings>& groups,
                            const std::vector<int>& lines, double tilt_sigma);

}  // namespace wellgyro
