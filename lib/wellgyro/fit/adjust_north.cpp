#include <algorithm>
#include <cmath>
#include <optional>

#include "wellgyro/base/angle.h"
#include "wellgyro/fit/adjust_north_internal.h"
#include "wellgyro/fit/selected_inverse_internal.h"

namespace wellgyro {
namespace {

constexpr int kTries = 12;                    // azimuths to start from
constexpr double kMargin = 9;                 // chi-square by which one must beat another
constexpr double kFar = 12;                   // chi-square beyond which nothing counts
constexpr double kNarrow = FromDegrees(0.5);  // sigma to which the cost is a parabola
constexpr double kWide = FromDegrees(3);      // step along the cost
constexpr double kSame = 1e-3;                // two tries that came to one [rad]
constexpr double kAlike = 0.9;                // ratio of two variances that are one
constexpr double kVague = 0.5;                // sigma of an azimuth that is as good as none [rad]

// Where the tries came to.
struct Minimum {
  double chi_square;
  std::vector<double> azimuths;  // of all nodes
};

std::vector<double> Turned(std::vector<double> azimuths, const AdjustSegment& segment, double by) {
  for (std::size_t k = segment.begin; k < segment.end; ++k) azimuths[k] += by;
  return azimuths;
}

std::vector<Minimum> Minima(const AdjustSegment& segment, const std::vector<double>& azimuths,
                            AdjustProblem* p) {
  std::vector<Minimum> minima;
  for (int i = 0; i < kTries; ++i) {
    StartFrom(Turned(azimuths, segment, i * kTwoPi / kTries), p);
    const AdjustOutcome outcome = Solve(p, nullptr);
    minima.push_back({outcome.chi_square, {}});
    for (std::size_t k = 0; k < p->node_count(); ++k) {
      minima.back().azimuths.push_back(p->azimuth(k));
    }
  }
  std::sort(minima.begin(), minima.end(),
            [](const Minimum& a, const Minimum& b) { return a.chi_square < b.chi_square; });
  return minima;
}

// The node whose azimuth is known best, by the curvature where the unknowns stand.
struct Reference {
  std::size_t node;
  double variance;
};

Reference BestKnown(const AdjustSegment& segment, AdjustProblem* p) {
  AdjustRows rows;
  Solve(p, &rows);
  Reference best{segment.end - 1, HUGE_VAL};
  if (rows.residual.empty()) return best;
  const Eigen::SparseMatrix<double> jacobian = rows.jacobian;
  const SelectedInverse inverse(jacobian.transpose() * jacobian);
  if (!inverse.ok()) return best;
  for (std::size_t k = std::max<std::size_t>(segment.begin, 1); k < segment.end; ++k) {
    const int at = static_cast<int>(k) * p->layout.node + AdjustLayout::kAzimuth;
    if (inverse.At(at, at) < best.variance) best = {k, inverse.At(at, at)};
  }
  return best;
}

// The posterior of the azimuth about the best, over those that hang together with it.
struct Basin {
  double low = 0, high = 0;  // against the best: where it is over [rad]
  double variance = 0;       // about the best [rad^2]
};

Basin BasinInSteps(const Minimum& best, const AdjustSegment& segment, std::size_t node, double step,
                   AdjustProblem* p) {
  Basin basin;
  double weights = 1, moment = 0;
  for (const int side : {-1, 1}) {
    double& edge = side < 0 ? basin.low : basin.high;
    for (double away = step; away <= kPi; away += step) {
      edge = side * away;
      StartFrom(Turned(best.azimuths, segment, edge), p);
      p->holds.push_back({p->spans[node - 1].epoch_end - 1, best.azimuths[node] + edge, 0});
      const double cost = Solve(p, nullptr).chi_square - best.chi_square;
      p->holds.pop_back();
      if (cost > kFar) break;
      weights += std::exp(-cost / 2);
      moment += std::exp(-cost / 2) * away * away;
    }
  }
  basin.variance = moment / weights;
  return basin;
}

Basin BasinAbout(const Minimum& best, const AdjustSegment& segment, const Reference& reference,
                 AdjustProblem* p) {
  const double curvature = reference.variance;
  constexpr double kSteps = 8;
  if (curvature < kNarrow * kNarrow) {
    const double edge = std::sqrt(kFar * curvature);
    return {-edge, edge, curvature};
  }
  double step = std::min(std::sqrt(curvature) / 2, kWide);
  Basin basin = BasinInSteps(best, segment, reference.node, step, p);
  while (basin.high - basin.low < kSteps * step && step > kNarrow / kSteps) {
    step /= 2;
    basin = BasinInSteps(best, segment, reference.node, step, p);
  }
  return basin;
}

}  // namespace

std::vector<AdjustSegment> SegmentsOf(const std::vector<AdjustSpan>& spans) {
  std::vector<AdjustSegment> segments{{0, 1}};
  for (std::size_t k = 0; k < spans.size(); ++k) {
    if (spans[k].broken) segments.push_back({k + 1, k + 1});
    segments.back().end = k + 2;
  }
  return segments;
}

AdjustNorth FindNorth(const AdjustSegment& segment, const std::vector<double>& azimuths,
                      AdjustProblem* p) {
  const std::vector<Minimum> minima = Minima(segment, azimuths, p);
  const Minimum& best = minima.front();
  StartFrom(best.azimuths, p);
  const Reference reference = BestKnown(segment, p);
  AdjustNorth north{.azimuth = best.azimuths[segment.end - 1],
                    .epoch = p->spans[reference.node - 1].epoch_end - 1};
  const auto rivals = [&](const auto& is_one) {
    return std::any_of(minima.begin(), minima.end(), [&](const Minimum& m) {
      const double away = WrapPi(m.azimuths[reference.node] - best.azimuths[reference.node]);
      return m.chi_square - best.chi_square < kMargin && is_one(away);
    });
  };
  const Basin basin = BasinAbout(best, segment, reference, p);
  north.var_beyond = std::max(0.0, basin.variance - reference.variance);
  if (basin.variance < kAlike * reference.variance) {
    north.var_hold = 1 / (1 / basin.variance - 1 / reference.variance);
  }
  north.ambiguous = basin.variance > kVague * kVague || rivals([&basin](double away) {
                      return away < basin.low - kSame || away > basin.high + kSame;
                    });
  return north;
}

}  // namespace wellgyro
