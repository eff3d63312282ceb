#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "wellgyro/calibration/group_kernel_internal.h"
#include "wellgyro/calibration/group_model_internal.h"
#include "wellgyro/record/sample.h"
#include "wellgyro/record/tool_calibration.h"

namespace wellgyro {

/// Times [ns] for which temperatures of a piece hold: each stands at the next, the last before the
/// piece at its first. Even: a whole piece, all as the first.
struct HeatSteps {
  std::array<std::int64_t, kPiece> since;
  bool even = false;
};

/// SensorGroup's formula solved for u in T, at every temperature: solved in full at the ends and in
/// the middle of cells of temperature, between which A and b go by a parabola, and what else is
/// small beside u by a straight line. Cells are so narrow that u is right to 1e-9 of the larger of
/// itself and `unit`, terms of second order, in the force and in heating to 1e-5 of themselves; a
/// thermometer's reading in single precision is worth as much. What a sample becomes by this
/// depends on its own temperature alone.
class GroupSolution {
 public:
  /// No sensors.
  GroupSolution() = default;
  /// Of a group that the tool has; `unit`: a size of u that it measures well [SI].
  GroupSolution(const SensorGroup& group, double unit);

  /// Whether the other's calibrated range is the same.
  bool Shares(const GroupSolution& other) const {
    return first_.min == other.first_.min && first_.max == other.first_.max;
  }
  /// Makes its cells no wider than those of the other, which shares the range.
  void Narrow(const GroupSolution& other) {
    first_.per_width = std::max(first_.per_width, other.first_.per_width);
  }

  /// Whether the cell at hand holds this true temperature [degC].
  bool Holds(double temperature) const {
    double x = 0;
    cells_[at_].place.Find(temperature, x);
    return x >= 0 && x < 1 && cells_[at_].solved;
  }
  /// Makes its cell the one at hand; gives whether it was another.
  bool Enter(double temperature);
  const CellPlace& place() const { return cells_[at_].place; }      ///< of the cell at hand
  const GroupKernel& kernel() const { return cells_[at_].kernel; }  ///< of the cell at hand

  /// From this temperature on, as if it had always been so.
  void Settle(double temperature) {
    temperature_ = temperature;
    ahead_ = 0;
  }
  /// Heating rates [degC/s] at temperatures of n samples; see SensorGroup::heating_lag.
  void Heat(const HeatSteps& steps, std::size_t n, const double* temperature, float* rate);
  bool heats() const { return kernel().heats; }

  /// Component of the readings along what no u explains, for four channels, at a true temperature.
  double Parity(const RawSample& raw, double temperature, double heating_rate,
                const Eigen::Vector3d& u_T, const Eigen::Vector3d& f_T) const;

 private:
  struct Cell {
    bool solved = false;
    CellPlace place;
    GroupKernel kernel;
    GroupNode low, high;  ///< where the cell begins and ends
  };

  void Step(std::int64_t since);
  void Solve(Cell& cell, const Cell& other) const;
  /// The solution itself at a true temperature, which the cells stand for.
  GroupNode At(double temperature) const { return model_->At(model_->Tau(temperature)); }

  std::optional<GroupModel> model_;
  CellPlace first_;            ///< where the calibrated range begins
  std::array<Cell, 2> cells_;  ///< a reading at a border may come and go
  std::size_t at_ = 0;
  double temperature_ = 0, ahead_ = 0;  ///< the present; less the lagged [degC]
  double per_lag_ = 0, kept_ = 1;       ///< of `ahead_` after a step
  std::int64_t step_ns_ = 0;
};

}  // namespace wellgyro
