#pragma once

#include <cmath>
#include <cstdint>

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

  /// The heating rate takes `ns` at the present temperature; see SensorGroup::heating_lag.
  void Heat(std::int64_t ns) {
    if (!heats()) return;
    // Samples follow each other evenly.
    if (ns != step_ns_) {
      step_ns_ = ns;
      kept_ = std::exp(-1e-9 * static_cast<double>(ns) * per_lag_);
    }
    ahead_ *= kept_;
  }
  /// Forgets the heating so far.
  void Settle() { ahead_ = 0; }
  bool heats() const { return kernel_.heats; }
  double heating_rate() const { return ahead_ * per_lag_; }  ///< [degC/s]

  int n_channels() const { return kernel_.n_channels; }
  const GroupKernel& kernel() const { return kernel_; }

  /// Component of the readings along what no u explains, for four channels.
  double Parity(const RawSample& raw, const Eigen::Vector3d& u_T, const Eigen::Vector3d& f_T) const;

 private:
  GroupKernel kernel_;
  Eigen::Vector4d unit_per_count_, bias_, heating_, parity_;
  SensorGroup::Rows g_dependence_;
  SensorGroup::Squares squares_, g_squares_;
  double temperature_ = 0, ahead_ = 0;  ///< the present; less the lagged [degC]
  double per_lag_ = 0, kept_ = 1;       ///< of `ahead_` after a step
  std::int64_t step_ns_ = 0;
};

}  // namespace wellgyro
