#include "wellgyro/survey/run/provisional.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "wellgyro/earth/earth.h"
#include "wellgyro/survey/stations/assemble.h"
#include "wellgyro/survey/stations/choose.h"
#include "wellgyro/survey/stations/station_of.h"

namespace wellgyro {

bool ProvisionalPath::Start(const Station& first) {
  const TieIn& tie = job_.tie_in;
  const bool at_tie = std::abs(first.md - tie.md) <= TieInReach(job_);
  if (!tie.inclination && !at_tie) return false;
  const PathStation opening = tie.inclination
                                  ? PathStation{tie.md, *tie.inclination, *tie.azimuth}
                                  : PathStation{tie.md, first.inclination, first.azimuth};
  path_.emplace(SiteAt(job_.well.latitude, job_.well.datum_elevation), opening,
                Eigen::Vector3d(tie.north, tie.east, tie.tvd.value_or(0)));
  points_ = {path_->last()};
  covs_W_ = {tie.cov_p_WT_W};
  return true;
}

void ProvisionalPath::Extend(Station& station, const StationState* state) {
  if (state) {
    if (!covariance_) {
      covariance_.emplace(covs_W_.back(), job_.errors.depth_sigma, TimeAlongHole::kWithDepth);
    }
    station.cov_p_WT_W = covariance_->Add(*state);
  }
  const auto point = path_->Add({station.md, station.inclination, station.azimuth});
  if (!point) {
    station.p_WT_W = path_->last().p_WT_W;
    return;
  }
  station.p_WT_W = point->p_WT_W;
  station.dogleg_severity = point->dogleg_severity;
  points_.push_back(*point);
  covs_W_.push_back(station.cov_p_WT_W);
}

void ProvisionalPath::LayOn(Station& station) const {
  const auto below =
      std::lower_bound(points_.begin(), points_.end(), station.md,
                       [](const PathPoint& p, double md) { return p.station.md < md; });
  const auto i = static_cast<std::size_t>(below - points_.begin());
  if (below == points_.begin() || below == points_.end()) {
    const std::size_t end = below == points_.begin() ? 0 : points_.size() - 1;
    station.p_WT_W = points_[end].p_WT_W;
    station.cov_p_WT_W = covs_W_[end];
    return;
  }
  const Site head = SiteAt(job_.well.latitude, job_.well.datum_elevation);
  station.p_WT_W = Interpolate(head, points_[i - 1], points_[i], station.md).p_WT_W;
  station.cov_p_WT_W = covs_W_[i];
}

std::optional<Station> ProvisionalPath::Place(const Draft& draft, const StationState* state) {
  Station station = StationOf(job_, draft, state);
  if (!path_ && !Start(station)) return std::nullopt;
  const bool in = station.pass == Pass::kIn;
  if (in && pass_number_ == 0) pass_number_ = station.pass_number;
  const bool extends = in && station.pass_number == pass_number_;
  if (extends && station.md > points_.back().station.md) {
    Extend(station, state);
  } else {
    // A station of a stop comes again when the job turns out to list it.
    const bool again = state && told_ && state->knot <= *told_;
    if (extends && state && covariance_ && !again) covariance_->Skip(*state);
    LayOn(station);
  }
  if (extends && state) told_ = std::max(told_.value_or(state->knot), state->knot);
  if (!draft.listed || station.md <= job_.tie_in.md + kSameDepth) return std::nullopt;
  return station;
}

}  // namespace wellgyro
