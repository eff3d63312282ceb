#pragma once

#include <string>
#include <vector>

#include "wellgyro/record/check.h"

namespace wellgyro {

/// What a run, or a whole survey, is worth to those who are handed it: pass, warn or fail, never
/// not_done, and why. A survey that fails is whole, but not to be handed over as it is.
struct RunVerdict {
  Verdict verdict = Verdict::kPass;
  std::vector<std::string> causes = {};  ///< in words, each failing one before any other
};

}  // namespace wellgyro
