#include "wellgyro/survey/hole/common_courses_internal.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "wellgyro/math/rotation.h"
#include "wellgyro/survey/hole/well_line.h"
#include "wellgyro/trajectory/trajectory.h"

namespace wellgyro {

using Eigen::Vector3d;

std::vector<double> CommonStations(const SurveyedWell& first, const SurveyedWell& second,
                                   double begin, double end) {
  const auto below = [&](const SurveyedWell& well, double md) -> std::optional<double> {
    const auto next = std::ranges::upper_bound(well.survey, md, {}, &SurveyPoint::md);
    if (next == well.survey.end() || next->md >= end) return std::nullopt;
    return next->md;
  };
  std::vector<double> depths = {begin};
  for (;;) {
    const auto a = below(first, depths.back()), b = below(second, depths.back());
    if (!a || !b) break;
    depths.push_back(std::max(*a, *b));
  }
  depths.push_back(end);
  return depths;
}

CommonCourses::CommonCourses(const SurveyedWell& well, std::span<const double> common,
                             std::span<const double> depths) {
  std::vector<SurveyPoint> stations;
  for (const SurveyPoint& p : well.survey) {
    if (p.md < common.front()) stations.push_back(p);
  }
  first_common_ = stations.size();
  const std::vector<ListedPlace> own = PlacesIn(well, common);
  for (std::size_t k = 0; k < common.size(); ++k) {
    const bool first = own[k].fraction == 0;
    if (first || own[k].fraction == 1) {
      stations.push_back(well.survey[first ? 0 : own[k].below]);
      continue;
    }
    const Vector3d& t = own[k].smooth_W;
    stations.push_back({common[k], InclinationOf(t), AzimuthOf(t), 0});
  }
  well_ = SurveyWell(std::move(stations), well.position_W.front());
  for (const SurveyPoint& p : well_.survey) tangent_W_.push_back(Tangent(p.inclination, p.azimuth));
  places_ = PlacesIn(well_, depths);
  const Trajectory line = LineOf(well_);
  for (const double md : depths) position_W_.push_back(line.AtMd(md).position_W);
}

std::vector<double> CommonCourses::stations() const {
  std::vector<double> depths;
  for (const SurveyPoint& p : well_.survey) depths.push_back(p.md);
  return depths;
}

std::vector<Vector3d> CommonCourses::Displaced(const ListedErrors& errors) const {
  const std::size_t rows = places_.size();
  std::vector<Vector3d> position(rows, Vector3d::Zero());
  const std::size_t begin = std::max<std::size_t>(errors.first, 1);
  const auto is_below = [](const ListedPlace& p, std::size_t k) { return p.below < k; };
  std::size_t row = static_cast<std::size_t>(
      std::lower_bound(places_.begin(), places_.end(), begin, is_below) - places_.begin());
  Vector3d sum = Vector3d::Zero();
  for (std::size_t k = begin; k < std::min(errors.last + 1, tangent_W_.size()); ++k) {
    const double course = well_.survey[k].md - well_.survey[k - 1].md;
    const Vector3d &above = errors.measured_W[k - 1], &here = errors.measured_W[k];
    // Depths count from the datum, not from the first station.
    const double md_above = k == 1 ? 0 : errors.md[k - 1];
    const Vector3d displacement = errors.displacements_W[k] - errors.displacements_W[k - 1];
    for (; row < rows && places_[row].below == k; ++row) {
      const ListedPlace& p = places_[row];
      const double f = p.fraction;
      const double md = (1 - f) * errors.md[k - 1] + f * errors.md[k];
      position[row] = sum + f * course / 2 * ((2 - f) * above + f * here) +
                      (md - md_above) / 2 * (tangent_W_[k - 1] + p.tangent_W) + f * displacement -
                      p.tangent_W * md;
    }
    sum += course / 2 * (above + here) +
           (errors.md[k] - md_above) / 2 * (tangent_W_[k - 1] + tangent_W_[k]) + displacement;
  }
  for (; row < rows; ++row) position[row] = sum;
  return position;
}

}  // namespace wellgyro
