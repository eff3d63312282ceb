#include "wellgyro/survey/wells/separation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/golden_section.h"
#include "wellgyro/uncertainty/ellipse.h"

namespace wellgyro {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Place = HoleLine::Place;

constexpr double kMeet = 1e-9;  // [m], rounding of 500 legs in 10 km, 10 km eps = 2e-12 each
// [m], along hole, as tables print it; at a minimum a factor changes by the square of it.
constexpr double kPlaceResolution = 1e-3;

/// Shared sources of both, by index.
std::vector<std::pair<std::size_t, std::size_t>> Pairs(const PositionUncertainty& a,
                                                       const PositionUncertainty& b,
                                                       Pairing pairing, Correlation correlation) {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  if (correlation == Correlation::kNone) return pairs;
  const bool wells = pairing == Pairing::kSameHole || correlation == Correlation::kFull;
  for (std::size_t i = 0; i < a.shared.size(); ++i) {
    for (std::size_t j = 0; j < b.shared.size(); ++j) {
      const bool alike = a.shared[i].term == b.shared[j].term &&
                         a.shared[i].propagation == b.shared[j].propagation;
      const bool global = a.shared[i].propagation == Propagation::kGlobal;
      if (alike && (global || wells)) pairs.emplace_back(i, j);
    }
  }
  return pairs;
}

std::optional<Place> SameDepth(const HoleLine& line, double md) {
  const auto begin = line.well().well->survey.begin();
  const auto end = begin + static_cast<std::ptrdiff_t>(line.stations());
  if (md < begin->md || md > (end - 1)->md) return std::nullopt;
  const auto next =
      std::min(std::ranges::upper_bound(begin, end, md, {}, &SurveyPoint::md), end - 1);
  const auto leg = static_cast<std::size_t>(next - begin) - 1;
  return Place{leg, md - (next - 1)->md};
}

/// The nearest of the places where `line` goes through the plane across `across` at `point`.
std::optional<Place> InPlane(const HoleLine& line, const Vector3d& point, const Vector3d& across) {
  std::optional<Place> best;
  double least = std::numeric_limits<double>::infinity();
  const auto take = [&](std::size_t leg, double s) {
    const double distance = (line.Position({leg, s}) - point).norm();
    if (distance < least) least = distance, best = Place{leg, s};
  };
  const auto& legs = line.tree().legs();
  for (std::size_t i = 0; i < legs.size(); ++i) {
    const double nearest = NearestOn(legs[i], point);
    const Vector3d there = PointOn(legs[i], nearest);
    const bool lies_in = std::abs((legs[i].begin_W - point).dot(across)) < kMeet &&
                         std::abs((there - point).dot(across)) < kMeet &&
                         std::abs(DirectionOn(legs[i], nearest).dot(across)) < 1e-12;
    if (lies_in) take(i, nearest);
    const PlaneCrossings at = CrossingsOfPlane(legs[i], point, across);
    for (int c = 0; c < at.count; ++c) take(i, at.s[c]);
  }
  return best;
}

/// Makes the rows of a separation table for two lines.
class PairOfLines {
 public:
  PairOfLines(const HoleLine& first, const HoleLine& second, Pairing pairing,
              const SeparationRule& rule)
      : first_(first),
        second_(second),
        pairing_(pairing),
        rule_(rule),
        shared_(Pairs(*first.well().errors, *second.well().errors, pairing, rule.correlation)) {}

  std::optional<Separation> At(const Place& place, Separation::Kind kind) const;
  std::optional<double> FactorAt(const Place& place) const;
  /// Rows inside leg `i` of the first, between the rows of its ends.
  void AddMinima(std::size_t i, std::vector<Separation>& rows) const;

 private:
  std::optional<Place> Opposite(const Place& place) const;
  void Weigh(Separation& s) const;
  void Look(Separation& s, const Place& place) const;
  double LowestIn(std::size_t leg, double low, double high) const;

