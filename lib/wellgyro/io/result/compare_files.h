#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/io/atomic_file.h"
#include "wellgyro/survey/wells/compare.h"
#include "wellgyro/uncertainty/propagate.h"

namespace wellgyro {

/// Two surveys of one hole, each a file with an error model, a program of legs (.toml), or a file
/// with covariances and sigmas of its own.
struct CompareRequest {
  std::filesystem::path first, second;
  std::string first_model, second_model;  ///< names or files; empty: what the survey itself says
  Surroundings surroundings;              ///< its convergence is that of `convergence`
  std::optional<double> convergence;      ///< given: azimuths are grid [rad]
  CompareOptions options;
};

struct CompareAnswer {
  Comparison comparison;
  std::vector<OutputFile> files;              ///< compare.csv, checks.csv, compare.toml
  std::vector<std::filesystem::path> inputs;  ///< files that were read
  std::vector<std::string> notes;
  std::vector<std::string> refusals;  ///< where a model ends before its survey does
  std::string summary;                ///< lines on shifts and the deepest place
};

/// Reads the files of `request` and compares. Faults name file and line; the caller's mistakes are
/// std::invalid_argument.
WELLGYRO_EXPORT Result<CompareAnswer> AnswerCompare(const CompareRequest& request);

/// compare.csv: MD[m],INC_A[deg],INC_B[deg],D_INC[deg],SIG_D_INC[deg],AZI_A[deg],AZI_B[deg],
/// D_AZI[deg],SIG_D_AZI[deg],DN[m],DE[m],DV[m], the six columns of the covariance of what is left
/// of it without ComparedPlace::between_stations_W, POS_SIGMAS of that, and
/// BETWEEN_N[m],BETWEEN_E[m],BETWEEN_V[m]; differences are the second less the first.
WELLGYRO_EXPORT std::string CompareCsv(const std::vector<ComparedPlace>& places);

}  // namespace wellgyro
