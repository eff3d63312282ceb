#include "wellgyro/fit/run_adjustment.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <map>
#include <utility>

#include "wellgyro/base/angle.h"
#include "wellgyro/fit/adjust_north_internal.h"
#include "wellgyro/fit/adjust_problem_internal.h"
#include "wellgyro/fit/adjust_result_internal.h"
#include "wellgyro/math/statistics.h"
#include "wellgyro/record/quality.h"
#include "wellgyro/record/unknown_angle.h"

namespace wellgyro {
namespace {

constexpr double kCoarseSeconds = 60;  // nodes of the search for north
constexpr double kDecides = 0.1;     // sigma of an azimuth from outside that needs no search [rad]
constexpr double kSameDepth = 0.05;  // of two passes of one station [m]
constexpr double kLeastBend = 6e-6;  // of a hole, 0.01 deg in 30 m [rad/m]
constexpr double kLeastLie = 1e-6;   // by which passes differ in any case [rad]
constexpr double kSamePath = 0.1;    // sigmas of a span's growth by which a path counts as the same
constexpr int kPathsMax = 6;
constexpr double kLostVariance = 0.25;  // of an azimuth that no longer is linear [rad^2]

bool TellsOfNorth(const AdjustSegment& segment, const std::vector<AdjustSpan>& spans) {
  for (std::size_t k = segment.begin; k + 1 < segment.end; ++k) {
    if (!spans[k].vertical) return true;
  }
  return false;
}

// Azimuths of nodes from the growth of the spans alone, each segment from `start`.
std::vector<double> ReckonedFrom(double start, const std::vector<AdjustSpan>& spans) {
  std::vector<double> azimuths{start};
  for (const AdjustSpan& span : spans) {
    double next = azimuths.back();
    if (span.still) {
      next += span.still_turn;
    } else if (!span.broken) {
      next += span.turn + (std::polar(1.0, next) * span.earth_turn).real() + span.up;
    }
    azimuths.push_back(next);
  }
  return azimuths;
}

// Of the smoothed azimuth at an axial knot, what the nodes count: the sum less the toolface as
// read.
double CountedAt(const AttitudeSample& smoothed, const Knot& knot) {
  return smoothed.azimuth + (knot.axial ? WrapPi(smoothed.toolface - knot.toolface) : 0);
}

// The smoothed azimuths of the nodes, counted on through whole turns.
std::vector<double> SmoothedAt(const FilterHistory& history, const SmoothedRun& smoothed,
                               const std::vector<AdjustSpan>& spans) {
  std::vector<double> azimuths = ReckonedFrom(0, spans);
  double turns = 0;
  for (std::size_t k = 0; k < spans.size(); ++k) {
    const std::size_t last = spans[k].epoch_end - 1;
    const double there = CountedAt(smoothed.attitude[last], history.epochs[last].knot);
    const double reckoned = azimuths[k + 1] + turns;
    const double next = reckoned + WrapPi(there - reckoned);
    turns += next - reckoned;
    if (k == 0) azimuths[0] += turns;
    azimuths[k + 1] = next;
  }
  return azimuths;
}

// How fast the direction changes along the hole about a station [rad/m].
struct Bend {
  double azimuth = 0, inclination = 0;
};

Bend BendAt(const FilterHistory& history, const AdjustProblem& p, std::size_t span,
            const std::vector<double>& path) {
  Bend bend{kLeastBend, kLeastBend};
  for (const std::size_t k : {span, span + 1}) {
    if (k >= p.spans.size() || k == 0) continue;
    const std::size_t a = p.spans[k].epoch_begin - 1, b = p.spans[k].epoch_end - 1;
    const Knot &from = history.epochs[a].knot, &to = history.epochs[b].knot;
    const double way = std::max(std::abs(to.along.md - from.along.md), 1.0);
    bend.azimuth = std::max(bend.azimuth, std::abs(path[b] - path[a]) / way);
    bend.inclination =
        std::max(bend.inclination, std::abs(to.inclination - from.inclination) / way);
  }
  return bend;
}

// Depths that stations of different passes share. Errors of depth are alike over a whole pass, so
// that many stations tell no more of them than one.
void FindRepeats(const FilterHistory& history, const std::vector<double>& path, double sigma_lie,
                 AdjustProblem* p) {
  std::multimap<double, std::size_t> nodes;  // by depth, of the passes so far
  std::vector<Bend> bends;
  for (std::size_t k = 0; k < p->spans.size(); ++k) {
    const AdjustSpan& span = p->spans[k];
    const FilterEpoch& epoch = history.epochs[span.epoch_end - 1];
    if (!epoch.station || !epoch.knot.along.known || span.still || span.vertical) continue;
    // Of another time, perhaps, is its depth.
    if (Has(epoch.knot.quality, Quality::kClock)) continue;
    const double md = epoch.knot.along.md;
    const auto near = nodes.lower_bound(md - kSameDepth);
    if (near != nodes.end() && near->first < md + kSameDepth) {
      const double sine = std::max(std::sin(epoch.knot.inclination), 1e-3);
      p->repeats.push_back({near->second, k + 1, 0, 0, sine});
      bends.push_back(BendAt(history, *p, k, path));
    }
    nodes.emplace(md, k + 1);
  }
  const double depth =
      history.setup.errors.depth_sigma * std::sqrt(2.0 * static_cast<double>(bends.size()));
  for (std::size_t i = 0; i < bends.size(); ++i) {
    AdjustProblem::Repeat& r = p->repeats[i];
    r.sigma_azimuth = std::hypot(depth * bends[i].azimuth, sigma_lie / r.sine, kLeastLie / r.sine);
    r.sigma_inclination = std::hypot(depth * bends[i].inclination, sigma_lie, kLeastLie);
  }
}

// `path`: azimuth at the end of every epoch; empty: not yet known.
AdjustProblem MakeProblem(const FilterHistory& history, const std::vector<double>& path,
                          const SpanOptions& spans, const AdjustmentOptions& options,
                          double sigma_lie) {
  AdjustProblem p;
  p.history = &history;
  p.huber = options.huber;
  p.spans = SpansOf(history, PlacesAlong(history, path), spans);
  if (p.spans.empty()) return p;
  if (options.use_repeats && !path.empty()) FindRepeats(history, path, sigma_lie, &p);
  p.layout = AdjustLayoutOf(history.setup, sigma_lie, !p.repeats.empty());
  return p;
}

// Azimuth at the end of every epoch.
std::vector<double> PathOf(const AdjustProblem& p) {
  std::vector<double> path(p.spans.front().epoch_begin, p.azimuth(0));
  for (std::size_t k = 0; k < p.spans.size(); ++k) {
    const std::vector<double> within = AzimuthsWithin(p, k);
    path.insert(path.end(), within.begin(), within.end());
  }
  return path;
}

// Before the first fit: azimuths of every epoch, and what the search for north adds to the variance
// of each, or takes off it.
struct Beginning {
  std::vector<double> path;
  std::vector<bool> lost;  // see SpanOptions
  std::vector<double> var_beyond;
  std::vector<AdjustProblem::Hold> holds;
  bool ambiguous = false;  // two norths fit a part of the run
};

bool IsFound(double var_beyond) { return var_beyond < kUnknownAngleVariance; }

// Whether an azimuth from outside, and no gyrocompass, says where north is in [first, last].
bool IsTold(const FilterHistory& history, std::size_t first, std::size_t last) {
  const FilterSetup& setup = history.setup;
  if (first == 0 && setup.start_azimuth && setup.start_sigma < kDecides) return true;
  return std::any_of(history.fixes.begin(), history.fixes.end(), [&](const FilterFix& f) {
    const bool within = f.epoch_end >= first && f.epoch_end <= last + 1;
    return within && f.fix.external && f.fix.cov_attitude(1, 1) < kDecides * kDecides;
  });
}

// Near vertical, where an azimuth that is not known lets its own growth go: what the lifts say of
// it there has two answers at every node, and least squares would take any of them for the truth.
std::vector<bool> LostAlong(const FilterHistory& history, const SmoothedRun& smoothed) {
  const auto& epochs = history.epochs;
  std::vector<bool> lost(epochs.size(), false);
  const auto is_vague = [&](std::size_t i) {
    return epochs[i].knot.axial && smoothed.attitude[i].cov_attitude(1, 1) > kLostVariance;
  };
  for (std::size_t i = 0; i < epochs.size(); ++i) {
    const std::size_t begin = i;
    double var = 0;
    for (; i < epochs.size() && is_vague(i); ++i) {
      if (!epochs[i].knot.still) var += epochs[i].knot.toolface_noise_turn;
    }
    if (!(var > kLostVariance)) continue;
    for (std::size_t k = begin; k < i; ++k) lost[k] = !epochs[k].knot.still;
  }
  return lost;
}

Beginning Begin(const FilterHistory& history, const AdjustmentOptions& options, double sigma_lie) {
  const SmoothedRun smoothed = Smooth(history);
  Beginning begin;
  begin.var_beyond.assign(history.epochs.size(), 0.0);
  begin.lost = LostAlong(history, smoothed);
  const SpanOptions coarse{kCoarseSeconds, false, begin.lost};
  AdjustProblem p = MakeProblem(history, {}, coarse, options, sigma_lie);
  std::vector<double> azimuths = SmoothedAt(history, smoothed, p.spans);
  for (const AdjustSegment& segment : SegmentsOf(p.spans)) {
    if (!TellsOfNorth(segment, p.spans)) continue;
    const auto epoch_of = [&](std::size_t node) {
      return node > 0 ? p.spans[node - 1].epoch_end - 1 : p.spans.front().epoch_begin;
    };
    const std::size_t first = segment.begin > 0 ? epoch_of(segment.begin) : 0;
    const std::size_t last = epoch_of(segment.end - 1);
    if (smoothed.attitude[last].azimuth_known && IsTold(history, first, last)) continue;
    const AdjustNorth north = FindNorth(segment, azimuths, &p);
    const double off = north.azimuth - azimuths[segment.end - 1];
    for (std::size_t k = segment.begin; k < segment.end; ++k) azimuths[k] += off;
    if (north.var_hold > 0) {
      begin.holds.push_back({north.epoch, 0, std::sqrt(north.var_hold)});
    }
    begin.ambiguous = begin.ambiguous || north.ambiguous;
    const double beyond = north.ambiguous ? kUnknownAngleVariance : north.var_beyond;
    for (std::size_t i = first; i <= last; ++i) begin.var_beyond[i] = beyond;
  }
  for (std::size_t i = 0; i < begin.lost.size(); ++i) {
    if (begin.lost[i]) begin.var_beyond[i] = kUnknownAngleVariance;
  }
  StartFrom(azimuths, &p);
  begin.path = PathOf(p);
  return begin;
}

// The same error of all azimuths that hang together.
void Widen(const std::vector<double>& var_beyond, SmoothedRun* run) {
  for (std::size_t i = 0; i < run->attitude.size(); ++i) {
    Eigen::Matrix3d& cov = run->attitude[i].cov_attitude;
    cov(1, 1) += var_beyond[i];
    if (!IsFound(var_beyond[i])) run->attitude[i].azimuth_known = false;
    CapAtUnknown(&cov);
  }
  const StationState* previous = nullptr;
  for (StationState& station : run->stations) {
    const double var = var_beyond[station.epoch];
    station.attitude = run->attitude[station.epoch];
    station.cov(0, 0) += var;
    if (previous != nullptr && var_beyond[previous->epoch] == var) {
      station.cov_with_previous(0, 0) += var;
    }
    previous = &station;
  }
}

// How many times too small the variances of a run are that fits worse than chance would have it.
double MisfitOf(const Adjustment& a) {
  constexpr double kChance = 1e-6;
  if (a.degrees_of_freedom < 1 ||
      a.chi_square < ChiSquareQuantile(1 - kChance, a.degrees_of_freedom)) {
    return 1;
  }
  return std::max(1.0, a.chi_square / a.degrees_of_freedom);
}

// What is wrong with such a run is not known: all of it may be so much worse.
void Scale(double by, SmoothedRun* run) {
  if (!(by > 1)) return;
  for (AttitudeSample& a : run->attitude) {
    a.cov_attitude *= by;
    CapAtUnknown(&a.cov_attitude);
  }
  for (StationState& station : run->stations) {
    station.attitude = run->attitude[station.epoch];
    station.cov *= by;
    station.cov_with_previous *= by;
    station.cov_white *= by;
  }
}

std::vector<double> AtNodes(const AdjustProblem& p, const std::vector<double>& path) {
  const std::size_t first = p.spans.front().epoch_begin;
  const AdjustSpan& span = p.spans.front();
  double turned = span.still_turn;
  for (std::size_t i = first; i < span.epoch_end; ++i) {
    if (!span.still && !span.broken) turned += p.history->epochs[i].knot.turn;
  }
  std::vector<double> azimuths{first > 0 ? path[first - 1] : path[span.epoch_end - 1] - turned};
  for (const AdjustSpan& s : p.spans) azimuths.push_back(path[s.epoch_end - 1]);
  return azimuths;
}

void FillErrors(const AdjustProblem& p, const SelectedInverse& inverse, Adjustment* result) {
  const int first = static_cast<int>(p.nodes.size());
  const auto fill = [&](int source, int place) {
    if (place < 0) return;
    result->errors[source] = p.common[static_cast<std::size_t>(place)];
    result->sigma_errors[source] = std::sqrt(inverse.At(first + place, first + place));
  };
  for (int source = 0; source < Knot::kSources; ++source) {
    fill(source, p.layout.source[static_cast<std::size_t>(source)]);
  }
  for (int axis = 0; axis < 2; ++axis) {
    const auto& at = p.layout.axis[static_cast<std::size_t>(axis)];
    fill(axis, at.level_common);
    if (at.level < 0) continue;  // the drift's level where the run ends
    const int place = first - p.layout.node + at.level;
    result->errors[axis] = p.nodes[static_cast<std::size_t>(place)];
    result->sigma_errors[axis] = std::sqrt(inverse.At(place, place));
  }
}

// Share of its own variance that the unknowns leave to a residual, from the rows of the others.
double FreedomOf(const AdjustRows& rows, int row, const SelectedInverse& inverse) {
  std::vector<std::pair<int, double>> slopes;
  using Entry = Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator;
  for (Entry entry(rows.jacobian, row); entry; ++entry) {
    if (entry.value() != 0) slopes.emplace_back(static_cast<int>(entry.col()), entry.value());
  }
  double taken = 0;
  for (std::size_t a = 0; a < slopes.size(); ++a) {
    const auto [i, slope] = slopes[a];
    taken += slope * slope * inverse.At(i, i);
    for (std::size_t b = 0; b < a; ++b) {
      taken += 2 * slope * slopes[b].second * inverse.At(i, slopes[b].first);
    }
  }
  return std::max(0.0, 1 - taken);
}

void FillParts(const AdjustRows& rows, const SelectedInverse& inverse, RunFit* fit) {
  for (std::size_t row = 0; row < rows.part.size(); ++row) {
    if (rows.part[row] == RunFit::kParts) continue;
    RunFit::Squares& squares = fit->parts[rows.part[row]];
    squares.sum += rows.residual[row] * rows.residual[row];
    squares.freedom += FreedomOf(rows, static_cast<int>(row), inverse);
  }
}

// By how many sigmas the Earth turns another way within a span than the problem has it.
double MovedBetween(const AdjustProblem& p, const AdjustProblem& renewed) {
  double most = 0;
  for (std::size_t k = 0; k < p.spans.size(); ++k) {
    const AdjustSpan &was = p.spans[k], &is = renewed.spans[k];
    const std::complex<double> to = std::polar(1.0, p.azimuth(k));
    const double turn = (to * (is.earth_turn - was.earth_turn)).real();
    const double lift = (to * (is.earth_lift - was.earth_lift)).imag();
    most = std::max({most, turn * turn / is.var_turn, lift * lift / is.var_lift});
  }
  return std::sqrt(most);
}

// A span takes what the Earth does in it from the path, of which one is known only now: near
// vertical, where the azimuth turns by tens of degrees in a span, the first one is far off.
AdjustOutcome SolveAlong(AdjustProblem* p, AdjustRows* rows,
                         const std::function<AdjustProblem(const std::vector<double>&)>& make) {
  AdjustOutcome outcome = Solve(p, rows);
  for (int i = 1; i < kPathsMax && outcome.converged; ++i) {
    const std::vector<double> path = PathOf(*p);
    AdjustProblem renewed = make(path);
    renewed.holds = p->holds;
    const bool alike = renewed.spans.size() == p->spans.size();
    if (alike && MovedBetween(*p, renewed) < kSamePath) break;
    if (alike && renewed.layout.common == p->layout.common) {
      renewed.nodes = p->nodes;
      renewed.common = p->common;
    } else {
      StartFrom(AtNodes(renewed, path), &renewed);
    }
    AdjustRows renewed_rows;
    const AdjustOutcome again = Solve(&renewed, &renewed_rows);
    if (!again.converged) break;
    outcome = again;
    *p = std::move(renewed);
    *rows = std::move(renewed_rows);
  }
  return outcome;
}

// What the smoother makes of the run is all there is of it, and the fit says that it is no fit.
Adjustment GivenUp(const FilterHistory& history, const Beginning& begin) {
  Adjustment result;
  result.run = Smooth(history);
  Widen(begin.var_beyond, &result.run);
  result.ambiguous = begin.ambiguous;
  result.run.fit = result;
  return result;
}

}  // namespace

Adjustment AdjustRun(const FilterHistory& history, double sigma_lie,
                     const AdjustmentOptions& options) {
  Adjustment result;
  const bool any = std::any_of(history.epochs.begin(), history.epochs.end(),
                               [](const FilterEpoch& e) { return e.knot.seconds > 0; });
  if (!any) {
    result.run = Smooth(history);
    return result;
  }
  const Beginning begin = Begin(history, options, sigma_lie);
  const SpanOptions spans{options.knot_seconds, true, begin.lost};
  const auto make = [&](const std::vector<double>& path) {
    return MakeProblem(history, path, spans, options, sigma_lie);
  };
  AdjustProblem p = make(begin.path);
  for (AdjustProblem::Hold hold : begin.holds) {
    for (const AdjustSpan& span : p.spans) {
      if (span.epoch_end <= hold.epoch) continue;
      hold.epoch = span.epoch_end - 1;
      hold.azimuth = begin.path[hold.epoch];
      p.holds.push_back(hold);
      break;
    }
  }
  StartFrom(AtNodes(p, begin.path), &p);
  AdjustRows rows;
  const AdjustOutcome outcome = SolveAlong(&p, &rows, make);
  if (!outcome.converged) return GivenUp(history, begin);
  const Eigen::SparseMatrix<double> jacobian = rows.jacobian;  // by columns
  const SelectedInverse inverse(jacobian.transpose() * jacobian);
  if (!inverse.ok()) return GivenUp(history, begin);
  std::vector<bool> known{IsFound(begin.var_beyond.front())};
  for (const AdjustSpan& span : p.spans) {
    known.push_back(IsFound(begin.var_beyond[span.epoch_end - 1]));
  }
  result.run = ResultOf(p, inverse, known);
  result.chi_square = outcome.chi_square;
  result.degrees_of_freedom =
      outcome.residuals - static_cast<int>(p.nodes.size() + p.common.size());
  Scale(MisfitOf(result), &result.run);
  Widen(begin.var_beyond, &result.run);
  result.converged = true;
  result.ambiguous = begin.ambiguous;
  FillErrors(p, inverse, &result);
  FillParts(rows, inverse, &result);
  result.run.fit = result;
  return result;
}

LeastSquaresAdjuster::LeastSquaresAdjuster(const AdjustmentOptions& options) : options_(options) {}

SmoothedRun LeastSquaresAdjuster::Adjust(const FilterHistory& history, std::span<const Increment>,
                                         double sigma_lie) const {
  return AdjustRun(history, sigma_lie, options_).run;
}

}  // namespace wellgyro
