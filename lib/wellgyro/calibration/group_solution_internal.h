#pragma once

#include <cmath>

#include <Eigen/Core>

#include "wellgyro/calibration/group_kernel_internal.h"
#include "wellgyro/record/sample.h"
#include "wellgyro/record/tool_calibration.h"

namespace wellgyro {

/// SensorGroup's formula solved for u in T, at one temperature and sample period.
class GroupSolution {
 public:
  /// Takes the group at the true temperature `temperature` [degC] and sample period `seconds`.
  /// Gives whether the temperature is inside the calibrated range.
  bool Prepare(const SensorGroup& group, double temperature, double seconds);

  /// The heating rate takes `seconds` at the present temperature; see SensorGroup::heating_lag.
  void Heat(double seconds) {
    // Samples follow each other evenly.
    if (seconds != step_seconds_) {
      step_seconds_ = seconds;
      step_ = -std::expm1(-seconds * per_lag_);
    }
    lagged_ += (temperature_ - lagged_) * step_;
    heating_rate_ = (temperature_ - lagged_) * per_lag_;
  }
  /// Forgets the heating so far.
  void Settle();
  bool heats() const { return kernel_.heats; }
  double heating_rate() const { return heating_rate_; }  ///< [degC/s]

  int n_channels() const { return kernel_.n_channels; }
  const GroupKernel& kernel() const { return kernel_; }

  /// Component of the readings along what no u explains, for four channels.
  double Parity(const RawSample& raw, const Eigen::Vector3d& u_T, const Eigen::Vector3d& f_T) const;

 private:
  GroupKernel kernel_;
  Eigen::Vector4d unit_per_count_, bias_, heating_, parity_;
  SensorGroup::Rows g_dependence_;
  SensorGroup::Squares squares_, g_squares_;
  double temperature_ = 0, lagged_ = 0, heating_rate_ = 0;
  double per_lag_ = 0, step_ = 0,
         step_seconds_ = 0;  ///< of the lagged temperature towards the present
  bool settled_ = false;
};

}  // namespace wellgyro
