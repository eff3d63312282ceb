#pragma once

#include <array>
#include <cstdint>

#include "wellgyro/base/export.h"

namespace wellgyro {

/// Whether a converter cuts its numbers towards zero, in place of rounding or flooring them: the
/// level zero then is as wide as any two others. What it reads is too small by half a step,
/// whatever its sign.
///
/// Wherever a signal passes from below -2 to above 2 levels, or back, the samples in each level are
/// counted. With D0, D1, D2 their mean numbers at 0, at each of +-1 and of +-2, those of a Gaussian
/// of any width follow ln D = a - b k^2, so that
///   ln R = ln D0 - 4/3 ln D1 + 1/3 ln D2
/// is 0 of a rounding converter and ln 2 of a cutting one. Numbers that are no whole steps, as
/// those of a calibrated tool, tell nothing. In the axis' own unit throughout.
class WELLGYRO_EXPORT TruncationWatch {
 public:
  /// The next sample of an axis whose smallest change so far is `step`.
  void Push(double value, double step);

  /// Of two axes of one sensor. `sigma` 0: nothing tells it.
  struct Found {
    double ln_ratio = 0, sigma = 0;
    double step = 0;  ///< the larger of the two
  };
  static Found Of(const TruncationWatch& a, const TruncationWatch& b);

 private:
  void Pass();

  double step_ = 0;
  int side_ = 0;                          ///< on which side of the levels it was last
  std::array<std::int64_t, 3> levels_{};  ///< samples at 0, +-1, +-2 since
  std::int64_t whole_ = 0, broken_ = 0;
  std::array<double, 16> sums_{};  ///< over passages, products of 1 and the samples in each level
};

}  // namespace wellgyro
