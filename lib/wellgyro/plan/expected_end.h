#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/plan/plan_case.h"
#include "wellgyro/record/diagnosis.h"

namespace wellgyro {

/// What a survey of the well as planned will know of the well's end.
struct ExpectedEnd {
  bool solved = false;  ///< false: nothing tells the azimuth; what follows means nothing
  /// Of the deepest point as seen from the first, attitudes and depth together [m^2].
  Eigen::Matrix3d cov_p_WT_W = Eigen::Matrix3d::Zero();
  double semi_major = 0, semi_minor = 0;  ///< of the horizontal 95 % ellipse [m]
  double azimuth_major = 0;               ///< [rad]
  double sigma_azimuth = 0;               ///< of the hole at the deepest point [rad]
  double seconds = 0;                     ///< of the whole run
  /// What each fault may do to the end and pass unnoticed; empty where it was not asked for.
  std::vector<RunReliability> reliability = {};
  double hidden = 0;              ///< the largest of them, horizontal [m]
  std::string hidden_cause = {};  ///< its code
};

/// By the estimator itself: its rows for the synthetic run, its elimination, its diagnosis
/// (estimate/). Depth adds ErrorPriors' offset along the hole and scale along the path; how the
/// tool lies in the hole adds nothing here. `with_faults`: reliability too, some four times the
/// time. Throws as CheckPlanCase().
WELLGYRO_EXPORT ExpectedEnd ExpectEnd(const PlanCase& c, std::span<const PlannedStop> stops,
                                      bool with_faults);

/// A place of the way in, as seen from the first.
struct ExpectedPlace {
  double md = 0;                                         ///< [m]
  Eigen::Matrix3d cov_p_WT_W = Eigen::Matrix3d::Zero();  ///< as ExpectedEnd's [m^2]
};

/// The same all along the way in, at the first node past every `spacing` [m] and at its end, by
/// what the whole run will tell. Empty where nothing tells the azimuth. Throws as CheckPlanCase(),
/// and std::invalid_argument for a spacing that is not positive.
WELLGYRO_EXPORT std::vector<ExpectedPlace> ExpectAlong(const PlanCase& c,
                                                       std::span<const PlannedStop> stops,
                                                       double spacing);

/// What the errors of depth add at the way's end [m^2].
Eigen::Matrix3d DepthCovariance(const PlanCase& c);

}  // namespace wellgyro
