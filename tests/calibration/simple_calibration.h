#pragma once

#include <algorithm>
#include <array>

#include <Eigen/Dense>

#include "wellgyro/record/sample.h"
#include "wellgyro/record/tool_calibration.h"

/// SensorGroup's formula solved for u sample by sample, as it stands, in double: the reference of
/// SampleCalibrator.
namespace wellgyro::test {

inline Eigen::Matrix<double, 6, 1> Products(const Eigen::Vector3d& a) {
  Eigen::Matrix<double, 6, 1> q;
  q << a.x() * a.x(), a.y() * a.y(), a.z() * a.z(), a.x() * a.y(), a.y() * a.z(), a.z() * a.x();
  return q;
}

template <class T>
T AtPower(const std::array<T, SensorGroup::kPowers>& powers, double tau) {
  T sum = powers[0];
  double power = 1;
  for (std::size_t n = 1; n < powers.size(); ++n) sum += (power *= tau) * powers[n];
  return sum;
}

/// u in T, and the largest of the terms that are small beside it.
struct SimpleSolution {
  Eigen::Vector3d u = Eigen::Vector3d::Zero();
  double small = 0;
};

/// Three or four channels at a true temperature, f in T, without heating.
inline SimpleSolution SolveSimply(const SensorGroup& group, const RawSample& raw,
                                  double temperature, const Eigen::Vector3d& f_T) {
  const double tau =
      (std::clamp(temperature, group.min, group.max) - group.reference) / group.half_range;
  const int n = group.n_channels;
  const Eigen::MatrixXd S = AtPower(group.sensitivity, tau).topRows(n);
  const Eigen::Vector3d f = group.R_TS.transpose() * f_T;
  const auto to_u = S.colPivHouseholderQr();
  Eigen::VectorXd v(n);
  for (int c = 0; c < n; ++c) {
    v[c] = raw.counts[static_cast<std::size_t>(group.channel[static_cast<std::size_t>(c)])] *
           group.unit_per_count[c];
  }
  v -= AtPower(group.bias, tau).head(n);
  const Eigen::VectorXd force =
      AtPower(group.g_dependence, tau).topRows(n) * f + group.g_squared.topRows(n) * Products(f);
  Eigen::VectorXd second = Eigen::VectorXd::Zero(n);
  Eigen::Vector3d u = to_u.solve(v - force);
  for (int turn = 0; turn < 10; ++turn) {
    second = group.second_order.topRows(n) * Products(u);
    u = to_u.solve(v - force - second);
  }
  SimpleSolution solution;
  solution.u = group.R_TS * u;
  solution.small = std::max(to_u.solve(force).norm(), to_u.solve(second).norm());
  return solution;
}

}  // namespace wellgyro::test
