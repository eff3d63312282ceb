#pragma once

#include <array>

#include <Eigen/Core>

#include "wellgyro/record/sample.h"
#include "wellgyro/record/tool_calibration.h"

namespace wellgyro {

/// SensorGroup's formula solved for u in T, at one temperature and sample period:
/// u = from_counts counts + offset - from_force f - from_squares q(u_S) - from_force_squares
/// q(f_S).
class GroupSolution {
 public:
  /// Takes the group at the true temperature `temperature` [degC] and sample period `seconds`.
  /// Gives whether the temperature is inside the calibrated range.
  bool Prepare(const SensorGroup& group, double temperature, double seconds);

  /// The heating rate takes `seconds` at the present temperature; see SensorGroup::heating_lag.
  void Heat(const SensorGroup& group, double seconds);
  /// Forgets the heating so far.
  void Settle();

  int n_channels() const { return n_channels_; }
  Eigen::Vector3d Solve(const RawSample& raw) const { return Refine(Linear(raw)); }
  /// The same for sensors that feel the specific force `f_T` too.
  Eigen::Vector3d Solve(const RawSample& raw, const Eigen::Vector3d& f_T) const;
  /// Component of the readings along what no u explains, for four channels.
  double Parity(const RawSample& raw, const Eigen::Vector3d& u_T, const Eigen::Vector3d& f_T) const;

 private:
  using Squares3 = Eigen::Matrix<double, 3, 6>;
  Eigen::Vector3d Linear(const RawSample& raw) const;
  Eigen::Vector3d Refine(const Eigen::Vector3d& linear) const;
  void Offset();

  int n_channels_ = 0;
  bool second_order_ = false, g_dependent_ = false, g_squared_ = false;
  std::array<std::size_t, SensorGroup::kChannels> channel_{};
  Eigen::Matrix<double, 3, 4> from_counts_;  ///< [SI per count]
  Eigen::Matrix<double, 3, 4> from_units_;   ///< [SI per unit]
  Eigen::Vector3d offset_;                   ///< [SI]
  Eigen::Matrix3d from_force_;
  Squares3 from_squares_, from_force_squares_;
  Eigen::Matrix3d R_ST_;
  Eigen::Vector4d unit_per_count_, bias_, heating_, parity_;
  SensorGroup::Rows g_dependence_T_;
  SensorGroup::Squares second_order_terms_, g_squared_terms_;
  double temperature_ = 0, lagged_ = 0, heating_rate_ = 0;
  bool settled_ = false;
};

}  // namespace wellgyro
