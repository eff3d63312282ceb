#pragma once

#include <span>
#include <utility>
#include <vector>

#include "wellgyro/base/time.h"
#include "wellgyro/depth/cable.h"
#include "wellgyro/depth/depth_grid.h"
#include "wellgyro/depth/depth_track.h"
#include "wellgyro/record/along_hole_block.h"
#include "wellgyro/survey/job.h"

namespace wellgyro {

/// Depth of one tool's sensor point: the track's, with what the cable's marks and the job's table
/// correct, and the way from the reference point down to the sensor.
class SensorDepth {
 public:
  /// `job`, `track` and `marks` must outlive this object.
  SensorDepth(const Job& job, const DepthTrack& track, CableMarks& marks);

  void SetSensorBelowReference(double metres) { sensor_below_reference_ = metres; }

  /// Depth over a sample from `utc` on is final where all marks up to `until` are in.
  bool Knows(UtcTime utc, Duration period, UtcTime until);
  /// At each of `utc`, whose clock may be wrong by `doubt` [s]; see DepthGrid.
  void At(std::span<const UtcTime> utc, DepthGrid::Asks asks, double doubt, AlongHoleBlock& along);
  /// From the reference point to the sensor; `doubt` as above.
  void ShiftToSensor(UtcTime utc, double doubt, AlongHole& along) const;

 private:
  const std::vector<std::pair<double, double>>& corrections_;
  CableMarks& marks_;
  DepthGrid grid_;
  bool corrects_;  ///< by the job's table or its cable's marks
  double sensor_below_reference_;
};

}  // namespace wellgyro
