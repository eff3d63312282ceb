#pragma once

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/simulate/run_plan.h"
#include "wellgyro/simulate/simulation.h"
#include "wellgyro/simulate/truth_well.h"

namespace wellgyro {

/// Everything true at one instant of the run.
struct TruthState {
  double time = 0;         ///< since the begin of the run [s]
  double md = 0;           ///< of the sensor point [m]
  double speed = 0;        ///< [m/s]
  double inclination = 0;  ///< [rad]
  double azimuth = 0;      ///< of the axis at its own meridian, [0, 2 pi); 0 at vertical [rad]
  double toolface = 0;     ///< [0, 2 pi) [rad]
  Eigen::Vector3d p_WT_W = Eigen::Vector3d::Zero();  ///< north, east, TVD [m]
  double latitude = 0;                               ///< [rad]
  double longitude = 0;                              ///< [rad]
  double height = 0;                                 ///< [m]
  Eigen::Matrix3d R_LT = Eigen::Matrix3d::Identity();
  bool still = false;  ///< neither moving nor turning
};

/// What perfect sensors at the sensor point feel, in T.
struct SensorTruth {
  Eigen::Vector3d w_IT_T = Eigen::Vector3d::Zero();  ///< [rad/s]
  Eigen::Vector3d f_T = Eigen::Vector3d::Zero();     ///< [m/s^2]
  Eigen::Vector3d b_T = Eigen::Vector3d::Zero();     ///< [T]
};

/// The run as it truly was. Before its begin and after its end the tool is at rest.
///
/// Rates contain the Earth's rate and the transport rate of L at the tool's own latitude; specific
/// force contains the acceleration along the hole, the turn of the velocity, 2 w_IE + w_EL times
/// velocity, and gravity at latitude and depth (ellipsoid.h). All are analytic.
class WELLGYRO_EXPORT Truth {
 public:
  /// Throws std::invalid_argument, naming the field, where the parts do not fit each other.
  explicit Truth(const Simulation& simulation);

  /// Length of the run [s].
  double seconds() const { return plan_.seconds(); }
  const TruthWell& well() const { return well_; }
  const RunPlan& plan() const { return plan_; }

  TruthState At(double time) const;
  SensorTruth SensorsAt(double time) const;
  /// Means over [begin, end], taken in the turning tool's axes, the accelerometers at `lever_arm_T`
  /// [m] from the sensor point. By Gauss-Legendre quadrature over stretches short against every
  /// motion of the run: the angles summed over an hour are right to 1e-10 rad.
  SensorTruth MeanOver(double begin, double end,
                       const Eigen::Vector3d& lever_arm_T = Eigen::Vector3d::Zero()) const;

 private:
  struct Pose;
  Pose PoseAt(double time) const;
  void AddStretch(double begin, double end, const Eigen::Vector3d& lever_arm_T,
                  SensorTruth& sum) const;

  SimulatedEarth earth_;
  RollReference roll_reference_;
  TruthWell well_;
  RunPlan plan_;
};

}  // namespace wellgyro
