#pragma once

#include <optional>

#include "wellgyro/earth/earth.h"
#include "wellgyro/record/along_hole.h"
#include "wellgyro/record/attitude_sample.h"
#include "wellgyro/survey/job.h"

namespace wellgyro {

/// The site of a run on its way: latitude and height by dead reckoning along the hole, from the
/// job's tie-in. A kilometre is 1e-2 deg and 0.1 mg, so that an azimuth off by degrees does not
/// matter; where none is known only the height follows.
class PathSite {
 public:
  /// `job` must outlive this object.
  explicit PathSite(const Job& job);

  const Site& site() const { return site_; }
  /// To where the run begins.
  void Begin(const AlongHole& along);
  /// On to the place `along`, where the tool has this attitude.
  void Move(const AlongHole& along, const AttitudeSample& attitude);

 private:
  void Place();

  const Job& job_;
  Site site_;
  double north_ = 0, tvd_ = 0;  // [m]
  std::optional<double> md_;    // of the place reached last [m]
};

}  // namespace wellgyro
