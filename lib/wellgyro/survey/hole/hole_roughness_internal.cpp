#include "wellgyro/survey/hole/hole_roughness_internal.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/math/rotation.h"
#include "wellgyro/math/variance_components.h"

namespace wellgyro {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr std::size_t kAtOnce = 30;  // stations; the likelihood goes by the cube of it
// Listings are written to 1e-6 deg; it also keeps what is exactly straight regular [rad].
constexpr double kRounding = 2e-8;

enum Component : std::size_t { kKink, kWander };
// Three departures, of five stations, in two ways across: six numbers for two variances.
constexpr std::size_t kComponents = 2, kFewest = 3;

/// A station against the arc between its neighbours: t(k) - w t(k-1) - v t(k+1).
struct Departure {
  double above = 0, below = 0;  // courses [m]
  // Of the stations above, here and below [rad^2].
  double noise_above = 0, noise = 0, noise_below = 0;
  double high = 0, right = 0;  // [rad]

  double w() const { return below / (above + below); }
  double v() const { return above / (above + below); }
  /// Its variance by a unit variance of the component.
  double Unit(std::size_t component) const {
    const double bridge = above * below / (above + below);
    return component == kKink ? bridge : bridge * bridge * (above + below) / 3;
  }
};

std::vector<Departure> DeparturesOf(const RoughListing& listing, double begin, double end) {
  std::vector<Vector3d> t;
  std::vector<double> md, noise;
  const auto& stations = listing.well->survey;
  for (std::size_t k = 0; k < stations.size(); ++k) {
    const SurveyPoint& p = stations[k];
    if (p.md < begin || p.md > end) continue;
    t.push_back(Tangent(p.inclination, p.azimuth));
    md.push_back(p.md);
    noise.push_back(listing.noise[k]);
  }
  std::vector<Departure> departures;
  for (std::size_t k = 1; k + 1 < t.size(); ++k) {
    Departure d{md[k] - md[k - 1], md[k + 1] - md[k], noise[k - 1], noise[k], noise[k + 1]};
    const Vector3d off = t[k] - d.w() * t[k - 1] - d.v() * t[k + 1];
    const double level = std::hypot(t[k].x(), t[k].y());
    const double c = level > 1e-12 ? t[k].x() / level : 1, s = level > 1e-12 ? t[k].y() / level : 0;
    d.high = off.dot(Vector3d(t[k].z() * c, t[k].z() * s, -level));
    d.right = off.dot(Vector3d(-s, c, 0));
    departures.push_back(d);
  }
  return departures;
}

/// Covariance model of a listing's departures, source by source: a station's noise and the hole's
/// roughness in a leg reach those of its neighbours too. Each component in units of `unit`.
class Cluster {
 public:
  Cluster(std::span<const Departure> departures, std::span<const double> unit)
      : departures_(departures), unit_(unit) {
    cluster_.cells = {0};
    const auto n = static_cast<Index>(departures.size());
    for (Index row = 0; row < n; ++row) {
      cluster_.sources.push_back({{}, row, VectorXd::Constant(1, kRounding)});
    }
    for (Index station = -1; station <= n; ++station) AddNoise(station);
    for (Index leg = 0; leg <= n; ++leg) AddLeg(leg);
  }

  VarianceCluster Of(double Departure::*component) const {
    VarianceCluster cluster = cluster_;
    cluster.y.resize(static_cast<Index>(departures_.size()));
    for (Index k = 0; k < cluster.y.size(); ++k) cluster.y(k) = At(k).*component;
    return cluster;
  }

 private:
  const Departure& At(Index row) const { return departures_[static_cast<std::size_t>(row)]; }

  /// A source with its effects on rows from `first` on; rows that there are not are cut off.
  void Add(std::optional<Component> component, Index first, std::vector<double> effect) {
    const auto n = static_cast<Index>(departures_.size());
    while (first < 0 && !effect.empty()) effect.erase(effect.begin()), ++first;
    while (!effect.empty() && first + static_cast<Index>(effect.size()) > n) effect.pop_back();
    if (effect.empty()) return;
    const double unit = component ? unit_[*component] : 1;
    const VectorXd rows = Eigen::Map<VectorXd>(effect.data(), static_cast<Index>(effect.size()));
    cluster_.sources.push_back({component, first, rows * unit});
  }