  const HoleLine& first_;
  const HoleLine& second_;
  Pairing pairing_;
  const SeparationRule& rule_;
  std::vector<std::pair<std::size_t, std::size_t>> shared_;
};

std::optional<Place> PairOfLines::Opposite(const Place& place) const {
  if (pairing_ == Pairing::kSameHole) return SameDepth(second_, first_.Md(place));
  const Vector3d here = first_.Position(place);
  switch (rule_.scan) {
    case Scan::kHorizontal:
      return InPlane(second_, here, Vector3d::UnitZ());
    case Scan::kTravellingCylinder:
      return InPlane(second_, here, first_.Direction(place));
    case Scan::kNearest:
      break;
  }
  const LegTree::Place nearest = second_.tree().Nearest(here);
  return Place{nearest.leg, nearest.s};
}

void PairOfLines::Weigh(Separation& s) const {
  s.distance = s.vector_W.norm();
  const bool meet = s.distance < kMeet;
  const double variance =
      meet ? 0 : s.vector_W.dot(s.cov_W * s.vector_W) / s.vector_W.squaredNorm();
  s.sigma = meet ? Ellipsoid(s.cov_W, 0.5).semi_axes(0) / ConfidenceFactor(0.5, 3)
                 : std::sqrt(std::max(0.0, variance));
  if (s.sigma > 0) s.sigmas = s.distance / s.sigma;
  const double radius = rule_.k * std::hypot(s.sigma, rule_.sigma_ahead);
  const double clear = s.distance - s.holes - rule_.surface_margin;
  s.allowed = radius + s.holes + rule_.surface_margin;
  if (!(radius > 0)) return;
  s.factor = clear / radius;
  if (rule_.surface == ErrorSurface::kPedal || meet) return;
  const Matrix3d all = s.cov_W + rule_.sigma_ahead * rule_.sigma_ahead * Matrix3d::Identity();
  const Eigen::LLT<Matrix3d> solver(all);
  if (solver.info() != Eigen::Success) return;
  const Vector3d way = s.vector_W * (clear / s.distance);
  s.factor = std::copysign(std::sqrt(way.dot(solver.solve(way))) / rule_.k, clear);
}

void PairOfLines::Look(Separation& s, const Place& place) const {
  const Vector3d t = first_.Direction(place);
  const double across = std::hypot(t.x(), t.y());
  const auto& survey = first_.well().well->survey;
  const double azimuth = across > 0 ? std::atan2(t.y(), t.x()) : survey[place.leg].azimuth;
  const Vector3d high(t.z() * std::cos(azimuth), t.z() * std::sin(azimuth), -across);
  const Vector3d right(-std::sin(azimuth), std::cos(azimuth), 0);
  s.toolface = WrapTwoPi(std::atan2(s.vector_W.dot(right), s.vector_W.dot(high)));
  s.high_side = WrapTwoPi(azimuth);
}

std::optional<Separation> PairOfLines::At(const Place& place, Separation::Kind kind) const {
  const std::optional<Place> other = Opposite(place);
  if (!other) return std::nullopt;
  Separation s;
  s.kind = kind;
  s.md = first_.Md(place);
  s.other_md = second_.Md(*other);
  s.position_W = first_.Position(place);
  s.vector_W = second_.Position(*other) - s.position_W;
  s.cov_W = first_.Cov(place) + second_.Cov(*other);
  for (const auto& [i, j] : shared_) {
    const Vector3d a = first_.Shared(i, place), b = second_.Shared(j, *other);
    s.cov_W -= a * b.transpose() + b * a.transpose();
  }
  s.holes = first_.Radius(s.md) + second_.Radius(s.other_md);
  Weigh(s);
  Look(s, place);
  return s;
}

std::optional<double> PairOfLines::FactorAt(const Place& place) const {
  const auto row = At(place, Separation::Kind::kLowest);
  return row ? row->factor : std::nullopt;
}

/// Golden section search: where in [low, high] of the leg the factor is least.
double PairOfLines::LowestIn(std::size_t leg, double low, double high) const {
  const auto factor = [&](double s) { return FactorAt({leg, s}).value_or(0); };
  double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
  double fa = factor(a), fb = factor(b);
  while (high - low > kPlaceResolution) {
    if (fa < fb) {
      high = b, b = a, fb = fa;
      a = high - kGolden * (high - low), fa = factor(a);
    } else {
      low = a, a = b, fa = fb;
      b = low + kGolden * (high - low), fb = factor(b);
    }
  }
  return (low + high) / 2;
}

void PairOfLines::AddMinima(std::size_t i, std::vector<Separation>& rows) const {
  // Parts of a leg at whose ends the factor is evaluated. The minimum is then sought in the two
  // parts beside the least: half a leg, in which the distance of two arcs of a stand has one
  // minimum.
  constexpr int kParts = 4;
  const LegArc& leg = first_.tree().legs()[i];
  const Place ends[] = {{i, 0}, {i, leg.length}};
  const auto begin = At(ends[0], Separation::Kind::kStation);
  const auto end = At(ends[1], Separation::Kind::kStation);
  const LegTree::Pair pair = second_.tree().Nearest(leg);
  const double nearer = std::min(begin->distance, end->distance) - 1e-6;
  std::vector<Separation> found;
  if (pair.place.distance < nearer) found.push_back(*At({i, pair.s}, Separation::Kind::kNearest));
  double factors[kParts + 1];
  for (int p = 0; p <= kParts; ++p) {
    factors[p] = FactorAt({i, leg.length * p / kParts}).value_or(0);
  }
  const auto* least = std::min_element(factors, factors + kParts + 1);
  const auto at = static_cast<int>(least - factors);
  const double part = leg.length / kParts;
  const double s = LowestIn(i, std::max(0, at - 1) * part, std::min(kParts, at + 1) * part);
  const auto lowest = At({i, s}, Separation::Kind::kLowest);
  const bool known = !found.empty() && std::abs(found[0].md - lowest->md) < 10 * kPlaceResolution;
  if (lowest->factor && *lowest->factor < std::min(factors[0], factors[kParts]) - 1e-6 && !known) {
    found.push_back(*lowest);
  }
  std::ranges::sort(found, {}, &Separation::md);
  std::ranges::move(found, std::back_inserter(rows));
}

}  // namespace

