#include "wellgyro/survey/hole/path_site.h"

#include <algorithm>
#include <cmath>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/record/limits.h"

namespace wellgyro {

PathSite::PathSite(const Job& job)
    : job_(job),
      site_(SiteAt(job.well.latitude, job.well.datum_elevation - job.tie_in.tvd.value_or(0))),
      north_(job.tie_in.north),
      tvd_(job.tie_in.tvd.value_or(0)) {
  Place();
}

void PathSite::Begin(const AlongHole& along) {
  if (!along.known || !std::isfinite(along.md)) return;
  // Where a run begins below the tie-in, the hole between counts as vertical.
  tvd_ += std::max(along.md - job_.tie_in.md, 0.0);
  md_ = along.md;
  Place();
}

void PathSite::Move(const AlongHole& along, const AttitudeSample& attitude) {
  if (!md_) return Begin(along);
  if (!along.known || !std::isfinite(along.md)) return;
  const Eigen::Vector3d way = (along.md - *md_) * Tangent(attitude.inclination, attitude.azimuth);
  tvd_ += way.z();
  if (attitude.azimuth_known) north_ += way.x();
  md_ = along.md;
  Place();
}

void PathSite::Place() {
  // Damaged depths may lead anywhere; the site stays on the Earth.
  tvd_ = std::clamp(tvd_, -limits::kMd, limits::kMd);
  north_ = std::clamp(north_, -limits::kMd, limits::kMd);
  const double latitude = job_.well.latitude + north_ / site_.radius_north;
  site_ = SiteAt(std::clamp(latitude, -kPi / 2, kPi / 2), job_.well.datum_elevation - tvd_);
}

}  // namespace wellgyro
