#include "wellgyro/depth/stop_match.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "wellgyro/math/median.h"

namespace wellgyro {
namespace {

constexpr double kSearch = 5;  // [s], width of the first search: 1e-4 of 14 h
// [s], between offsets that are not the same: a rest off by it at both edges is worth exp(-16).
constexpr double kOffsetsApart = 4 * kSearch;
constexpr double kNearly = 0.8;  // of the best one's worth: four stops for its five
// Worth of two rests 3.6 s off at each edge; one alone is worth 1 at most.
constexpr double kTwoRests = 1.2;
// Scales at which an edge counts no more: 95 % efficient (Holland and Welsch, Commun. Stat. A6,
// 1977).
constexpr double kTukey = 4.685;
constexpr double kScaleLeast = 0.01;  // [s]: no clock notes a stop to less, 1 cm at 1 m/s
// In 2000 draws of 3 to 100 rests, up to a fifth of the edges 10 s off, the offset stays within
// 0.01 sigma of its limit from round 5 on (median), from round 19 on in 99 %.
constexpr int kRounds = 30;

/// A rest in seconds of its own clock.
struct Span {
  double begin, end;
  double middle() const { return 0.5 * (begin + end); }
  double length() const { return end - begin; }
};

template <class Clock>
std::vector<Span> Seconds(std::span<const Rest<Clock>> rests, Instant<Clock> zero) {
  std::vector<Span> spans;
  for (const Rest<Clock>& rest : rests) {
    spans.push_back({(rest.begin - zero).seconds(), (rest.end - zero).seconds()});
  }
  return spans;
}

const Span* Nearest(const std::vector<Span>& spans, double middle) {
  const auto after = std::lower_bound(spans.begin(), spans.end(), middle,
                                      [](const Span& s, double t) { return s.middle() < t; });
  if (after == spans.begin()) return spans.empty() ? nullptr : &*after;
  if (after == spans.end()) return &spans.back();
  const auto before = std::prev(after);
  return middle - before->middle() < after->middle() - middle ? &*before : &*after;
}

/// How much of the tool's rests an offset explains.
double Worth(const std::vector<Span>& tool, const std::vector<Span>& rig, double offset) {
  const auto bell = [](double r) { return std::exp(-0.5 * r * r / (kSearch * kSearch)); };
  double worth = 0;
  for (const Span& rest : tool) {
    const Span* there = Nearest(rig, rest.middle() + offset);
    worth += bell(there->begin - rest.begin - offset) * bell(there->end - rest.end - offset);
  }
  return worth;
}

/// The best offset, or why there is none.
Result<double> FindOffset(const std::vector<Span>& tool, const std::vector<Span>& rig) {
  struct Candidate {
    double offset, worth;
  };
  std::vector<double> offsets;
  for (const Span& a : tool) {
    for (const Span& b : rig) {
      if (std::abs(a.length() - b.length()) < 3 * kSearch) {
        offsets.push_back(b.middle() - a.middle());
      }
    }
  }
  std::sort(offsets.begin(), offsets.end());
  std::vector<Candidate> candidates;
  for (const double offset : offsets) {
    // Neighbours within a second are worth the same.
    if (!candidates.empty() && offset - candidates.back().offset < 1) continue;
    candidates.push_back({offset, Worth(tool, rig, offset)});
  }
  const auto best = std::ranges::max_element(candidates, {}, &Candidate::worth);
  if (best == candidates.end() || best->worth < kTwoRests) {
    return Fault{.code = FaultCode::kLost,
                 .text =
                     "no two stops of the tool agree with stops of the rig: the clocks cannot "
                     "be joined"};
  }
  double second = 0;
  for (const Candidate& c : candidates) {
    if (std::abs(c.offset - best->offset) > kOffsetsApart) second = std::max(second, c.worth);
  }
  if (second > kNearly * best->worth) {
    return Fault{.code = FaultCode::kConflict,
                 .text =
                     "the stops are so alike that the clocks can be joined in more than one "
                     "way: give samples with UTC, or a longer log"};
  }
  return best->offset;
}

/// An edge of a rest of the tool against the rig's.
struct Edge {
  double tool, difference;  ///< [s]
  double inward;            ///< +1 for a begin, -1 for an end
};

struct Fit {
  Eigen::Vector3d x = Eigen::Vector3d::Zero();  ///< offset at `centre`, drift, lateness
  Eigen::Matrix3d cov = Eigen::Matrix3d::Zero();
  double centre = 0, scale = 0;
  int matched = 0;

