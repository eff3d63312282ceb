#include "wellgyro/record/knot_sources.h"

namespace wellgyro {

Knot::SourceVector SourceSigmas(const ErrorPriors& errors) {
  Knot::SourceVector sigma = Knot::SourceVector::Zero();
  sigma[Knot::kMassUnbalance] = errors.mass_unbalance_sigma;
  sigma[Knot::kQuadrature] = errors.quadrature_sigma;
  sigma[Knot::kGyroScaleX] = sigma[Knot::kGyroScaleY] = errors.gyro_scale_sigma;
  sigma[Knot::kMisalignmentX] = sigma[Knot::kMisalignmentY] = errors.gyro_misalignment_sigma;
  sigma[Knot::kToolfaceOffset] = errors.roll_offset_sigma;
  sigma[Knot::kTimeSkew] = errors.time_skew_sigma;
  sigma[Knot::kAccelBiasX] = sigma[Knot::kAccelBiasY] = sigma[Knot::kAccelBiasZ] =
      errors.accel_bias_sigma;
  return sigma;
}

}  // namespace wellgyro
