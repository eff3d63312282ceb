#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/io/exchange/well_stations.h"
#include "wellgyro/io/text_file.h"
#include "wellgyro/uncertainty/propagate.h"

namespace wellgyro {

/// A definitive survey: legs of several tools, one after the other.
struct SurveyProgram {
  WellStations survey;                                    ///< of all legs
  std::vector<std::unique_ptr<const ErrorModel>> models;  ///< that the legs point to
  std::vector<ToolLeg> legs;
  Eigen::Matrix3d cov_tie_in_W = Eigen::Matrix3d::Zero();  ///< of the first station [m^2]
  std::vector<InputFile> inputs;                           ///< the files it names
};

/// A survey program, `wellgyro.program/1`: `[[leg]]` in order of depth, each with `survey`,
/// `model`, `run` (legs of one run and model share systematic errors; default: the leg's number)
/// and the range of its stations, above `from_md_m` (default: the leg before it, the first station
/// included) to `to_md_m` (default: all). `[tie_in]` with `north_m`, `east_m`, `tvd_m` and
/// `sigma_north_m`, `sigma_east_m`, `sigma_tvd_m` is optional. Files are named relative to `path`.
/// Faults name file and line.
WELLGYRO_EXPORT Result<SurveyProgram> ReadSurveyProgram(const std::filesystem::path& path,
                                                        North wanted = North::kTrue);

}  // namespace wellgyro