  void AddNoise(Index station) {
    const auto n = static_cast<Index>(departures_.size());
    const double variance = station < 0    ? At(0).noise_above
                            : station == n ? At(n - 1).noise_below
                                           : At(station).noise;
    const double before = station > 0 ? -At(station - 1).v() : 0;
    const double after = station + 1 < n ? -At(station + 1).w() : 0;
    const double sigma = std::sqrt(variance);
    Add({}, station - 1, {before * sigma, sigma, after * sigma});
  }

  /// The leg that ends at the station of row `leg`: curvature in it moves that row by a ramp from
  /// its upper end, and the row above by one from its lower end.
  void AddLeg(Index leg) {
    const auto n = static_cast<Index>(departures_.size());
    const double length = leg < n ? At(leg).above : At(leg - 1).below;
    const double w = leg < n ? At(leg).w() : 0, v = leg > 0 ? At(leg - 1).v() : 0;
    Add(kKink, leg - 1, {-v * std::sqrt(length), w * std::sqrt(length)});
    // Integrals of x^2, x (h - x), (h - x)^2 are h^3 / 3, / 6, / 3.
    const double ramp = std::sqrt(length * length * length / 3);
    Add(kWander, leg - 1, {v * ramp / 2, w * ramp});
    Add(kWander, leg - 1, {v * ramp * std::sqrt(0.75), 0.0});
  }

  std::span<const Departure> departures_;
  std::span<const double> unit_;
  VarianceCluster cluster_;
};

/// Root of each component's variance were it the only one, by the mean square of the departures;
/// none where these are no more than rounding.
std::vector<double> UnitsOf(const std::vector<std::vector<Departure>>& listings) {
  std::vector<double> unit(kComponents, 0);
  double count = 0, squares = 0;
  for (const auto& listing : listings) {
    for (const Departure& d : listing) {
      const double square = d.high * d.high + d.right * d.right;
      count += 2;
      squares += square;
      for (std::size_t c = 0; c < kComponents; ++c) unit[c] += square / d.Unit(c);
    }
  }
  if (!(squares > count * kRounding * kRounding)) return {};
  for (double& u : unit) u = std::sqrt(u / count);
  return unit;
}

}  // namespace

double HoleRoughness::OffSpline(double length, double fraction, double other) const {
  const double middle = (66 * kink * length + 3 * wander * length * length * length) / 256;
  return 16 * middle * fraction * (1 - fraction) * other * (1 - other);
}

HoleRoughness RoughnessOf(std::span<const RoughListing> listings, double begin, double end) {
  std::vector<std::vector<Departure>> told;
  for (const RoughListing& listing : listings) {
    std::vector<Departure> departures = DeparturesOf(listing, begin, end);
    if (departures.size() >= kFewest) told.push_back(std::move(departures));
  }
  const std::vector<double> unit = UnitsOf(told);
  if (unit.empty()) return {};
  std::vector<VarianceCluster> clusters;
  for (const auto& listing : told) {
    const std::span<const Departure> all(listing);
    for (std::size_t at = 0; at < all.size(); at += kAtOnce) {
      const Cluster some(all.subspan(at, std::min(kAtOnce, all.size() - at)), unit);
      clusters.push_back(some.Of(&Departure::high));
      clusters.push_back(some.Of(&Departure::right));
    }
  }
  const VarianceStart start{std::vector<double>(kComponents, 1 / static_cast<double>(kComponents)),
                            std::vector<bool>(kComponents, false)};
  const VarianceFit fit = FitVariances(clusters, start);
  const auto value = [&](Component c) { return fit.components[c].value * unit[c] * unit[c]; };
  return {value(kKink), value(kWander)};
}

}  // namespace wellgyro
