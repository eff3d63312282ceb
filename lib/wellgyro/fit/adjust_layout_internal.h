#pragma once

#include <array>

#include <Eigen/Core>

#include "wellgyro/attitude/filter.h"
#include "wellgyro/record/knot.h"

namespace wellgyro {

/// Where the unknowns of a run's adjustment stand; -1 where the prior is zero. A node is an instant
/// of the run, the common unknowns are the tool's constant errors.
struct AdjustLayout {
  enum NodePlace { kAzimuth, kInclination, kDrift };
  static constexpr int kNodeMax = 6;
  static constexpr int kCommonMax = 20;

  struct Axis {
    int level = -1, markov = -1;              ///< in a node
    int level_common = -1, ramp_common = -1;  ///< among the common unknowns
  };
  std::array<Axis, 2> axis;
  std::array<int, Knot::kSources> source;  ///< among the common; -1 for the two gyro biases
  int latitude = -1;
  int lie_azimuth = -1, lie_inclination = -1;  ///< what passes differ by [rad]
  int node = 2;                                ///< unknowns of a node
  int common = 0;                              ///< at least 1: a dummy where there is no error
  bool dummy = false;

  Eigen::VectorXd sigma_common;  ///< priors
  double level_sigma = 0;        ///< prior of a level in a node [rad/s]
  double level_walk = 0;         ///< [rad/s/sqrt(s)]
  double markov_sigma = 0;       ///< [rad/s]
  double markov_seconds = 1;     ///< [s]

  int drift() const { return node - kDrift; }
  int state() const { return node + (dummy ? 0 : common); }  ///< of a StationState
};

/// `sigma_lie` > 0 and `repeats`: depths were passed more than once.
AdjustLayout AdjustLayoutOf(const FilterSetup& setup, double sigma_lie, bool repeats);

}  // namespace wellgyro
