#include "wellgyro/survey/run/outside_azimuth.h"

#include "wellgyro/base/angle.h"
#include "wellgyro/survey/hole/hole_attitude.h"
#include "wellgyro/survey/run/estimated_run.h"

namespace wellgyro {

OutsideAzimuth::OutsideAzimuth(const Job& job)
    : job_(job),
      external_pending_(job.alignment.method == AlignmentSpec::Method::kExternal),
      magnet_pending_(job.magnetic && job.magnetic->tie) {}

std::optional<AzimuthTie> OutsideAzimuth::AtBegin() {
  const AlignmentSpec& spec = job_.alignment;
  if (!external_pending_ || spec.at_md || spec.at_utc) return std::nullopt;
  external_pending_ = false;
  return AzimuthTie{0, spec.azimuth, spec.sigma_azimuth, spec.of == AlignmentSpec::Of::kMark};
}

std::optional<NorthFix> OutsideAzimuth::At(ToolTime time, UtcTime utc, const AlongHole& along,
                                           const AttitudeSample& tool) {
  if (!external_pending_) return std::nullopt;
  external_pending_ = false;
  NorthFix fix;
  fix.begin = fix.end = time;
  fix.utc_begin = fix.utc_end = utc;
  fix.md = along.md;
  fix.inclination = tool.inclination;
  fix.toolface = tool.toolface;
  fix.azimuth = OfAxis(tool);
  fix.cov_attitude(1, 1) = job_.alignment.sigma_azimuth * job_.alignment.sigma_azimuth;
  return fix;
}

std::optional<NorthFix> OutsideAzimuth::Magnetic(const NorthFix& stop) {
  if (!magnet_pending_ || !stop.magnetic_azimuth || Has(stop.quality, Quality::kVertical)) {
    return std::nullopt;
  }
  magnet_pending_ = false;
  NorthFix tie;
  tie.md = stop.md;
  tie.begin = tie.end = stop.begin;
  tie.utc_begin = tie.utc_end = stop.utc_begin;
  tie.inclination = stop.inclination;
  tie.toolface = stop.toolface;
  tie.magnetic_azimuth = stop.magnetic_azimuth;
  tie.azimuth = WrapTwoPi(*stop.magnetic_azimuth + job_.magnetic->declination);
  tie.cov_attitude(1, 1) = job_.magnetic->sigma * job_.magnetic->sigma;
  return tie;
}

/// The job's azimuth as that of the axis of a tool at this inclination and toolface.
double OutsideAzimuth::OfAxis(const AttitudeSample& tool) const {
  if (job_.alignment.of == AlignmentSpec::Of::kAxis) return job_.alignment.azimuth;
  AttitudeSample at_zero;
  at_zero.inclination = tool.inclination;
  at_zero.toolface = tool.toolface;
  return job_.alignment.azimuth - DirectionOfMark(at_zero);
}

}  // namespace wellgyro
