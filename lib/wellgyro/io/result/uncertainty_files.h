#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/io/atomic_file.h"
#include "wellgyro/survey/hole/well_uncertainty.h"
#include "wellgyro/survey/wells/separation.h"
#include "wellgyro/uncertainty/ellipse.h"

namespace wellgyro {

/// A survey with the error model of its tool, its gyro's noise, or both; or a program of legs.
struct UncertaintySources {
  std::optional<std::filesystem::path> survey, model, noise, program;
};

/// What the position uncertainty of a well is asked of.
struct UncertaintyRequest {
  UncertaintySources sources;
  AllanForm form = AllanForm::kExact;
  std::optional<double> speed;        ///< see UncertaintyBasis
  std::optional<double> initialise;   ///< likewise
  double sigma_azimuth = 0;           ///< likewise
  Surroundings surroundings;          ///< its convergence is that of `convergence`
  std::optional<double> convergence;  ///< given: azimuths are grid [rad]
  /// 1 sigma of the first station's place: north, east, down [m]; a program names its own.
  Eigen::Vector3d sigma_tie_in = Eigen::Vector3d::Zero();
  double confidence = kConfidence;
  bool terms = false;
  bool plot = false;
  /// For the separation from another survey, with the model of the first where none is named.
  std::optional<std::filesystem::path> other, other_model;
  Pairing pairing = Pairing::kTwoWells;
  Correlation correlation = Correlation::kGlobal;
};

/// Its answer.
struct UncertaintyAnswer {
  std::vector<OutputFile> files;  ///< covariance.csv and what was asked for beside, then
                                  ///< uncertainty.toml: inputs, mode and notes
  std::vector<std::filesystem::path> inputs;  ///< files that were read
  std::vector<std::string> notes;             ///< assumptions that were made
  std::vector<std::string> refusals;          ///< where a model ends before its survey does
  std::string summary;                        ///< a line on the deepest station
};

/// Reads the files of `request` and answers it. Faults name file and line; the caller's mistakes
/// (options that are missing or contradict a file) are std::invalid_argument.
WELLGYRO_EXPORT Result<UncertaintyAnswer> AnswerUncertainty(const UncertaintyRequest& request);

}  // namespace wellgyro