  double At(double tool) const { return x[0] + x[1] * (tool - centre); }
  double Off(const Edge& e) const { return e.difference - At(e.tool) + e.inward * x[2]; }
};

std::vector<Edge> EdgesNear(const std::vector<Span>& tool, const std::vector<Span>& rig,
                            const Fit& fit, double gate) {
  std::vector<Edge> edges;
  for (const Span& rest : tool) {
    const Span* there = Nearest(rig, rest.middle() + fit.At(rest.middle()));
    const Edge begin{rest.begin, there->begin - rest.begin, 1};
    const Edge end{rest.end, there->end - rest.end, -1};
    if (std::abs(fit.Off(begin)) > gate && std::abs(fit.Off(end)) > gate) continue;
    edges.push_back(begin);
    edges.push_back(end);
  }
  return edges;
}

void Step(const std::vector<Edge>& edges, const StopMatchSetup& setup, Fit& fit) {
  std::vector<double> sizes;
  sizes.reserve(edges.size());
  for (const Edge& e : edges) sizes.push_back(std::abs(fit.Off(e)));
  fit.scale = std::max(RobustSigma(sizes), kScaleLeast);
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double weights = 0, squares = 0;
  for (const Edge& e : edges) {
    const double u = fit.Off(e) / (kTukey * fit.scale);
    if (std::abs(u) >= 1) continue;
    const double w = (1 - u * u) * (1 - u * u);
    const Eigen::Vector3d row(1, e.tool - fit.centre, -e.inward);
    normal += w * row * row.transpose();
    right += w * row * e.difference;
    weights += w;
    squares += w * fit.Off(e) * fit.Off(e);
  }
  // The drift and the lateness are known a little beforehand. Tukey's weights shorten the scatter
  // by a tenth.
  const double variance =
      std::max(1.2 * squares / std::max(weights - 3, 1.0), kScaleLeast * kScaleLeast);
  normal(1, 1) += variance / (setup.sigma_drift * setup.sigma_drift);
  normal(2, 2) += variance / (setup.sigma_edge * setup.sigma_edge);
  fit.x = normal.ldlt().solve(right);
  fit.cov = variance * normal.inverse();
}

Fit Refine(const std::vector<Span>& tool, const std::vector<Span>& rig, double offset,
           const StopMatchSetup& setup) {
  Fit fit;
  fit.x[0] = offset;
  fit.centre = 0.5 * (tool.front().begin + tool.back().end);
  fit.scale = kSearch;
  for (int round = 0; round < kRounds; ++round) {
    const double gate = std::max(5 * fit.scale, round < 5 ? 3 * kSearch : 1.0);
    const std::vector<Edge> edges = EdgesNear(tool, rig, fit, gate);
    fit.matched = static_cast<int>(edges.size() / 2);
    if (fit.matched < 2) return fit;
    Step(edges, setup, fit);
  }
  return fit;
}

}  // namespace

UtcTime StopMatch::ToUtc(ToolTime time) const {
  const Duration way = time - tool;
  return utc + way + Duration::Seconds(drift * way.seconds());
}

double StopMatch::Sigma(ToolTime time) const {
  const Eigen::Vector2d row(1, (time - tool).seconds());
  return std::sqrt(row.dot(cov * row));
}

Result<StopMatch> MatchStops(std::span<const ToolRest> tool, std::span<const UtcRest> rig,
                             const StopMatchSetup& setup) {
  if (!(setup.sigma_drift > 0)) {
    throw std::invalid_argument("MatchStops: sigma_drift must be positive");
  }
  if (!(setup.sigma_edge > 0)) {
    throw std::invalid_argument("MatchStops: sigma_edge must be positive");
  }
  if (tool.size() > kRestsMost || rig.size() > kRestsMost) {
    return Fault{.code = FaultCode::kSize,
                 .text = "more than " + std::to_string(kRestsMost) + " stops of one clock"};
  }
  if (tool.size() < 2 || rig.size() < 2) {
    return Fault{.code = FaultCode::kLost,
                 .text = "the tool stood still " + std::to_string(tool.size()) +
                         " times and the rig " + std::to_string(rig.size()) +
                         ": joining the clocks takes two stops of each"};
  }
  const ToolTime tool0 = tool.front().begin;
  const UtcTime rig0 = rig.front().begin;
  const std::vector<Span> ours = Seconds(tool, tool0), theirs = Seconds(rig, rig0);
  const Result<double> offset = FindOffset(ours, theirs);
  if (!offset) return offset.fault();
  const Fit fit = Refine(ours, theirs, *offset, setup);
  if (fit.matched < 2) {
    return Fault{.code = FaultCode::kLost,
                 .text = "fewer than two stops of the tool agree with stops of the rig"};
  }
  StopMatch match;
  match.tool = tool0 + Duration::Seconds(fit.centre);
  match.utc = rig0 + Duration::Seconds(fit.centre + fit.x[0]);
  match.drift = fit.x[1];
  match.cov = fit.cov.topLeftCorner<2, 2>();
  match.late = fit.x[2];
  match.sigma_edge = fit.scale;
  match.matched = fit.matched;
  return match;
}

}  // namespace wellgyro
