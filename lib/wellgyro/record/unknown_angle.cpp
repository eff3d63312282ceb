#include "wellgyro/record/unknown_angle.h"

#include <cmath>

namespace wellgyro {

void CapAtUnknown(Eigen::Matrix3d* cov_attitude) {
  for (const int i : {1, 2}) {
    const double over = (*cov_attitude)(i, i) / kUnknownAngleVariance;
    if (!(over > 1)) continue;
    cov_attitude->row(i) /= std::sqrt(over);
    cov_attitude->col(i) /= std::sqrt(over);
  }
}

}  // namespace wellgyro
