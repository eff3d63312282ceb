#pragma once

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/record/attitude_sample.h"
#include "wellgyro/survey/job.h"

namespace wellgyro {

/// Unit tangent of the hole by the tool's attitude: the tool is not the hole.
///
/// R_TH of the string stands between: the tool axis leans by (misalignment_x, misalignment_y) in
/// its own axes, and hangs below the hole axis by sag sin I. Both are corrected exactly on the
/// direction vector.
WELLGYRO_EXPORT Eigen::Vector3d TangentOfHole(const AttitudeSample& tool, const StringSpec& string);

/// Its covariance [rad^2], of that of the tool's axis: to first order sigma_misalignment across in
/// every direction, and sigma_sag sin I towards the high side. Regular at every inclination.
WELLGYRO_EXPORT Eigen::Matrix3d CovarianceOfTangent(const Eigen::Vector3d& tangent_L,
                                                    const Eigen::Matrix3d& cov_axis_L,
                                                    const StringSpec& string);

/// True direction in which the reference mark points, over the horizontal plane [rad]; the error of
/// the azimuth passes into it one to one. Degenerate only for a horizontal tool with the mark
/// straight up or down, where it is the azimuth of the axis or its opposite.
WELLGYRO_EXPORT double DirectionOfMark(const AttitudeSample& tool);

}  // namespace wellgyro
