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
  bool free = false;   ///< the frequency is not 1
};

/// The wave through `errors` at `angles` [rad], of the rows `lines`.
Result<Wave> FitWave(const Eigen::VectorXd& angles, const Eigen::VectorXd& errors,
                     const std::vector<int>& lines, bool free_frequency);

}  // namespace wellgyro
