#pragma once

#include <array>

#include <Eigen/Core>

#include "wellgyro/record/sample.h"
#include "wellgyro/record/tool_calibration.h"

namespace wellgyro {

/// SensorGroup's formula solved for u in T at one temperature, and what it was solved from:
///   u = A counts + b - u_by_force_T f - force_products q(f) - heat dT/dt - products q(u)
/// Where channels count pulses, their counts are per second.
struct GroupNode {
  Eigen::Matrix<double, 3, 4> A = Eigen::Matrix<double, 3, 4>::Zero();
  Eigen::Vector3d b_T = Eigen::Vector3d::Zero(), heat_T = b_T;
  Eigen::Matrix3d u_by_force_T = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 6> products = Eigen::Matrix<double, 3, 6>::Zero(),
                              force_products = products;
};

/// A group of sensors in T: its polynomials in tau. For a group that the tool has.
class GroupModel {
 public:
  explicit GroupModel(const SensorGroup& group);

  /// tau at a temperature [degC], held at the ends of the calibrated range.
  double Tau(double temperature) const;
  SensorGroup::Rows Sensitivity(double tau) const;
  SensorGroup::Column Bias(double tau) const;
  SensorGroup::Column unit_per_count() const { return group_.unit_per_count; }
  GroupNode At(double tau) const;
  /// Component of the readings along what no u explains, of four channels; sample period in
  /// seconds.
  double Parity(const RawSample& raw, double tau, double seconds, double heating_rate,
                const Eigen::Vector3d& u_T, const Eigen::Vector3d& f_T) const;

 private:
  SensorGroup group_;  ///< with S, G and the products in T
  bool heats_ = false, feels_force_ = false, second_order_ = false, g_squared_ = false;
};

}  // namespace wellgyro
