#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/io/atomic_file.h"
#include "wellgyro/survey/wells/separation.h"
#include "wellgyro/uncertainty/propagate.h"

namespace wellgyro {

/// Which wells are to be held apart, and by what.
struct ClearanceRequest {
  std::optional<std::filesystem::path> policy;  ///< see clearance_file.h; absent: the rule's values
  std::optional<std::filesystem::path> reference;  ///< a survey or program; absent: the policy's
  std::vector<std::filesystem::path> offsets;      ///< beside those of the policy
  std::string model;                               ///< of surveys that name none: a file
  Surroundings surroundings;
  std::optional<double> convergence;       ///< given: azimuths are grid [rad]
  std::optional<Correlation> correlation;  ///< given: wins over the policy's
  /// Hears how many of how many offsets are done; may be empty.
  std::function<void(std::size_t, std::size_t)> progress;
};

enum class ClearanceVerdict { kPass, kWarn, kFail };

struct ClearanceAnswer {
  /// clearance.csv, wells.csv, ladder.svg, travelling_cylinder.svg and clearance.html with all of
  /// it.
  std::vector<OutputFile> files;
  std::vector<std::filesystem::path> inputs;  ///< files that were read
  std::vector<std::string> notes;
  std::vector<std::string> refusals;  ///< where a model ends before its survey does
  ClearanceVerdict verdict = ClearanceVerdict::kPass;
  std::string summary;  ///< a line on the lowest factor
};

/// Reads the files of `request` and answers it. An offset that cannot come below the policy's
/// `report` is screened out and stands in wells.csv only. Faults name file and line; the caller's
/// mistakes are std::invalid_argument.
WELLGYRO_EXPORT Result<ClearanceAnswer> AnswerClearance(const ClearanceRequest& request);

}  // namespace wellgyro
