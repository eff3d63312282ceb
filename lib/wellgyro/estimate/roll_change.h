#pragma once

#include <optional>

#include <Eigen/Core>

#include "wellgyro/estimate/layout.h"
#include "wellgyro/estimate/node.h"
#include "wellgyro/estimate/setup.h"

namespace wellgyro {

/// How the roll rate, and its swing, may change over a knot.
struct RollChange {
  double sigma = 0.1, swing_sigma = 0.1;  ///< [rad/s]
  double weight = 0, swing_weight = 0;    ///< robust ones, held; 0: by the residuals
};

/// Sum of squares of what the rate of roll in the hole changes by over a knot, by its sigma, and of
/// its swing.
struct RollSquares {
  double rate = 0, swing = 0;
};
RollSquares RollSquaresOf(std::optional<double> frequency, double seconds, double axial_change,
                          const RollChange& roll, const Node& begin, const Node& end);

/// At which the roll swings, as it now stands [rad/s]; absent: it walks.
std::optional<double> FrequencyOf(const EstimateSetup& setup, const Layout& layout,
                                  const BorderVector& border);

/// What a swing of this frequency is after `seconds`, of what it was: [c s; -s c].
Eigen::Vector2d SwingAfter(double frequency, double seconds, const Eigen::Vector2d& a);
/// d SwingAfter / d frequency.
Eigen::Vector2d SwingByFrequency(double frequency, double seconds, const Eigen::Vector2d& a);

/// What a swing adds to the mean rate of roll over the `seconds` behind it, of its parts in phase
/// and in quadrature: sin wt / wt and (1 - cos wt) / wt.
Eigen::Vector2d MeanOfSwing(double frequency, double seconds);
/// d MeanOfSwing / d frequency [s].
Eigen::Vector2d MeanByFrequency(double frequency, double seconds);

}  // namespace wellgyro
