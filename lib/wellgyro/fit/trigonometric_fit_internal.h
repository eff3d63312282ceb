#pragma once

#include <array>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/result.h"

namespace wellgyro {

/// One channel of the trigonometric model: x1 sin(x2 angle + x3) + x4.
struct Wave {
  std::array<double, 4> x{};
  Eigen::Vector4d sigma = Eigen::Vector4d::Zero();
  double scatter = 0;  ///< of the errors about the wave
  bool free = false;   ///< the frequency is not held at 1
  bool told = false;   ///< the errors tell it from 1 (F test, 1 %)
};

/// The wave through `errors` at `angles` [rad], of the rows `lines`. A frequency that was to be
/// found and cannot be told from 1 is held there, and what it may be is in all sigmas; so it is
/// where it was not to be found and can be told.
Result<Wave> FitWave(const Eigen::VectorXd& angles, const Eigen::VectorXd& errors,
                     const std::vector<int>& lines, bool free_frequency);

}  // namespace wellgyro
