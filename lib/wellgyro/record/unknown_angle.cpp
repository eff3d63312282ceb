#include "wellgyro/record/unknown_angle.h"

#include <cmath>

namespace wellgyro {

void CapAtUnknown(Eigen::Matrix3d* cov) {
  for (const int i : {1, 2}) {
    const double over = (*cov)(i, i) / kUnknownAngleVariance;
    if (!(over > 1)) continue;
    cov->row(i) /= std::sqrt(over);
    cov->col(i) /= std::sqrt(over);
  }
}

}  // namespace wellgyro
