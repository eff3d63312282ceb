#include "wellgyro/survey/hole/hole_line.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "wellgyro/math/rotation.h"

namespace wellgyro {
namespace {

using Eigen::Vector3d;

double RadiusAt(std::span<const HoleSection> sections, double md) {
  if (sections.empty()) return 0;
  const auto holds = [md](const HoleSection& s) { return md <= s.end_md; };
  const auto at = std::ranges::find_if(sections, holds);
  return at == sections.end() ? sections.back().radius : at->radius;
}

/// The largest on the leg: a section may begin in it.
double WidestOn(std::span<const HoleSection> sections, double begin, double end) {
  double widest = std::max(RadiusAt(sections, begin), RadiusAt(sections, end));
  for (const HoleSection& s : sections) {
    if (s.end_md > begin && s.end_md <= end) widest = std::max(widest, s.radius);
  }
  return widest;
}

void CheckSections(std::span<const HoleSection> sections) {
  double above = -INFINITY;
  for (const HoleSection& s : sections) {
    if (!(s.radius >= 0) || !std::isfinite(s.radius) || !(s.end_md > above)) {
      throw std::invalid_argument("sections of a hole must go down and have radii not below 0");
    }
    above = s.end_md;
  }
}

}  // namespace

LegTree HoleLine::TreeOf(const UncertainWell& well, std::span<const HoleSection> sections) {
  CheckSections(sections);
  const std::size_t n = well.errors->cov_p_W.size();
  if (n < 2) {
    throw std::invalid_argument(
        "a separation needs two stations with covariances on either survey");
  }
  std::vector<LegArc> legs;
  std::vector<LegReach> reach;
  legs.reserve(n - 1);
  reach.reserve(n - 1);
  const auto& survey = well.well->survey;
  Vector3d from = Tangent(survey[0].inclination, survey[0].azimuth);
  double variance = well.errors->cov_p_W[0].norm();
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const Vector3d to = Tangent(survey[i + 1].inclination, survey[i + 1].azimuth);
    legs.push_back(MakeLegArc(well.well->position_W[i], survey[i + 1].md - survey[i].md, from, to));
    // Frobenius norm >= largest eigenvalue >= variance in any direction.
    const double next = well.errors->cov_p_W[i + 1].norm();
    reach.push_back({std::max(variance, next), WidestOn(sections, survey[i].md, survey[i + 1].md)});
    from = to;
    variance = next;
  }
  return LegTree(std::move(legs), reach);
}

HoleLine::HoleLine(const UncertainWell& well, std::span<const HoleSection> sections)
    : well_(well), sections_(sections.begin(), sections.end()), tree_(TreeOf(well, sections)) {}

HoleLine::Place HoleLine::Station(std::size_t i) const {
  if (i < tree_.legs().size()) return {i, 0};
  return {i - 1, tree_.legs()[i - 1].length};
}

double HoleLine::Fraction(const Place& place) const {
  return place.s / tree_.legs()[place.leg].length;
}

double HoleLine::Md(const Place& place) const {
  const auto& survey = well_.well->survey;
  if (Fraction(place) == 1) return survey[place.leg + 1].md;
  return survey[place.leg].md + place.s;
}

Vector3d HoleLine::Position(const Place& place) const {
  if (Fraction(place) == 1) return well_.well->position_W[place.leg + 1];
  return PointOn(tree_.legs()[place.leg], place.s);
}

Vector3d HoleLine::Direction(const Place& place) const {
  return DirectionOn(tree_.legs()[place.leg], place.s);
}

Eigen::Matrix3d HoleLine::Cov(const Place& place) const {
  const auto& cov = well_.errors->cov_p_W;
  const double f = Fraction(place);
  return (1 - f) * cov[place.leg] + f * cov[place.leg + 1];
}

Vector3d HoleLine::Shared(std::size_t i, const Place& place) const {
  const auto& error = well_.errors->shared[i].error_p_W;
  const double f = Fraction(place);
  return (1 - f) * error[place.leg] + f * error[place.leg + 1];
}

double HoleLine::Radius(double md) const { return RadiusAt(sections_, md); }

}  // namespace wellgyro
