#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Dense>
#include <fmt/core.h>

#include "wellgyro/fit/tool_choice_internal.h"
#include "wellgyro/math/linear_algebra.h"
#include "wellgyro/math/statistics.h"

namespace wellgyro {
namespace {

bool Has(const std::vector<int>& places, int place) {
  return std::find(places.begin(), places.end(), place) != places.end();
}

// By how much the evidence of n coefficients rises by noise alone once in a hundred: their mean
// square r^2 in units of their variances is chi-square / n, and the prior's that suits them best.
double ByChance(std::size_t coefficients) {
  const double n = static_cast<double>(coefficients);
  const double r2 = ChiSquareQuantile(0.99, static_cast<int>(coefficients)) / n;
  return n * (r2 * r2 / (1 + r2) - std::log1p(r2));
}

}  // namespace

std::vector<Eigen::Index> PlacesIn(const std::vector<TermBundle>& bundles,
                                   const std::vector<int>& kept, int bundle) {
  Eigen::Index first = 0;
  for (const int place : kept) {
    const auto size =
        static_cast<Eigen::Index>(bundles[static_cast<std::size_t>(place)].terms.size());
    if (place == bundle) {
      std::vector<Eigen::Index> places;
      for (Eigen::Index k = 0; k < size; ++k) places.push_back(first + k);
      return places;
    }
    first += size;
  }
  return {};
}

TermChoice::TermChoice(const std::vector<TermBundle>& bundles, const std::vector<int>& seen,
                       const ToolAdjustment& full)
    : bundles_(bundles), seen_(seen) {
  std::vector<Eigen::Index> free;
  for (const int place : seen_) {
    if (At(place).needed) continue;
    const auto places = PlacesIn(bundles_, seen_, place);
    for (std::size_t k = 0; k < places.size(); ++k) {
      free_[place].push_back(static_cast<Eigen::Index>(free.size() + k));
    }
    free.insert(free.end(), places.begin(), places.end());
  }
  const Eigen::MatrixXd cov = full.cov(free, free);
  sigma_ = cov.diagonal().cwiseMax(1e-300).cwiseSqrt();
  const Eigen::VectorXd per = sigma_.cwiseInverse();
  W_ = InverseOfSymmetric(per.asDiagonal() * cov * per.asDiagonal());
  h_ = W_ * per.cwiseProduct(Eigen::VectorXd(full.x(free)));
}

std::vector<int> TermChoice::Best() const {
  // Of two choices whose odds are exp(5e-4) either will do; rounding of costs is far below.
  constexpr double kLess = 1e-3;
  std::vector<int> kept = Eliminated(seen_, {});
  double cost = Cost(kept);
  for (bool better = true; better;) {
    better = false;
    for (const int place : seen_) {
      if (Has(kept, place)) continue;
      const std::vector<int> back = WithBases(place);
      const std::vector<int> other = Eliminated(Joined(kept, back), back);
      const double its = Cost(other);
      if (!(its < cost - kLess)) continue;
      kept = other;
      cost = its;
      better = true;
    }
  }
  return kept;
}

std::vector<std::string> TermChoice::Rivals(const std::vector<int>& best) const {
  const double limit = Cost(best) + 2 * std::log(1000.0);
  std::vector<std::string> rivals;
  for (const int without : best) {
    if (At(without).needed) continue;
    const std::vector<int> other = Eliminated(Without(without), {});
    const std::string instead = NamesOf(other, best);
    if (instead.empty() || Cost(other) > limit) continue;
    rivals.push_back(fmt::format("{} could as well be {}", NamesOf(best, other), instead));
  }
  std::sort(rivals.begin(), rivals.end());
  rivals.erase(std::unique(rivals.begin(), rivals.end()), rivals.end());
  return rivals;
}

// Names of the bundles in `places` that are not in `others`, parted by commas.
std::string TermChoice::NamesOf(const std::vector<int>& places,
                                const std::vector<int>& others) const {
  std::string names;
  for (const int place : places) {
    if (!Has(others, place)) names += (names.empty() ? "" : ", ") + At(place).name;
  }
  return names;
}

std::vector<int> TermChoice::WithBases(int place) const {
  std::vector<int> all;
  for (int at = place; at >= 0; at = At(at).after) all.push_back(at);
  return all;
}

std::vector<int> TermChoice::Joined(const std::vector<int>& kept,
                                    const std::vector<int>& more) const {
  std::vector<int> all;
  for (const int place : seen_) {
    if (Has(kept, place) || Has(more, place)) all.push_back(place);
  }
  return all;
}

// All that is seen but a bundle and what makes no sense without it.
std::vector<int> TermChoice::Without(int base) const {
  std::vector<int> rest;
  for (const int place : seen_) {
    if (!Has(WithBases(place), base)) rest.push_back(place);
  }
  return rest;
}

// What costs more than it explains goes, one bundle a turn; never of `held`.
std::vector<int> TermChoice::Eliminated(std::vector<int> kept, const std::vector<int>& held) const {
  double cost = Cost(kept);
  while (true) {
    std::vector<int> best;
    for (const int place : kept) {
      const bool carries = std::any_of(kept.begin(), kept.end(),
                                       [&](int other) { return At(other).after == place; });
      if (At(place).needed || carries || Has(held, place)) continue;
      std::vector<int> fewer = kept;
      fewer.erase(std::find(fewer.begin(), fewer.end(), place));
      const double its = Cost(fewer);
      if (!(its < cost)) continue;
      cost = its;
      best = std::move(fewer);
    }
    if (best.empty()) return kept;
    kept = std::move(best);
  }
}

// Roots of the priors' variances of the kept coefficients [their sigmas in the full adjustment]: of
// each bundle the mean square of its coefficients where nothing else is kept.
Eigen::VectorXd TermChoice::PriorSigmas(const std::vector<int>& kept,
                                        const Eigen::VectorXd& theta) const {
  Eigen::VectorXd root(theta.size());
  Eigen::Index at = 0;
  for (const int place : kept) {
    if (At(place).needed) continue;
    const auto n = static_cast<Eigen::Index>(free_.at(place).size());
    const Eigen::VectorXd unit = sigma_(free_.at(place));
    const double square = theta.segment(at, n).cwiseProduct(unit).squaredNorm();
    root.segment(at, n) = std::sqrt(square / static_cast<double>(n)) * unit.cwiseInverse();
    at += n;
  }
  return root;
}

// Less evidence costs more; what noise alone gives a bundle is no evidence.
double TermChoice::Cost(const std::vector<int>& kept) const {
  double cost = 0;
  std::vector<Eigen::Index> places;
  for (const int place : kept) {
    if (At(place).needed) continue;
    const std::vector<Eigen::Index>& its = free_.at(place);
    cost += ByChance(its.size());
    places.insert(places.end(), its.begin(), its.end());
  }
  if (places.empty()) return cost;
  const auto n = static_cast<Eigen::Index>(places.size());
  const Eigen::MatrixXd W = W_(places, places);
  const Eigen::VectorXd h = h_(places);
  const Eigen::VectorXd root = PriorSigmas(kept, SolveSymmetric(W, h));
  const Cholesky M(Eigen::MatrixXd::Identity(n, n) + root.asDiagonal() * W * root.asDiagonal());
  const Eigen::VectorXd c = root.cwiseProduct(h);
  return cost + M.LogDeterminant() - M.Whitened(c).squaredNorm();
}

}  // namespace wellgyro