std::vector<Separation> Separations(const HoleLine& first, const HoleLine& second, Pairing pairing,
                                    const SeparationRule& rule) {
  const PairOfLines pair(first, second, pairing, rule);
  const bool between = rule.minima && pairing == Pairing::kTwoWells && rule.scan == Scan::kNearest;
  std::vector<Separation> rows;
  for (std::size_t k = 0; k < first.stations(); ++k) {
    if (auto row = pair.At(first.Station(k), Separation::Kind::kStation)) rows.push_back(*row);
    if (between && k + 1 < first.stations()) pair.AddMinima(k, rows);
  }
  return rows;
}

const Separation* Lowest(const std::vector<Separation>& rows) {
  const auto below = [](const Separation& a, const Separation& b) {
    if (a.factor && b.factor) return *a.factor < *b.factor;
    return a.distance < b.distance;
  };
  const auto lowest = std::ranges::min_element(rows, below);
  return lowest == rows.end() ? nullptr : &*lowest;
}

bool MayFallBelow(const HoleLine& first, const HoleLine& second, const SeparationRule& rule,
                  double factor) {
  const double ahead = rule.sigma_ahead * rule.sigma_ahead;
  const bool independent = rule.correlation == Correlation::kNone;
  const auto near = [&](double distance, const LegReach& a, const LegReach& b) {
    // Shared errors may add up, to the sum of both sigmas at the most.
    const double sum = std::sqrt(a.variance) + std::sqrt(b.variance);
    const double variance = independent ? a.variance + b.variance : sum * sum;
    const double clear = distance - a.radius - b.radius - rule.surface_margin;
    return clear < factor * rule.k * std::sqrt(variance + ahead);
  };
  return LegTree::AnyNear(first.tree(), second.tree(), near);
}

}  // namespace wellgyro
