#include "wellgyro/fit/solver_log.h"

#include <glog/logging.h>

namespace wellgyro {

void QuietSolverLog() { FLAGS_minloglevel = google::GLOG_ERROR; }

}  // namespace wellgyro
