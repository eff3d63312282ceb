#pragma once

#include "wellgyro/estimate/run_state.h"

namespace wellgyro {

/// What a run that goes on knows, and which way it goes.
struct RunSoFar {
  const RunState* state = nullptr;  ///< never null
  bool out = false;                 ///< up: it goes no deeper any more
};

}  // namespace wellgyro
