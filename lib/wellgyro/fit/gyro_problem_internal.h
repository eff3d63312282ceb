#pragma once

#include <vector>

#include "wellgyro/fit/gyro_fit.h"
#include "wellgyro/fit/gyro_readings_internal.h"
#include "wellgyro/fit/least_squares_internal.h"

namespace wellgyro {

/// Where the parameters of gyros on a bench stand: for every channel b and U (3); then the force's
/// terms, M and Q of each rotor before G (3) of each channel that is none of a rotor's; then N;
/// then the north offset.
struct GyroLayout {
  bool dual = false;        ///< M and Q of rotors
  std::vector<int> full;    ///< channels that have G
  std::vector<int> paired;  ///< channels of rotors, in order, that have N: of input and spin axis
  bool aniso = false;       ///< N is there
  bool north = false;       ///< the fixture's offset [rad]
  int channels = 0, rotors = 0;

  int force_first() const { return 4 * channels; }
  int full_first() const { return force_first() + (dual ? 2 * rotors : 0); }
  int aniso_first() const { return full_first() + 3 * static_cast<int>(full.size()); }
  int north_first() const { return aniso_first() + (aniso ? static_cast<int>(paired.size()) : 0); }
  int size() const { return north_first() + (north ? 1 : 0); }
};

/// By the channels that were read and what is asked for; M and Q bring the anisoelastic terms.
GyroLayout LayoutOf(const GyroReadings& readings, const GyroFitSetup& setup);

struct FittedGyros {
  LinearProblem problem;  ///< about the last U and north offset; table rows have lines below 0
  LinearSolution solution;
};

/// Least squares, bilinear in U and the north offset. A joined rate table counts by its own scatter
/// where no sigma of it is given, from Helmert's variance components.
FittedGyros FitLayout(const GyroReadings& readings, const GyroFitSetup& setup,
                      const GyroLayout& layout);

/// The problem of other readings of that layout, about U and north offset in x, the table's sigma
/// as in `fitted`.
LinearProblem ProblemAbout(const GyroReadings& readings, const GyroFitSetup& setup,
                           const GyroLayout& layout, const FittedGyros& fitted,
                           const Eigen::VectorXd& x);

}  // namespace wellgyro
