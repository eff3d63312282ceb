#include "wellgyro/survey/hole/listing_errors_internal.h"

#include <algorithm>

#include "wellgyro/math/rotation.h"
#include "wellgyro/math/spline.h"
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

/// d(tangent)/d(md) of the hole at its stations, by a spline [1/m].
std::vector<Vector3d> BendsOf(const SurveyedWell& well, std::span<const Vector3d> tangents) {
  std::vector<double> md;
  for (const SurveyPoint& p : well.survey) md.push_back(p.md);
  return SplineSlopes(md, tangents);
}

/// Errors of one station by one error source.
struct Here {
  Vector3d direction = Vector3d::Zero(), displacement = Vector3d::Zero();
  double md = 0;
};

std::vector<ListedPlace> Places(const SurveyedWell& well, const std::vector<Vector3d>& t,
                                const std::vector<Vector3d>& bend, std::span<const double> depths) {
  const auto& stations = well.survey;
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
    place.tangent_W = place.fraction == 1 ? t[place.below] : DirectionOn(arc, md - a.md);
    const double f = place.fraction;
    const Vector3d &bend_a = bend[place.below - 1], &bend_b = bend[place.below];
    place.bend_W = (1 - f) * bend_a + f * bend_b;
    // Cubic Hermite interpolation: the chord, and what the slopes at its ends differ from it by.
    const Vector3d chord = t[place.below] - t[place.below - 1];
    place.smooth_W =
        (t[place.below - 1] + f * chord +
         f * (1 - f) *
             ((1 - f) * (arc.length * bend_a - chord) - f * (arc.length * bend_b - chord)))
            .normalized();
    places.push_back(place);
  }
  return places;
}

}  // namespace

std::vector<ListedPlace> PlacesIn(const SurveyedWell& well, std::span<const double> depths) {
  const std::vector<Vector3d> tangents = TangentsOf(well);
  return Places(well, tangents, BendsOf(well, tangents), depths);
}

ListingErrors::ListingErrors(const SurveyedWell& well, const SurveyErrors& errors,
                             std::span<const double> depths)
    : errors_(errors) {
  const std::vector<Vector3d> tangents = TangentsOf(well);
  bend_W_ = BendsOf(well, tangents);
  places_ = Places(well, tangents, bend_W_, depths);
}

void ListingErrors::Carry(std::span<const StationError> factor, ListedErrors& listed) const {
  const std::size_t rows = places_.size();
  listed.direction_W.assign(rows, Vector3d::Zero());
  listed.measured_W.assign(rows, Vector3d::Zero());
  listed.md.assign(rows, 0);
  listed.displacements_W.assign(rows, Vector3d::Zero());
  const std::size_t begin = factor.front().station == 0 ? 1 : factor.front().station;
  const std::size_t end = factor.back().station + 1;  // the leg below the last is wrong too
  auto next = factor.begin();
  const auto take = [&](std::size_t station) {
    Here here;
    for (; next != factor.end() && next->station == station; ++next) {
      here.direction += next->direction_W;
      here.md += next->md;
      here.displacement += next->displacement_W;
    }
    return here;
  };
  const auto is_below = [](const ListedPlace& p, std::size_t k) { return p.below < k; };
  std::size_t row = static_cast<std::size_t>(
      std::lower_bound(places_.begin(), places_.end(), begin, is_below) - places_.begin());
  listed.first = row;
  Vector3d displaced = Vector3d::Zero();
  Here above;
  if (factor.front().station == 0) above = take(0);
  for (std::size_t k = begin; k <= std::min(end, bend_W_.size() - 1); ++k) {
    const Here here = take(k);
    if (k == 1 && errors_.doubled_tie_on) above.direction = here.direction;
    for (; row < rows && places_[row].below == k; ++row) {
      const double f = places_[row].fraction;
      listed.measured_W[row] = (1 - f) * above.direction + f * here.direction;
      listed.md[row] = (1 - f) * above.md + f * here.md;
      listed.direction_W[row] =
          listed.measured_W[row] - (1 - f) * above.md * bend_W_[k - 1] - f * here.md * bend_W_[k];
      listed.displacements_W[row] = displaced + f * here.displacement;
    }
    displaced += here.displacement;
    above = here;
  }
  listed.last = row;
  for (; row < rows; ++row) listed.displacements_W[row] = displaced;
}

}  // namespace wellgyro
