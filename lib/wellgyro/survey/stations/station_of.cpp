#include "wellgyro/survey/stations/station_of.h"

#include <algorithm>

#include "wellgyro/math/rotation.h"
#include "wellgyro/survey/hole/hole_attitude.h"

namespace wellgyro {
namespace {

/// Of the tool's unit axis [rad^2].
Eigen::Matrix3d CovarianceOfAxis(const AttitudeSample& tool, const StationState* state) {
  if (state) {
    const auto& slope = state->tangent_by_phi_L;
    return slope * state->cov.topLeftCorner<3, 3>() * slope.transpose();
  }
  const Eigen::Matrix<double, 3, 2> slope = TangentByAngles(tool.inclination, tool.azimuth);
  return slope * tool.cov_attitude.topLeftCorner<2, 2>() * slope.transpose();
}

}  // namespace

Station StationOf(const Job& job, const Draft& draft, const StationState* state) {
  const AttitudeSample& tool = state ? state->attitude : draft.attitude;
  Station s = draft.station;
  s.toolface = tool.toolface;
  s.quality |= tool.quality;
  s.tangent_L = TangentOfHole(tool, job.string);
  s.cov_tangent_L = CovarianceOfTangent(s.tangent_L, CovarianceOfAxis(tool, state), job.string);
  DeriveAngles(tool.azimuth, s);
  double sigma_md = job.errors.depth_sigma;
  if (state) sigma_md = std::max(sigma_md, state->along.sigma_md);
  s.cov_md_inc_azi(0, 0) = sigma_md * sigma_md;
  return s;
}

}  // namespace wellgyro
