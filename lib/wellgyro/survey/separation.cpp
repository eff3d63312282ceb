#include "wellgyro/survey/separation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "wellgyro/uncertainty/ellipse.h"

namespace wellgyro {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// A place on a survey: `fraction` of the way from station `from` to the next.
struct Place {
  std::size_t from = 0;
  double fraction = 0;
};

template <class T>
T At(const std::vector<T>& values, const Place& place) {
  const T& a = values[place.from];
  if (place.fraction == 0) return a;
  return a + place.fraction * (values[place.from + 1] - a);
}

std::size_t Known(const UncertainWell& w) { return w.errors->cov_p.size(); }

Place Closest(const UncertainWell& second, const Vector3d& point) {
  Place best;
  double least = std::numeric_limits<double>::infinity();
  const std::vector<Vector3d>& path = second.well->position;
  for (std::size_t k = 0; k + 1 < Known(second); ++k) {
    const Vector3d leg = path[k + 1] - path[k];
    const double u = std::clamp((point - path[k]).dot(leg) / leg.squaredNorm(), 0.0, 1.0);
    const double distance = (path[k] + u * leg - point).squaredNorm();
    if (distance < least) least = distance, best = {k, u};
  }
  return best;
}

std::optional<Place> SameDepth(const UncertainWell& second, double md) {
  const auto begin = second.well->survey.begin();
  const auto end = begin + static_cast<std::ptrdiff_t>(Known(second));
  if (md < begin->md || md > (end - 1)->md) return std::nullopt;
  const auto next =
      std::min(std::ranges::upper_bound(begin, end, md, {}, &SurveyPoint::md), end - 1);
  const auto before = next - 1;
  return Place{static_cast<std::size_t>(before - begin),
               (md - before->md) / (next->md - before->md)};
}

/// Shared sources of both, by index.
std::vector<std::pair<std::size_t, std::size_t>> Pairs(const PositionUncertainty& a,
                                                       const PositionUncertainty& b,
                                                       Pairing pairing) {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < a.shared.size(); ++i) {
    for (std::size_t j = 0; j < b.shared.size(); ++j) {
      const bool global = a.shared[i].propagation == Propagation::kGlobal;
      const bool alike = a.shared[i].term == b.shared[j].term &&
                         a.shared[i].propagation == b.shared[j].propagation;
      if (alike && (global || pairing == Pairing::kSameHole)) pairs.emplace_back(i, j);
    }
  }
  return pairs;
}

void Weigh(Separation& s) {
  s.distance = s.vector.norm();
  const bool meet = s.distance < 1e-9;
  const double variance = meet ? 0 : s.vector.dot(s.cov * s.vector) / s.vector.squaredNorm();
  s.sigma = meet ? Ellipsoid(s.cov, 0.5).semi_axes(0) / ConfidenceFactor(0.5, 3)
                 : std::sqrt(std::max(0.0, variance));
  if (s.sigma > 0) s.sigmas = s.distance / s.sigma;
}

}  // namespace

std::vector<Separation> Separations(const UncertainWell& first, const UncertainWell& second,
                                    Pairing pairing) {
  if (Known(first) < 2 || Known(second) < 2) {
    throw std::invalid_argument(
        "a separation needs two stations with covariances on either survey");
  }
  const auto pairs = Pairs(*first.errors, *second.errors, pairing);
  std::vector<Separation> all;
  for (std::size_t k = 0; k < Known(first); ++k) {
    Separation s;
    s.md = first.well->survey[k].md;
    const Vector3d& here = first.well->position[k];
    const auto place = pairing == Pairing::kSameHole ? SameDepth(second, s.md)
                                                     : std::optional(Closest(second, here));
    if (!place) continue;
    const auto& other = second.well->survey;
    s.other_md = other[place->from].md;
    if (place->fraction > 0) {
      s.other_md += place->fraction * (other[place->from + 1].md - other[place->from].md);
    }
    s.vector = At(second.well->position, *place) - here;
    s.cov = first.errors->cov_p[k] + At(second.errors->cov_p, *place);
    for (const auto& [i, j] : pairs) {
      const Vector3d& a = first.errors->shared[i].error_p[k];
      const Vector3d b = At(second.errors->shared[j].error_p, *place);
      s.cov -= a * b.transpose() + b * a.transpose();
    }
    Weigh(s);
    all.push_back(s);
  }
  return all;
}

}  // namespace wellgyro
