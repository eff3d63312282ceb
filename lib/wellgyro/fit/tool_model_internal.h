#pragma once

#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/fit/tool_rows_internal.h"
#include "wellgyro/fit/tool_terms_internal.h"

namespace wellgyro {

/// Sigmas of the readings, by what made them.
struct ToolNoise {
  double accel = 1, gyro = 1, gyro_table = 1;  ///< of a reading [its unit]
  double wobble = 0;                           ///< of its attitude, about each axis [rad]
  double wobble_table = 0;  ///< on the rate table, which has an axis of its own [rad]
  double WobbleOf(const ToolRow& row) const { return row.mount >= 0 ? wobble_table : wobble; }
};

/// To a hundredth of each sigma.
inline bool Alike(const ToolNoise& a, const ToolNoise& b) {
  const auto same = [](double x, double y) { return std::abs(x - y) <= 0.01 * std::abs(y); };
  return same(a.accel, b.accel) && same(a.gyro, b.gyro) && same(a.gyro_table, b.gyro_table) &&
         same(a.wobble, b.wobble) && same(a.wobble_table, b.wobble_table);
}

/// Readings of the tool as functions of the terms' coefficients, and behind them of what the bench
/// has: level (about north and east), north and zero of inclination of each table, seats on the
/// rate table and the scale of its rates, latitude.
class ToolModel {
 public:
  ToolModel(const ToolReadings& readings, const ToolFitSetup& setup, std::vector<ToolTerm> terms);

  int n_terms() const { return static_cast<int>(terms_.size()); }
  int size() const { return n_terms() + static_cast<int>(nuisances_.size()); }
  const std::vector<ToolTerm>& terms() const { return terms_; }
  /// Of the bench: names, and in `prior_sigma` what was known before.
  const std::vector<BenchNuisance>& nuisances() const { return nuisances_; }
  std::vector<std::string> names() const;

  struct Prediction {
    Eigen::VectorXd v;       ///< of the row's channels
    Eigen::MatrixXd J;       ///< by all parameters
    Eigen::MatrixXd wobble;  ///< by small turns of the tool about the bench's axes
  };
  Prediction At(const ToolRow& row, const Eigen::VectorXd& x) const;

  /// Inverse of the lower root of a row's covariance.
  Eigen::MatrixXd Whitener(const ToolRow& row, const Eigen::MatrixXd& wobble,
                           const ToolNoise& noise) const;

 private:
  struct State;
  State StateOf(const ToolRow& row, const Eigen::VectorXd& x) const;
  void AtRest(const ToolRow& row, const Eigen::VectorXd& z, double latitude, State& state) const;
  void OnTable(const ToolRow& row, const Eigen::VectorXd& z, double latitude, State& state) const;
  void AddNuisances();

  const ToolReadings& readings_;
  const ToolFitSetup& setup_;
  std::vector<ToolTerm> terms_;
  std::vector<std::vector<int>> terms_of_;  ///< by channel
  std::vector<BenchNuisance> nuisances_;
  /// Places among the nuisances, by table; by mount.
  std::vector<int> level_, inclination_, rate_scale_, mount_;
  int latitude_ = -1;
};

}  // namespace wellgyro
