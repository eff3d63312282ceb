#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/earth/grid.h"
#include "wellgyro/io/text_file.h"
#include "wellgyro/survey/hole/well_uncertainty.h"
#include "wellgyro/survey/wells/compare.h"

namespace wellgyro {

/// What a survey is to be read with.
struct SurveyWish {
  std::filesystem::path path;         ///< a survey, or a program of legs (.toml)
  std::string model;                  ///< a name or file; empty: none
  std::optional<double> convergence;  ///< given: azimuths are grid [rad]
};

/// A survey as read, with what is known of its errors.
struct TakenSurvey {
  SurveyedWell well;
  North north = North::kTrue;
  std::vector<std::shared_ptr<const ErrorModel>> models;  ///< that the legs point to
  std::vector<ToolLeg> legs;                              ///< empty: no model
  std::vector<StationSigmas> own;  ///< where there is no model: the file's columns, or empty
  std::string lacks;               ///< the first of those columns that the file does not have
  Eigen::Matrix3d cov_tie_in_W = Eigen::Matrix3d::Zero();
  std::vector<InputFile> inputs;
  std::vector<std::string> notes;
};

/// Reads it. Throws std::invalid_argument where north and convergence contradict each other or a
/// program is given a model.
WELLGYRO_EXPORT Result<TakenSurvey> TakeSurvey(const SurveyWish& wish);

}  // namespace wellgyro
