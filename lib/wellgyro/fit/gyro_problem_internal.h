#pragma once

#include "wellgyro/fit/gyro_fit.h"
#include "wellgyro/fit/gyro_readings_internal.h"
#include "wellgyro/fit/least_squares_internal.h"

namespace wellgyro {

/// Where the parameters of gyros on a bench stand: for every channel b and U (3); then the force's
/// terms; then N; then the north offset.
struct GyroLayout {
  GyroForceModel force = GyroForceModel::kFull;
  bool aniso = false;  ///< N, of input and spin axis at once: one a channel
  bool north = false;  ///< the fixture's offset [rad]
  int channels = 0, rotors = 0;

  /// M and Q of each rotor, or G (3) of each channel.
  int force_first() const { return 4 * channels; }
  int force_size() const {
    if (force == GyroForceModel::kNone) return 0;
    return force == GyroForceModel::kFull ? 3 * channels : 2 * rotors;
  }
  int aniso_first() const { return force_first() + force_size(); }
  int north_first() const { return aniso_first() + (aniso ? channels : 0); }
  int size() const { return north_first() + (north ? 1 : 0); }
};

/// By the channels that were read and what is asked for. The dual-axis force model brings the
/// anisoelastic terms with it.
GyroLayout LayoutOf(const GyroReadings& readings, const GyroFitSetup& setup);

struct FittedGyros {
  LinearProblem problem;  ///< about the last U and north offset; table rows have lines below 0
  LinearSolution solution;
};

/// Least squares, bilinear in U and the north offset. A joined rate table counts by its own scatter
/// where no sigma of it is given, from Helmert's variance components.
FittedGyros FitLayout(const GyroReadings& readings, const GyroFitSetup& setup,
                      const GyroLayout& layout);

}  // namespace wellgyro
