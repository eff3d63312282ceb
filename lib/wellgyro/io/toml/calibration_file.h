#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/calibration/fit_report.h"
#include "wellgyro/calibration/trigonometric.h"
#include "wellgyro/io/text_file.h"

namespace wellgyro {

/// What a calibration file says.
struct CalibrationFile {
  std::string program;                  ///< name and version
  std::vector<InputFile> inputs;        ///< the bench data
  std::vector<std::string> references;  ///< what stood around the bench, as "gravity 1 g"
  FitReport report;
  std::optional<OrthogonalityCheck> check;
};

/// `wellgyro.calibration/1`: [result] with the method's parameters and [result_sigma] beside it (a
/// quantity that is no parameter has none), then [statistics], [covariance], [residuals].
WELLGYRO_EXPORT std::string CalibrationToml(const CalibrationFile& file);

/// Reads it back. The quantities of [[result.per_T]] come as "per_T[0].name".
WELLGYRO_EXPORT Result<CalibrationFile> ParseCalibration(std::string_view text,
                                                         const std::string& source);

/// The same for people: parameters with their sigmas, whether the residuals fit, the worst of them,
/// outliers, correlations, remarks.
WELLGYRO_EXPORT std::string CalibrationSummary(const CalibrationFile& file);

}  // namespace wellgyro
