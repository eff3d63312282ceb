#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/survey/hole/well_uncertainty.h"

namespace wellgyro {

/// One survey of a part of a hole, as a candidate for its definitive survey.
struct MergeLeg {
  std::string name;
  std::vector<SurveyPoint> stations;  ///< at least one; TVD not filled
  const ErrorModel* model = nullptr;
  int run = 1;           ///< legs of one run and model share their systematic errors
  bool kept = false;     ///< of the parent hole: taken wherever it reaches
  std::string left_out;  ///< why somebody has ruled it out; empty: nobody has
};

/// What is to be small at the depth that counts.
enum class MergeMeasure { kHorizontal, kVertical, kVolume };

/// By what rule the legs are chosen where several reach.
struct MergePolicy {
  /// The earlier in the list wins wherever it reaches; else those that make `measure` smallest.
  bool in_order = false;
  MergeMeasure measure = MergeMeasure::kHorizontal;
  std::optional<double> at_md;  ///< where `measure` counts [m]; absent: the deepest station
  double min_gain = 0.05;       ///< by which share another leg must be better to be changed to
  double max_gap = 60;          ///< between the stations of two legs that follow each other [m]
};

/// A stretch of the definitive survey.
struct MergeChoice {
  double from_md = 0, to_md = 0;  ///< of its stations [m]
  std::size_t leg = 0;
  std::string reason;  ///< in a sentence
};

struct MergedSurvey {
  SurveyedWell well;
  std::vector<ToolLeg> legs;   ///< one for each choice
  PositionUncertainty errors;  ///< carried through the ties
  std::vector<MergeChoice> choices;
  std::vector<std::string> unused;  ///< of legs that are no part of it, and why, a sentence each
  double measure = 0;               ///< what the policy makes small: 1 sigma [m]
};

/// Throws std::invalid_argument where no leg is left, or those that are leave a gap or hold fewer
/// than two stations.
WELLGYRO_EXPORT void CheckLegs(std::span<const MergeLeg> legs, const MergePolicy& policy);

/// One survey out of legs that may overlap, follow each other or begin below each other.
///
/// Where several reach, every order of them is tried between the depths at which one begins or ends
/// (beyond 64 orders the best so far go on), each with its whole covariance through the ties;
/// changes of leg that gain less than `min_gain` are not made. A single leg that reaches all the
/// way is always among those tried, so the result is never less sure than the best of them by more
/// than that share. Throws std::invalid_argument as CheckLegs does, and for stations that do not go
/// down, models that do not reach the end, or what PropagateErrors refuses.
WELLGYRO_EXPORT MergedSurvey Merge(std::span<const MergeLeg> legs, const Eigen::Vector3d& start_W,
                                   const Eigen::Matrix3d& cov_tie_in_W,
                                   const Surroundings& surroundings, const MergePolicy& policy);

}  // namespace wellgyro
