#pragma once

#include "wellgyro/base/export.h"

namespace wellgyro {

/// Leaves of the solver's log only errors. Ceres notes each step that it tried in vain, on standard
/// error where the program has not set up glog, though the fit goes on and says itself how it
/// ended. For programs whose standard error people read; it holds for the whole process and is
/// theirs to call, as the log is theirs.
WELLGYRO_EXPORT void QuietSolverLog();

}  // namespace wellgyro
