#pragma once

#include <span>
#include <string_view>

#include "wellgyro/base/export.h"
#include "wellgyro/record/noise.h"
#include "wellgyro/record/tool_calibration.h"

/// What holds of a tool's errors and noise where neither its job nor its file states them.
namespace wellgyro {

/// One prior: `ratio` of what it follows where that is stated, else `value`.
struct UnstatedError {
  double ErrorPriors::*error = nullptr;
  double value = 0;  ///< SI
  double ErrorPriors::*follows = nullptr;
  double ratio = 1;
  std::string_view follows_text;  ///< what it follows, in words
};

/// What nobody states of a tool follows what is stated, in the ratios of the example tools of SPE
/// 90408 (Torkildsen et al. 2008), Appendix D: quadrature as mass unbalance (GXY-G1 and -G4, 0.5
/// deg/h/g each), accelerometer scale as bias over 1 g (AXY-SF 5e-4, AXY-B 5e-3 m/s2),
/// misalignments as each other (AXY-MIS, GXY-MIS, 0.05 deg); else it is that of these tools. Depth:
/// OWSG Set A Rev 5.1, DRFR 0.35 m and DSFS 5.6e-4, of wireline. Accelerometer noise: 20
/// ug/sqrt(Hz), ten times that of quartz flexure sensors (Honeywell QA-2000, 7 ug to 10 Hz). Time
/// skew: 1 ms, a tenth of a sample at 100 Hz. Latitude: 0, as well heads are surveyed.
WELLGYRO_EXPORT std::span<const UnstatedError> UnstatedErrors();

/// Those of `priors` that are not among `stated`, which are places in it, by UnstatedErrors().
WELLGYRO_EXPORT void FillUnstated(std::span<const double* const> stated, ErrorPriors& priors);

/// 0.1 deg/h of random noise at a stop of three minutes and 0.1 deg/h of bias, GXY-RN and GXY-B of
/// the example tools of SPE 90408, Appendix D.
WELLGYRO_EXPORT NoiseCoefficients NoiseUnlessStated();

}  // namespace wellgyro
