#include "wellgyro/survey/listing_errors_internal.h"

#include <algorithm>

#include "wellgyro/math/rotation.h"
#include "wellgyro/trajectory/leg_arc.h"

namespace wellgyro {
namespace {

using Eigen::Vector3d;

std::vector<Vector3d> TangentsOf(const SurveyedWell& well) {
  std::vector<Vector3d> tangents;
  tangents.reserve(well.survey.size());
  for (const SurveyPoint& p : well.survey) tangents.push_back(Tangent(p.inclination, p.azimuth));
  return tangents;
}

/// One factor's errors of one station.
struct Here {
  Vector3d direction = Vector3d::Zero();
  double md = 0;
};

}  // namespace

std::vector<ListedPlace> PlacesIn(const SurveyedWell& well, std::span<const double> depths) {
  const std::vector<Vector3d> t = TangentsOf(well);
  const auto& stations = well.survey;
  const auto bend_of = [&](std::size_t below) -> Vector3d {
    return (t[below] - t[below - 1]) / (stations[below].md - stations[below - 1].md);
  };
  std::vector<ListedPlace> places;
  places.reserve(depths.size());
  for (const double md : depths) {
    const auto next = std::ranges::lower_bound(stations, md, {}, &SurveyPoint::md);
    const auto at = static_cast<std::size_t>(next - stations.begin());
    ListedPlace place;
    place.below = std::clamp<std::size_t>(at, 1, stations.size() - 1);
    const SurveyPoint &a = stations[place.below - 1], &b = stations[place.below];
    place.fraction = std::clamp((md - a.md) / (b.md - a.md), 0.0, 1.0);
    const LegArc arc =
        MakeLegArc(Vector3d::Zero(), b.md - a.md, t[place.below - 1], t[place.below]);
    place.tangent = place.fraction == 1 ? t[place.below] : DirectionOn(arc, md - a.md);
    place.bend = bend_of(place.below);
    // At a station the listing bends differently above and below it.
    if (place.fraction == 1 && place.below + 1 < stations.size()) {
      place.bend = (place.bend + bend_of(place.below + 1)) / 2;
    }
    places.push_back(place);
  }
  return places;
}

ListingErrors::ListingErrors(const SurveyedWell& well, const SurveyErrors& errors,
                             std::span<const double> depths)
    : well_(well), errors_(errors), tangent_(TangentsOf(well)), places_(PlacesIn(well, depths)) {}

void ListingErrors::Carry(std::span<const StationError> factor, ListedErrors& listed) const {
  const std::size_t rows = places_.size();
  listed.direction.assign(rows, Vector3d::Zero());
  listed.position.assign(rows, Vector3d::Zero());
  const std::size_t begin = factor.front().station == 0 ? 1 : factor.front().station;
  const std::size_t end = factor.back().station + 1;  // the leg below the last is wrong too
  auto next = factor.begin();
  const auto take = [&](std::size_t station, Vector3d& displacement) {
    Here here;
    displacement.setZero();
    for (; next != factor.end() && next->station == station; ++next) {
      here.direction += next->direction;
      here.md += next->md;
      displacement += next->displacement;
    }
    return here;
  };
  const auto is_below = [](const ListedPlace& p, std::size_t k) { return p.below < k; };
  std::size_t row = static_cast<std::size_t>(
      std::lower_bound(places_.begin(), places_.end(), begin, is_below) - places_.begin());
  listed.first = row;
  Vector3d sum = Vector3d::Zero(), displacement;
  Here above;
  if (factor.front().station == 0) above = take(0, displacement);
  for (std::size_t k = begin; k <= std::min(end, tangent_.size() - 1); ++k) {
    const Here here = take(k, displacement);
    const double course = well_.survey[k].md - well_.survey[k - 1].md;
    if (k == 1 && errors_.doubled_tie_on) above.direction = here.direction;
    // Depths count from the datum, not from the first station.
    const double md_above = k == 1 ? 0 : above.md;
    for (; row < rows && places_[row].below == k; ++row) {
      const ListedPlace& p = places_[row];
      const double f = p.fraction;
      const Vector3d e = (1 - f) * above.direction + f * here.direction;
      const double md = (1 - f) * above.md + f * here.md;
      listed.direction[row] = e - p.bend * md;
      listed.position[row] = sum + f * course / 2 * (above.direction + e) +
                             (md - md_above) / 2 * (tangent_[k - 1] + p.tangent) +
                             f * displacement - p.tangent * md;
    }
    sum += course / 2 * (above.direction + here.direction) +
           (here.md - md_above) / 2 * (tangent_[k - 1] + tangent_[k]) + displacement;
    above = here;
  }
  listed.last = row;
  for (; row < rows; ++row) listed.position[row] = sum;
}

}  // namespace wellgyro
