#include "wellgyro/survey/hole/kick_off.h"

#include <algorithm>
#include <stdexcept>

#include <Eigen/Core>

#include "wellgyro/survey/hole/same_depth_internal.h"
#include "wellgyro/trajectory/trajectory.h"

namespace wellgyro {
namespace {

template <class T>
void DropFirst(std::vector<T>& values, std::size_t count) {
  const auto n = static_cast<std::ptrdiff_t>(std::min(count, values.size()));
  values.erase(values.begin(), values.begin() + n);
}

}  // namespace

std::size_t StationAt(std::vector<SurveyPoint>& stations, std::vector<ToolLeg>& legs, double md) {
  const auto next = std::ranges::lower_bound(stations, md - kRoundedDepth, {}, &SurveyPoint::md);
  const auto at = static_cast<std::size_t>(next - stations.begin());
  if (next != stations.end() && next->md <= md + kRoundedDepth) return at;
  if (next == stations.end() || at == 0) {
    throw std::domain_error("the kick-off is outside the survey");
  }
  const SurveyPoint ends[] = {*(next - 1), *next};
  const double depths[] = {ends[0].md, ends[1].md};
  const double inclinations[] = {ends[0].inclination, ends[1].inclination};
  const double azimuths[] = {ends[0].azimuth, ends[1].azimuth};
  const Trajectory leg(depths, inclinations, azimuths, Eigen::Vector3d::Zero());
  const TrajectoryPoint point = leg.AtMd(md);
  stations.insert(next, {md, point.inclination, point.azimuth, 0});
  for (ToolLeg& tool : legs) {
    if (tool.begin > at) ++tool.begin;
    if (tool.end > at) ++tool.end;
  }
  return at;
}

KnownWell FromStation(const KnownWell& known, std::size_t first) {
  KnownWell rest = known;
  DropFirst(rest.well.survey, first);
  DropFirst(rest.well.position_W, first);
  DropFirst(rest.errors.cov_p_W, first);
  for (SharedError& shared : rest.errors.shared) DropFirst(shared.error_p_W, first);
  for (TermUncertainty& term : rest.errors.terms) DropFirst(term.cov_p_W, first);
  if (rest.errors.cov_p_W.size() < 2) {
    throw std::domain_error("no two stations with covariances are left below the kick-off");
  }
  return rest;
}

}  // namespace wellgyro
