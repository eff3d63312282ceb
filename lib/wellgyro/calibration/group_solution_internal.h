#pragma once

#include <array>

#include <Eigen/Core>

#include "wellgyro/record/sample.h"
#include "wellgyro/record/tool_calibration.h"

namespace wellgyro {

/// The linear part of a group, small enough to be copied out of reach of what a loop writes:
/// u = A counts + b, of the first three channels.
struct LinearPart {
  Eigen::Matrix3d A;
  Eigen::Vector3d b;
  std::size_t c0, c1, c2;

  Eigen::Vector3d operator()(const RawSample& raw) const {
    return A * Eigen::Vector3d(raw.counts[c0], raw.counts[c1], raw.counts[c2]) + b;
  }
};

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
  LinearPart linear() const;
  bool has_fourth() const { return n_channels_ == 4; }
  bool feels_force() const { return feels_force_; }
  bool has_second_order() const { return second_order_; }

  // What linear() leaves out, in this order.
  Eigen::Vector3d Fourth(const RawSample& raw) const;
  Eigen::Vector3d OfForce(const Eigen::Vector3d& f_T) const;
  Eigen::Vector3d Refine(const Eigen::Vector3d& linear) const;

  /// Component of the readings along what no u explains, for four channels.
  double Parity(const RawSample& raw, const Eigen::Vector3d& u_T, const Eigen::Vector3d& f_T) const;

 private:
  using Squares3 = Eigen::Matrix<double, 3, 6>;
  void Offset();

  int n_channels_ = 0;
  bool second_order_ = false, feels_force_ = false, g_squared_ = false;
  std::array<std::size_t, SensorGroup::kChannels> channel_{};
  Eigen::Matrix<double, 3, 4> from_counts_ = Eigen::Matrix<double, 3, 4>::Zero();
  Eigen::Matrix<double, 3, 4> from_units_;  ///< [SI per unit]
  Eigen::Vector3d offset_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d from_force_ = Eigen::Matrix3d::Zero();
  Squares3 from_squares_, from_force_squares_;
  Eigen::Vector4d unit_per_count_, bias_, heating_, parity_;
  SensorGroup::Rows g_dependence_;
  SensorGroup::Squares squares_, g_squares_;
  double temperature_ = 0, lagged_ = 0, heating_rate_ = 0;
  bool settled_ = false;
};

}  // namespace wellgyro
