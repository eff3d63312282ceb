#pragma once

#include <span>
#include <string>
#include <vector>

#include "wellgyro/io/toml/toml_internal.h"
#include "wellgyro/io/toml/toml_writer_internal.h"
#include "wellgyro/record/noise.h"
#include "wellgyro/record/tool_calibration.h"

namespace wellgyro {

/// Noise coefficients under the names and units of noise files: quantization_arcsec,
/// angle_random_walk_deg_per_sqrt_h, ... Absent ones are zero. `<key>_sigma` and `<key>_upper95`
/// may stand beside them and are checked, not kept.
NoiseCoefficients ReadCoefficients(TomlTable& table);
/// Of a tool of which nobody states them: 0.1 deg/h of random noise at a stop of three minutes and
/// 0.1 deg/h of bias, GXY-RN and GXY-B of the example tools of SPE 90408 (Torkildsen et al. 2008),
/// Appendix D.
NoiseCoefficients NoiseUnlessStated();

/// Priors under the names of `[errors]`; absent ones are zero.
ErrorPriors ReadPriors(TomlTable& table);
/// Those of them that are zero because the table says so.
std::vector<std::string> PriorsOfNone(const TomlTable& table, const ErrorPriors& priors);
/// Those of them that are not zero, or are among `none`.
void WritePriors(TomlWriter& out, const ErrorPriors& priors, std::span<const std::string> none);

/// The priors of a job, key by key: the job's own, else the tool's, else one that nobody states.
/// What nobody states of a tool follows what is stated, in the ratios of the example tools of SPE
/// 90408, Appendix D: quadrature as mass unbalance (GXY-G1 and -G4, 0.5 deg/h/g each),
/// accelerometer scale as bias over 1 g (AXY-SF 5e-4, AXY-B 5e-3 m/s2), misalignments as each other
/// (AXY-MIS, GXY-MIS, 0.05 deg); else it is that of these tools. Depth: OWSG Set A Rev 5.1, DRFR
/// 0.35 m and DSFS 5.6e-4, of wireline. Accelerometer noise: 20 ug/sqrt(Hz), ten times that of
/// quartz flexure sensors (Honeywell QA-2000, 7 ug to 10 Hz). Time skew: 1 ms, a tenth of a sample
/// at 100 Hz. Latitude: 0, as well heads are surveyed. `job`: its [errors]; may be null.
ErrorPriors PriorsOfJob(TomlTable* job, const ToolCalibration* tool);

}  // namespace wellgyro
