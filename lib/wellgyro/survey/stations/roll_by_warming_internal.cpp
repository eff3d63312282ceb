#include "wellgyro/survey/stations/roll_by_warming_internal.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include <Eigen/Core>

#include "wellgyro/calibration/error_sources.h"
#include "wellgyro/record/run_fit.h"
#include "wellgyro/record/run_stretch.h"

namespace wellgyro {
namespace {

UtcTime MiddleOf(const RunStretch& stretch) {
  return stretch.begin + Duration::Seconds((stretch.end - stretch.begin).seconds() / 2);
}

/// Of the tool, between the means of stretches, of which there are two at least [degC].
double TemperatureOfRun(std::span<const RunStretch> stretches, UtcTime at) {
  std::size_t k = 1;
  while (k + 1 < stretches.size() && MiddleOf(stretches[k]) < at) ++k;
  const RunStretch &before = stretches[k - 1], &after = stretches[k];
  const double apart = (MiddleOf(after) - MiddleOf(before)).seconds();
  const double part = apart > 0 ? (at - MiddleOf(before)).seconds() / apart : 0;
  return before.temperature + std::clamp(part, 0.0, 1.0) * (after.temperature - before.temperature);
}

/// By how much each error turns the force f about the tool's axis [rad].
Eigen::VectorXd TurnOf(const CalibrationSources& sources, const Eigen::Vector3d& f) {
  Eigen::VectorXd turn = Eigen::VectorXd::Zero(sources.cov.rows());
  const Eigen::Index bias = sources.At("accel_bias_x"), scale = sources.At("accel_scale_x");
  const Eigen::Vector2d across(f.y(), -f.x());
  for (int axis = 0; axis < 2; ++axis) {
    turn[bias + axis] = across[axis] / across.squaredNorm();
    turn.segment<3>(scale + 3 * axis) = turn[bias + axis] * f;
  }
  return turn;
}

}  // namespace

double SigmaOfRollByWarming(const Job& job, const RunSummary& run, const NorthFix& fix) {
  const double seconds = (fix.utc_end - fix.utc_begin).seconds();
  if (!job.tool || !run.fit || run.fit->stretches.size() < 2 || !(seconds > 0)) return 0;
  const double begin = TemperatureOfRun(run.fit->stretches, fix.utc_begin);
  const double end = TemperatureOfRun(run.fit->stretches, fix.utc_end);
  const double I = fix.inclination, T = fix.toolface;
  const Eigen::Vector3d f =
      fix.gravity_ref *
      Eigen::Vector3d(std::sin(I) * std::cos(T), -std::sin(I) * std::sin(T), -std::cos(I));
  if (!(f.head<2>().squaredNorm() > 0)) return 0;
  const CalibrationSources change = ChangeOfSources(*job.tool, begin, end);
  const Eigen::VectorXd turn = TurnOf(change, f);
  return std::sqrt(std::max(0.0, turn.dot(change.cov * turn))) / seconds;
}

}  // namespace wellgyro
