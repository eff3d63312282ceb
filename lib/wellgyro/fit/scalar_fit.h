#pragma once

#include <optional>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/calibration/bench_table.h"
#include "wellgyro/calibration/fit_report.h"
#include "wellgyro/fit/bench_reference.h"

namespace wellgyro {

struct ScalarSetup {
  BenchReference reference;
  std::optional<double> sigma_accel;  ///< of a reading [its unit]
  std::optional<double> sigma_mag;    ///< of a reading [its unit]
  bool free_dip = false;              ///< the dip of the field is found too (scalar-dip)
};

/// Accelerometers without a turntable: |M (v - b)| is gravity at every attitude (columns ax, ay,
/// az, Gx.., fx.. or vx.., in any unit).
///
/// Nine parameters, v = Ka u + ba with Ka lower triangular: the axes u are an orthogonal frame that
/// the readings themselves cannot turn; the sensors' z axis leads it. Only MtM = (Ka Ka')^-1 and ba
/// are free of that choice. Needs 12 attitudes, some between the axes (six faces, even with four
/// rotations each, determine six of nine parameters); 18 to 24 are good. Result: `Ka`, `ba`, `MtM`.
WELLGYRO_EXPORT Result<BenchCalibration> FitScalar(const BenchTable& data,
                                                   const ScalarSetup& setup);

/// Accelerometers and magnetometers together: |f| is gravity, |m| the field and the angle between
/// them that of the dip; Km is a full matrix, soft iron and rotation into the accelerometers' frame
/// included. The field must be known; the dip may be found. Result: `Ka`, `ba`, `Km`, `bm` and,
/// where found, `dip_deg`.
WELLGYRO_EXPORT Result<BenchCalibration> FitScalarDip(const BenchTable& data,
                                                      const ScalarSetup& setup);

}  // namespace wellgyro
