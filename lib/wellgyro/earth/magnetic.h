#pragma once

#include <string>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/earth/grid.h"

namespace wellgyro {

/// The Earth's main field at a place and date, with 1-sigma uncertainties that hold for any place.
struct MagneticField {
  double declination = 0;                       ///< true azimuth less magnetic [rad]
  double dip = 0;                               ///< down from horizontal [rad]
  double field = 0;                             ///< total [T]
  double sigma_declination = 0, sigma_dip = 0;  ///< [rad]
  double sigma_field = 0;                       ///< [T]
};

/// By a model in GeographicLib's format, `name`.wmm in `folder`: "wmm2025", "wmm2020" (World
/// Magnetic Model) or "igrf14" of data/magnetic. `height` above the WGS 84 ellipsoid [m]; `year`
/// with its fraction, as 2026.89.
///
/// The sigmas are those of the WMM 2025 error model (NOAA NCEI and BGS, 2024), crustal field and
/// disturbance included: 0.20 deg of dip, 138 nT, and of declination the root of 0.26^2 +
/// (5417 nT / H)^2 deg. Fault kIo where the model cannot be read, kRange outside its years and
/// heights or for what is no place.
WELLGYRO_EXPORT Result<MagneticField> MagneticFieldAt(const std::string& name,
                                                      const std::string& folder,
                                                      const GeodeticPoint& place, double height,
                                                      double year);

/// The year with its fraction of a day in the Gregorian calendar. Fault kSyntax unless it is
/// written YYYY-MM-DD and exists.
WELLGYRO_EXPORT Result<double> DecimalYear(const std::string& date);

}  // namespace wellgyro
