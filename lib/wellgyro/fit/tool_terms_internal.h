#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/fit/tool_rows_internal.h"

namespace wellgyro {

enum class TermKind {
  kBias,
  kSensitivity,  ///< of the channel's own vector: force or rate
  kSquare,       ///< of q(u)
  kForce,
  kForceSquare,
  kHeating,
  kHysteresis,  ///< a loop, open in the middle of the temperatures
  kDrift,       ///< through one table
};

/// Where a coefficient acts: channel, component, sign.
struct TermUse {
  int channel = 0, j = 0;
  double sign = 1;
};

/// One coefficient of the model.
struct ToolTerm {
  std::string name;
  TermKind kind = TermKind::kBias;
  int power = 0;   ///< of the temperature, or of time
  int table = -1;  ///< of a drift
  std::vector<TermUse> uses;
  double prior_sigma = 0;  ///< about zero [the channel's unit]; 0: none
};

/// Coefficients that stay or go together.
struct TermBundle {
  std::string name;
  std::vector<ToolTerm> terms;
  bool needed = false;
  int after = -1;  ///< bundle without which it makes no sense
};

/// All that the tool of these readings may have, the needed ones first.
std::vector<TermBundle> CandidateTerms(const ToolReadings& readings, const ToolFitSetup& setup);

/// What acts on the sensors in one row.
struct RowState {
  Eigen::Vector3d u_accel_B = Eigen::Vector3d::Zero();  ///< force, table's sign [gravity's unit]
  Eigen::Vector3d w_B = Eigen::Vector3d::Zero();        ///< rate [deg/h]
  Eigen::Vector3d f_B = Eigen::Vector3d::Zero();        ///< specific force over local gravity
  double tau = 0;
  const ToolRow* row = nullptr;
};

/// What the coefficient is multiplied with, and by how much that changes with the channel's own
/// vector and with f.
struct Basis {
  double value = 0;
  Eigen::Vector3d by_own_B = Eigen::Vector3d::Zero(), by_force_B = Eigen::Vector3d::Zero();
};
Basis BasisOf(const ToolTerm& term, const TermUse& use, bool is_gyro, const RowState& state);

}  // namespace wellgyro
