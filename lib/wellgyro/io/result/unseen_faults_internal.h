#pragma once

#include <optional>
#include <string>
#include <vector>

#include "wellgyro/survey/survey.h"
#include "wellgyro/uncertainty/ellipse.h"

namespace wellgyro {

/// How far the end of a survey may be off where one fault stayed unnoticed, what chance does
/// besides with it: the protection level of aviation's integrity, in two dimensions.
struct UnseenFaults {
  ErrorEllipse
      bound;          ///< about the 95 % ellipse and what the faults of reliability.csv do together
  std::string cause;  ///< the fault that does most
  double shift = 0;   ///< what it does alone, horizontally [m]
  double tvd = 0;     ///< 95 % and what the fault that does most to it does [m]
  /// Faults that this run would not show at any size looked for, and that move its end by more than
  /// chance does.
  std::vector<std::string> unshown;
};

/// Of the deepest chosen station; none where it is unfit or its run has no diagnosis.
std::optional<UnseenFaults> UnseenFaultsOf(const Survey& survey);

}  // namespace wellgyro
