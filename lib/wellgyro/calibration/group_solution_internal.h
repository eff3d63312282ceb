#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "wellgyro/calibration/group_kernel_internal.h"
#include "wellgyro/calibration/group_model_internal.h"
#include "wellgyro/record/sample.h"
#include "wellgyro/record/tool_calibration.h"

namespace wellgyro {

/// SensorGroup's formula solved for u in T, at every temperature: solved in full at the ends and in
/// the middle of cells of temperature, between which A and force go by a straight line, b by a
/// parabola, and what else is small beside u stays. Cells are so narrow that u is right to 1e-9 of
/// the larger of itself and `unit`, terms of second order, squares of the force and heating to 1e-5
/// of themselves; a thermometer's reading in single precision is worth as much. What a sample
/// becomes by this depends on its own temperature alone.
class GroupSolution {
 public:
  /// No sensors.
  GroupSolution() = default;
  /// Of a group that the tool has; `unit`: a size of u that it measures well [SI].
  GroupSolution(const SensorGroup& group, double unit);

  /// Whether the cell at hand holds this true temperature [degC] and sample period [s].
  bool Holds(double temperature, double seconds) const {
    const double place = Place(temperature);
    const Cell& cell = cells_[at_];
    return place >= cell.index && place < cell.index + 1 && seconds == cell.seconds;
  }
  /// Makes its cell the one at hand.
  void Enter(double temperature, double seconds);
  /// The temperature is now this one, of the cell at hand.
  void Take(double temperature) {
    ahead_ += temperature - temperature_;
    temperature_ = temperature;
    x_ = static_cast<float>(Place(temperature) - cells_[at_].index);
  }
  float x() const { return x_; }  ///< place in the cell, 0 to 1

  /// The heating rate takes `ns` at the present temperature; see SensorGroup::heating_lag.
  void Heat(std::int64_t ns) {
    // Samples follow each other evenly.
    if (ns != step_ns_) {
      step_ns_ = ns;
      kept_ = std::exp(-1e-9 * static_cast<double>(ns) * per_lag_);
    }
    ahead_ *= kept_;
  }
  /// Forgets the heating so far.
  void Settle() { ahead_ = 0; }
  bool heats() const { return heats_; }
  double heating_rate() const { return ahead_ * per_lag_; }  ///< [degC/s]

  const GroupKernel& kernel() const { return cells_[at_].kernel; }  ///< of the cell at hand

  /// Component of the readings along what no u explains, for four channels, at the temperature
  /// taken last.
  double Parity(const RawSample& raw, const Eigen::Vector3d& u_T, const Eigen::Vector3d& f_T) const;
  /// The solution itself at a true temperature, which the cells stand for.
  GroupNode At(double temperature, double seconds) const {
    return model_->At(model_->Tau(temperature), seconds);
  }

 private:
  struct Cell {
    double index = 0;  ///< a whole number
    double seconds = -1;
    GroupKernel kernel;
  };

  void Solve(Cell& cell) const;
  double Place(double temperature) const {
    return (std::min(std::max(temperature, min_), max_) - min_) * per_width_;
  }

  std::optional<GroupModel> model_;
  GroupKernel constant_;                                  ///< what does not change with temperature
  double min_ = 0, max_ = 0, width_ = 1, per_width_ = 1;  ///< [degC], [1/degC]
  std::array<Cell, 2> cells_;                             ///< a reading at a border may come and go
  std::size_t at_ = 0;
  float x_ = 0;
  bool heats_ = false;
  double temperature_ = 0, ahead_ = 0;  ///< the present; less the lagged [degC]
  double per_lag_ = 0, kept_ = 1;       ///< of `ahead_` after a step
  std::int64_t step_ns_ = 0;
};

}  // namespace wellgyro
