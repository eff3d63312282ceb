#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/io/atomic_file.h"
#include "wellgyro/io/exchange/exchange.h"
#include "wellgyro/record/check.h"
#include "wellgyro/record/survey_table.h"
#include "wellgyro/survey/wells/merge.h"

namespace wellgyro {

struct MergeRequest {
  std::filesystem::path plan;  ///< see merge_file.h
  std::string text;            ///< of the plan, whose files are relative to `plan`; empty: read it
  Surroundings surroundings;
  std::optional<double> convergence;  ///< given: azimuths are grid [rad]
  std::vector<double> at;             ///< depths for resampled.csv [m]
  double every = 0;                   ///< likewise, whole multiples of it [m]
  std::vector<SurveyFormat> formats;  ///< of the definitive survey, besides CSV
};

struct MergeAnswer {
  MergedSurvey merged;
  SurveyTable table;  ///< the definitive survey, for exchange
  /// definitive.csv and its other formats, choices.csv, comparisons.csv of legs that overlap,
  /// resampled.csv where asked for, program.toml (wellgyro.program/1: the same legs, for
  /// `uncertainty` and `clearance`), merge.toml.
  std::vector<OutputFile> files;
  std::vector<std::filesystem::path> inputs;  ///< files that were read
  std::vector<std::string> notes;
  RunVerdict verdict;   ///< of the comparisons, by the policy
  std::string summary;  ///< a line for each choice, then one on the deepest station
};

/// Reads the files of `request` and merges. Faults name file and line; the caller's mistakes are
/// std::invalid_argument.
WELLGYRO_EXPORT Result<MergeAnswer> AnswerMerge(const MergeRequest& request);

/// A survey with its covariances, as a table for exchange: places straight from the arcs at
/// `depths`, covariances straight between stations; rows between stations are interpolated ones.
WELLGYRO_EXPORT SurveyTable Resampled(const SurveyedWell& well, const PositionUncertainty& errors,
                                      const std::vector<double>& depths);

}  // namespace wellgyro
