#pragma once

#include <optional>

#include "wellgyro/base/time.h"
#include "wellgyro/estimate/setup.h"
#include "wellgyro/record/along_hole.h"
#include "wellgyro/record/attitude_sample.h"
#include "wellgyro/record/north_fix.h"
#include "wellgyro/survey/job.h"

namespace wellgyro {

/// Azimuths that a run's own gyros do not give: the job's external one and the magnetic azimuth of
/// a stop. Each is given once: what is wrong with one magnetic azimuth is wrong with all.
class OutsideAzimuth {
 public:
  /// `job` must outlive this object.
  explicit OutsideAzimuth(const Job& job);

  /// The job's azimuth, where it holds at the run's begin.
  std::optional<AzimuthTie> AtBegin();
  /// The job's azimuth as the north of a tool with this attitude at an instant for which it holds.
  std::optional<NorthFix> At(ToolTime time, UtcTime utc, const AlongHole& along,
                             const AttitudeSample& tool);
  /// By the magnetic azimuth of a stop, where the job has it tie the run.
  std::optional<NorthFix> Magnetic(const NorthFix& stop);

 private:
  double OfAxis(const AttitudeSample& tool) const;

  const Job& job_;
  bool external_pending_, magnet_pending_;
};

}  // namespace wellgyro
