#pragma once

#include <Eigen/Core>

#include "wellgyro/estimate/knot_place.h"
#include "wellgyro/estimate/layout.h"
#include "wellgyro/estimate/node.h"
#include "wellgyro/estimate/setup.h"
#include "wellgyro/estimate/turn_columns.h"
#include "wellgyro/estimate/wobble.h"
#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// What several factors of a knot share.
struct KnotTerms {
  const RunKnot& knot;
  Increment inc;  ///< of a psi without what is known of the sensors' errors
  const KnotPlace& place;
  const Node& begin;
  const Node& end;
  double dt;
  double delta = 0;       ///< psi's error at the end, from that at the begin [rad]
  double axial_rate = 0;  ///< of roll, by a third axis [rad/s]
  double frequency = 0;   ///< of the swing [rad/s]
  Eigen::Vector2d of_swing = Eigen::Vector2d::Zero();  ///< in the mean rate of roll
  Eigen::Vector3d drift_T = Eigen::Vector3d::Zero();   ///< of the gyros, beside the bias [rad/s]
  TurnByError turn_by_error{};                         ///< at the roll rate of now
  Eigen::Vector2d turn{};                              ///< what is known of the errors corrected
  Eigen::Vector2d turn_per_roll{};                     ///< at delta, of what the gyros read [1]
  Eigen::Vector2d skew_per_roll{};                     ///< of what skewed ones read wrongly [1]
  double fixed_beyond = 0;                   ///< of what is fixed in T, its mean in M beyond psi's
  Eigen::Matrix3d R_TM_begin{}, R_MT_end{};  ///< rolls to the middle and from it
  Eigen::Matrix3d R_MM_half{};               ///< from mid-knot to its begin: half the turn
  Eigen::Matrix3d R_LM{};                    ///< at mid-knot
  Eigen::Vector3d w_IL_L;                    ///< at the latitude as it is now known
  BorderVector border;
  double warmth = 0;    ///< what the errors' changes count by
  ErrorVector error{};  ///< at this temperature
  WobbleBy wobble;
  Eigen::Matrix<double, 3, kSecondOrderSources> by_second_order{};  ///< of the force, where it is
};

/// Of a run.
struct KnotModel {
  const EstimateSetup& setup;
  const Layout& layout;
  const ErrorVector& known;  ///< errors before the border's
};

/// Errors of the tool that the setup knows, beside which the border has the rest.
ErrorVector KnownErrors(const EstimateSetup& setup);

/// An increment's turn and force about the present nodes and errors. All must outlive the terms.
KnotTerms TermsOf(const KnotModel& model, const RunKnot& knot, const KnotPlace& place,
                  const BorderVector& border, const Node& begin, const Node& end);

/// Derivative of the mean force in M by an accelerometer's error. A bias or misalignment is a
/// vector fixed in T, whose mean in M counts the turn delta that psi has not seen. Scales and shear
/// act on a force that keeps its direction in M: for these the derivative by psi alone is taken.
Eigen::Vector3d ForceBy(const KnotTerms& terms, int source);

/// The mean force in M without the tool's errors; `by_skew_M`: what a second of time skew adds.
Eigen::Vector3d ForceOf(const KnotTerms& terms, const Layout& layout,
                        const Eigen::Vector3d& by_skew_M);

}  // namespace wellgyro
