#pragma once

#include <optional>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/calibration/bench_table.h"
#include "wellgyro/calibration/fit_report.h"
#include "wellgyro/fit/bench_reference.h"

namespace wellgyro {

struct MultiStationSetup {
  BenchReference reference;           ///< magnetometers: field and dip; gyros: latitude
  std::optional<double> sigma_field;  ///< of |M| at a station, reference included [nT]
  std::optional<double> sigma_dip;    ///< of the dip at a station, reference included [rad]
  std::optional<double> sigma_rate;   ///< of the rate at a station [deg/h]
  std::optional<double> prior_bias;   ///< 1-sigma about zero [nT or deg/h]; absent: free
  std::optional<double> prior_scale;  ///< of magnetometers, about zero [1]; absent: free
};

/// What the stations of a run say of their own sensors: columns Gx, Gy, Gz and Mx, My, Mz [nT], or
/// wx, wy [and wz, deg/h], calibrated, a row a station.
///
/// Magnetometers: M = (M_raw - bm) / (1 + sm) with |M| that of the field and its dip against
/// gravity; gyros (where wx is there): the level and vertical parts of w - bg
/// are We cos L and We sin L; with two axes the azimuth of every station is estimated along.
/// Biases across the hole need toolfaces all round, those along it a spread of inclination or
/// azimuth; near horizontal east-west nothing sees bm_z. Priors carry what the stations do not, and
/// a remark says for what. Result: `bm_nT`, `sm`; or `bg_degh`.
WELLGYRO_EXPORT Result<BenchCalibration> FitMultiStation(const BenchTable& data,
                                                         const MultiStationSetup& setup);

}  // namespace wellgyro
