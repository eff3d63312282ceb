#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/estimate/setup.h"
#include "wellgyro/record/error_source.h"

namespace wellgyro {

/// Errors of one node: the drift of two gyros and a swing, or that of three.
inline constexpr int kNodeMax = 12;
/// Errors of the whole run, and one that a diagnosis takes out, see RowsWithout.
inline constexpr int kBorderMax = kRunErrorsMax + 1;
inline constexpr int kAbsent = -1;

using NodeVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kNodeMax, 1>;
using BorderVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kBorderMax, 1>;
using NodeMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kNodeMax, kNodeMax>;
using BorderMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kBorderMax, kBorderMax>;
/// Of a node, what follows it: the next node, then the border.
using BehindMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kNodeMax, kNodeMax + kBorderMax>;
/// Of a node and the border.
using EdgeMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kNodeMax + kBorderMax,
                                 kNodeMax + kBorderMax>;
using EdgeVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kNodeMax + kBorderMax, 1>;

/// Which columns the unknowns stand in. Of a node: attitude phi (R <- R Exp(phi)), roll rate,
/// depth, speed, and where the setup has them drift and swing. Of the border: the tool's constant
/// errors, those with a prior, and what the run shares.
struct Layout {
  int phi = 0, roll = 3, depth = 4, speed = 5;
  int gyros = 2;         ///< that drift: x, y and, where there is a third axis, z
  int walk = kAbsent;    ///< one of each gyro [rad/s]
  int markov = kAbsent;  ///< the same [rad/s]
  int swing = kAbsent;   ///< two, rate of roll in phase and in quadrature [rad/s]
  int node = 6;
  std::array<int, kErrorSources> source{};
  std::array<int, kErrorSources> change{};  ///< of these with the temperature
  bool second_order = false;                ///< some of these are the accelerometers' second order
  int ramp = kAbsent;                       ///< one of each gyro [rad/s^2]
  int latitude = kAbsent, gravity = kAbsent, gravity_gradient = kAbsent, depth_scale = kAbsent;
  int frequency = kAbsent;  ///< of the swing, beside that of the setup [rad/s]
  int border = 0;
  BorderVector sigma;        ///< priors of the border
  BorderMatrix information;  ///< inverse of their covariance
};

Layout LayoutOf(const EstimateSetup& setup);
/// Column of the border of an ErrorSource or another unknown of cause.h.
int BorderColumn(const Layout& layout, int unknown);

/// Of [node; border], those whose errors stay linked from node to node: attitude, drift, the
/// border.
std::vector<int> LinkedColumns(const Layout& layout);
/// The matrix that takes these from [node; border].
Eigen::MatrixXd LinkedRows(const Layout& layout);
/// Of `link`, which takes them from [node; border] of a node, that from [node; border] of the next,
/// where node = gain [next node; border].
void CarryLink(const Layout& layout, const BehindMatrix& gain, Eigen::MatrixXd& link);

/// The sigma in `setup` that an ErrorSource or another unknown of cause.h has; nullptr: it
/// cannot be an unknown.
double* PriorOf(int unknown, EstimateSetup& setup);

}  // namespace wellgyro
