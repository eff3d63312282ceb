#pragma once

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/record/attitude_sample.h"
#include "wellgyro/survey/job.h"

namespace wellgyro {

/// Where the hole points, with the covariance of (inclination, azimuth) [rad^2].
struct HoleAttitude {
  Eigen::Vector3d tangent_L = Eigen::Vector3d::UnitZ();
  double inclination = 0;  ///< [rad]
  double azimuth = 0;      ///< true [rad], [0, 2 pi)
  Eigen::Matrix2d cov = Eigen::Matrix2d::Zero();
};

/// From the tool's attitude to the hole's: the tool is not the hole.
///
/// R_TH of the string stands between: the tool axis leans by (misalignment_x, misalignment_y) in
/// its own axes, and hangs below the hole axis by sag sin I. Both are corrected exactly on the
/// direction vector, their sigmas added to first order: sigma_sag sin I to the inclination,
/// sigma_misalignment to it and, over sin I, to the azimuth. The azimuth variance never exceeds
/// pi^2/3, that of no knowledge at all.
WELLGYRO_EXPORT HoleAttitude AttitudeOfHole(const AttitudeSample& tool, const StringSpec& string);

/// Covariance of the hole's unit tangent [rad^2], of that of the tool's axis. Regular at every
/// inclination: the string's errors are of directions too.
WELLGYRO_EXPORT Eigen::Matrix3d CovarianceOfTangent(const HoleAttitude& hole,
                                                    const Eigen::Matrix3d& cov_axis_L,
                                                    const StringSpec& string);

/// True direction in which the reference mark points, over the horizontal plane [rad]; the error of
/// the azimuth passes into it one to one. Degenerate only for a horizontal tool with the mark
/// straight up or down, where it is the azimuth of the axis or its opposite.
WELLGYRO_EXPORT double DirectionOfMark(const AttitudeSample& tool);

}  // namespace wellgyro
