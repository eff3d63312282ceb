#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "wellgyro/base/result.h"
#include "wellgyro/survey/job.h"

/// What the tables of a job may hold, beside its single numbers: lists, words, times, and keys that
/// need or exclude one another. The same rules hold for a file and for a Job made in a program;
/// limits are those of survey/job_keys.h.
namespace wellgyro {

/// What is wrong with one table of a job.
struct KeyComplaint {
  std::string_view key;  ///< of survey/job_keys.h
  std::string why;       ///< "-1 must be at least 0"
  FaultCode code = FaultCode::kRange;
  std::string_view other = "";  ///< the key at fault where `key` is absent
};

// Each gives the first thing that is wrong with one table.
std::optional<KeyComplaint> FindKeyComplaint(const GridSpec& grid);
std::optional<KeyComplaint> FindKeyComplaint(const TieIn& tie_in);
std::optional<KeyComplaint> FindKeyComplaint(const Channels& channels);
std::optional<KeyComplaint> FindKeyComplaint(const AlignmentSpec& alignment);
std::optional<KeyComplaint> FindKeyComplaint(const AttitudeSpec& attitude);
std::optional<KeyComplaint> FindKeyComplaint(const StationSpec& stations);
std::optional<KeyComplaint> FindKeyComplaint(const DepthSpec& depth);
std::optional<KeyComplaint> FindKeyComplaint(const Event& event);
/// Of the last of `runs`, beside those before it.
std::optional<KeyComplaint> FindKeyComplaint(std::span<const RunSpec> runs);

/// The same of the values and texts of `event` alone. What is pushed is held to these: its numbers
/// and times are those of who sends.
std::optional<KeyComplaint> FindValueComplaint(const Event& event);

/// What is wrong with `cov_p_WT_W` as the covariance of a position [m^2]: a number that is none, no
/// symmetry, or a direction of negative variance.
std::optional<std::string> FindCovarianceComplaint(const Eigen::Matrix3d& cov_p_WT_W);

/// Why the well head of `job` has no place on its grid.
std::optional<std::string> FindWellHeadComplaint(const Job& job);

}  // namespace wellgyro
