#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/time.h"

namespace wellgyro {

/// A fault that may explain a run: what it is, when it began, how large, what it did to the end of
/// the run, and what to do.
struct RunCause {
  std::string code;  ///< stable name, as "toolface_slip"; "none": no fault; "other": none of these
  std::optional<UtcTime> begin;    ///< absent: all the while, or not known
  std::optional<double> begin_md;  ///< [m]
  std::optional<double> size;      ///< found, in `unit`
  std::optional<double> sigma;
  std::string unit;  ///< as written in files: deg, m/s2, deg/h, 1
  /// ln of the Bayes factor against no fault; absent where the samples alone were judged.
  std::optional<double> ln_bayes;
  double posterior = 0;  ///< probability, those of a run adding up to one
  /// The end of the run as given less where it is, if this is the cause [m].
  std::optional<Eigen::Vector3d> shift_W;
  std::vector<std::string> alike;  ///< codes that this run hardly tells from it
  std::string remedy;
};

/// What a fault could have done to a run unseen.
struct RunReliability {
  std::string code;
  std::optional<double> smallest;  ///< that would be noticed four times in five; absent: none would
  std::string unit;
  std::optional<double> md;  ///< where it would have to begin, the worst place [m]
  /// Shift of the end by the smallest; where none would be noticed by the largest there is [m].
  Eigen::Vector3d shift_W = Eigen::Vector3d::Zero();
};

/// A slip of the depth's wheel, told by passes through the same hole.
struct RunSlip {
  RunCause cause;  ///< without `ln_bayes` where nothing tells it
  RunReliability reliability;
  /// Shift of the end by the largest there is, where a fifth of the depths or more would not show
  /// it; else zero [m].
  Eigen::Vector3d unseen_W = Eigen::Vector3d::Zero();
};

/// Which fault explains a run, and which could hide in it.
struct RunDiagnosis {
  double ln_odds = 0;                ///< of some fault against none, both as likely before
  double ln_odds_without_first = 0;  ///< once the likeliest is taken out
  std::string second;                ///< the likeliest then; empty: it was not looked for
  std::vector<RunCause> causes;      ///< the likeliest first
  std::vector<RunReliability> reliability;
};

}  // namespace wellgyro
