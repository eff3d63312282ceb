#include "wellgyro/fit/adjuster.h"

#include "wellgyro/fit/run_adjustment.h"

namespace wellgyro {

std::shared_ptr<const RunAdjuster> MakeAdjuster() {
  return std::make_shared<const LeastSquaresAdjuster>();
}

}  // namespace wellgyro
