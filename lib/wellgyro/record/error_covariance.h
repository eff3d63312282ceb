#pragma once

#include "wellgyro/record/error_source.h"

namespace wellgyro {

/// What is known before a run of its tool's errors, which change with the temperature T:
///   error(T) = constant + change (T - reference) / span.
struct ErrorCovariance {
  ErrorMatrix constant = ErrorMatrix::Zero();
  ErrorMatrix change = ErrorMatrix::Zero();
  ErrorMatrix constant_with_change = ErrorMatrix::Zero();  ///< E[constant change']
  double reference = 0;                                    ///< mean of the run [degC]
  double span = 1;  ///< largest difference from it in the run [degC]
};

}  // namespace wellgyro
