#pragma once

#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/calibration/error_sources.h"
#include "wellgyro/calibration/fit_report.h"
#include "wellgyro/io/text_file.h"

namespace wellgyro {

/// What a calibration certificate says, in the units it is shown in.
struct Certificate {
  std::string asset_serial, sensor_serials, method, program;
  std::string number, laboratory;         ///< of the certificate, and who issues it
  std::string calibrated, expires;        ///< dates, as 2026-01-31; empty where not said
  std::vector<std::string> references;    ///< what stood around the bench
  std::vector<std::string> traceability;  ///< reference instruments and their certificates
  std::vector<InputFile> inputs;
  std::vector<InputFile> outputs;  ///< the files that it certifies

  /// What a source contributes to a standard uncertainty.
  struct Contribution {
    std::string source;
    bool type_a = false;
    double uncertainty = 0;
  };
  /// A quantity with its standard uncertainty.
  struct Line {
    std::string name, unit;
    double value = 0, uncertainty = 0;
    std::string evaluation;  ///< "A" from the readings, "B" by other means, else "budget"
    std::vector<Contribution> budget = {};
    double dof = 0;  ///< effective, of the uncertainty; 0: not known, k is 2

    /// In a unit of which there are `per_unit` in one of this one.
    WELLGYRO_EXPORT void Scale(double per_unit);
  };
  std::vector<Line> bench;    ///< level, north, latitude: what entered, and what was found
  std::vector<Line> result;   ///< of the sensors
  std::vector<Line> samples;  ///< errors left in calibrated samples
  double temperature_low = 0, temperature_high = 0;  ///< [degC]; alike: not said
  std::vector<std::string> left_out, remarks;
  std::vector<FitResidual> residuals;
  double studentised_limit = 0, chi_square = 0, chi_low = 0, chi_high = 0;
  int readings = 0, dof = 0;
};

/// Its result lines, residuals and statistics from a fit; the rest is the caller's.
WELLGYRO_EXPORT Certificate CertificateOf(const FitReport& report);

/// The unit in which people read an error source, and how many of it are one SI unit.
struct SourceUnit {
  const char* name = "1e-6";
  double per_si = 1e6;
};
WELLGYRO_EXPORT SourceUnit UnitOfSource(const std::string& source);

/// The sources of a calibration (calibration/error_sources.h) in the units that people use: deg/h,
/// deg/h/g, mg, 1e-6; those that are zero are left out. `budget`: of the sources, in SI.
WELLGYRO_EXPORT std::vector<Certificate::Line> SampleErrors(const CalibrationSources& sources,
                                                            const UncertaintyBudget& budget);

/// One self-contained page of HTML, set for paper: uncertainties as the Guide to the Expression of
/// Uncertainty in Measurement (JCGM 100) has them, standard and expanded to 95 %, and where lines
/// have a budget what each source contributes; residuals over their sigmas in the order of the
/// readings, a picture a channel (SVG). Text from outside is escaped.
WELLGYRO_EXPORT std::string CertificateHtml(const Certificate& certificate);

}  // namespace wellgyro
