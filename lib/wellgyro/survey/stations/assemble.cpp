#include "wellgyro/survey/stations/assemble.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/survey/stations/choose.h"
#include "wellgyro/survey/stations/pass_covariance_internal.h"
#include "wellgyro/survey/stations/pass_items_internal.h"
#include "wellgyro/survey/stations/way.h"
#include "wellgyro/trajectory/minimum_curvature.h"
#include "wellgyro/trajectory/path.h"

namespace wellgyro {
namespace {

std::optional<PathStart> StartOnLine(const Site& head, const PassLine& line, double md,
                                     const Eigen::Vector3d& top) {
  const auto i = line.Below(md);
  if (!i) return std::nullopt;
  return PathStart{Interpolate(head, line.points[*i - 1], line.points[*i], md), line.covs_W[*i],
                   top};
}

/// Start of a pass whose first depth is below the tie-in, the hole between unseen by it: the point
/// at that depth with the least covariance on these lines; where none of them reaches it, the
/// deepest point that they have; absent where they have none.
std::optional<PathStart> StartOnAny(const Site& head, std::span<const PassLine* const> lines,
                                    const PathStart& tie, const PassItems& pass) {
  const double from = SeenFrom(pass);
  std::optional<PathStart> best;
  if (from - tie.point.station.md <= kUnseenLeg) return best;
  const PassLine* deepest = nullptr;
  for (const PassLine* line : lines) {
    const double end = line->points.back().station.md;
    if (!deepest || end > deepest->points.back().station.md) deepest = line;
    if (end < from - kUnseenLeg) continue;
    const auto start = StartOnLine(head, *line, std::min(from, end), tie.top_tangent_W);
    if (start && (!best || start->cov_p_WT_W.trace() < best->cov_p_WT_W.trace())) best = start;
  }
  if (best || !deepest || deepest->points.size() < 2) return best;
  return PathStart{deepest->points.back(), deepest->covs_W.back(), tie.top_tangent_W};
}

/// Dogleg severity of a leg between two tangents [rad/m].
double SeverityOf(double length, const Eigen::Vector3d& t1, const Eigen::Vector3d& t2) {
  const auto leg = MinimumCurvatureLeg(length, t1, t2);
  return leg ? leg->dogleg / length : 0;
}

/// Sums a pass over its way, from station to station.
PassLine PlaceStations(const Site& head, const Job& job, const PathStart& start, PassItems& pass) {
  const PassCovariances covs = PassCovariancesOf(job, pass, start);
  Path path(head, start.point.station, start.point.p_WT_W);
  const Station& own = std::ranges::find(pass, false, &PassItem::carried)->station;
  PassLine line{own.run, own.pass_number, {start.point}, {start.cov_p_WT_W}};
  PathPoint above = start.point;
  for (std::size_t i = 0; i < pass.size(); ++i) {
    Station& s = pass[i].station;
    s.cov_p_WT_W = covs.covs_of_sensors_W[i] + covs.covs_of_depth_W[i];
    if (!pass[i].on_line || s.md <= start.point.station.md) {
      s.p_WT_W = path.last().p_WT_W;
      continue;
    }
    // What starts from a station has a depth error of its own.
    const Eigen::Matrix3d& cov = covs.covs_of_sensors_W[i];
    const auto add = [&](const PathStation& station) {
      const auto point = path.Add(station);
      if (!point) return false;  // opposite directions: it stays where the one before is
      line.points.push_back(*point);
      line.covs_W.push_back(cov);
      return true;
    };
    for (const PathStation& station : pass[i].way) {
      if (station.md > path.last().station.md) add(station);
    }
    if (!add(PathOf(s))) continue;
    s.p_WT_W = path.last().p_WT_W;
    s.dogleg_severity = SeverityOf(s.md - above.station.md, above.tangent_W, path.last().tangent_W);
    // One that is not listed, a stop or a turn, may be a millimetre above: that leg is all noise.
    if (pass[i].listed) above = path.last();
  }
  return line;
}

/// The tie-in as the first row of the survey. Its attitude opens the first leg: the tie-in's own,
/// or that of the best station at its depth.
std::optional<Station> OpeningStation(const Job& job, const std::vector<PassItems>& passes) {
  const TieIn& tie = job.tie_in;
  Station opening;
  if (tie.inclination) {
    opening.inclination = *tie.inclination;
    opening.azimuth = WrapTwoPi(*tie.azimuth);
    opening.tangent_L = Tangent(opening.inclination, opening.azimuth);
  } else {
    const Station* best = nullptr;
    for (const PassItems& pass : passes) {
      for (const PassItem& item : pass) {
        const Station& s = item.station;
        if (std::abs(s.md - tie.md) > TieInReach(job)) continue;
        if (!best || s.cov_md_inc_azi(2, 2) < best->cov_md_inc_azi(2, 2)) best = &s;
      }
    }
    if (!best) return std::nullopt;
    opening = *best;
  }
  opening.kind = StationKind::kTieIn;
  opening.status = StationStatus::kField;
  opening.md = tie.md;
  opening.cov_md_inc_azi.row(0).setZero();
  opening.cov_md_inc_azi.col(0).setZero();
  opening.p_WT_W = {tie.north, tie.east, tie.tvd.value_or(0)};
  opening.cov_p_WT_W = tie.cov_p_WT_W;
  return opening;
}

double ShallowestDepth(const std::vector<PassItems>& passes) {
  double md = HUGE_VAL;
  for (const PassItems& pass : passes) md = std::min(md, pass.front().station.md);
  return md;
}

/// Runs that have stations; one that begins deeper may begin on the line of another.
std::vector<std::size_t> ShallowestFirst(const std::vector<std::vector<PassItems>>& by_run) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < by_run.size(); ++i) {
    if (!by_run[i].empty()) order.push_back(i);
  }
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return ShallowestDepth(by_run[i]); });
  return order;
}

/// Passes in the order in which they are placed: first those from the top, the deepest foremost,
/// then the others by where they begin, since each of these may have to start on one before.
std::vector<std::size_t> TopmostFirst(const std::vector<PassItems>& passes) {
  std::vector<std::size_t> order(passes.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const double top = ShallowestDepth(passes) + kUnseenLeg;
  const auto begin = [&](std::size_t i) { return std::max(SeenFrom(passes[i]), top); };
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    if (begin(a) != begin(b)) return begin(a) < begin(b);
    return passes[a].back().station.md > passes[b].back().station.md;
  });
  return order;
}

/// Of one run, into `lines`; `good` are those of the runs that count, which may be the same.
void PlaceAll(const Site& head, const Job& job, const Station& opening,
              const std::vector<PassLine>& good, std::vector<PassItems>& passes,
              std::vector<PassLine>& lines) {
  PathStart tie;
  tie.point.station = PathOf(opening);
  tie.point.p_WT_W = opening.p_WT_W;
  tie.point.tangent_W = Tangent(opening.inclination, opening.azimuth);
  tie.cov_p_WT_W = opening.cov_p_WT_W;
  tie.top_tangent_W = tie.point.tangent_W;
  const double top = ShallowestDepth(passes) + kSameDepth;
  const std::size_t others = good.size(), own = lines.size();
  std::size_t main_line = own;  // the deepest so far, of this run
  const auto depth = [&](std::size_t i) { return lines[i].points.back().station.md; };
  for (std::size_t i : TopmostFirst(passes)) {
    const double first = passes[i].front().station.md;
    std::vector<const PassLine*> placed;
    for (std::size_t j = 0; j < others; ++j) placed.push_back(&good[j]);
    std::optional<PathStart> start;
    if (first > top && main_line < lines.size()) {
      start = StartOnLine(head, lines[main_line], first, tie.top_tangent_W);
      for (std::size_t j = own; j < lines.size(); ++j) placed.push_back(&lines[j]);
    }
    if (!start) start = StartOnAny(head, placed, tie, passes[i]);
    lines.push_back(PlaceStations(head, job, start.value_or(tie), passes[i]));
    if (depth(lines.size() - 1) > depth(main_line)) main_line = lines.size() - 1;
  }
}

/// Sums the chosen stations, of whatever passes: each leg by their own directions, and what the
/// hole does between them as a pass saw it.
void PlaceChosen(const Site& head, const std::vector<PassLine>& lines, Placed& placed) {
  const Station* above = &placed.chosen.front();
  for (std::size_t i = 1; i < placed.chosen.size(); ++i) {
    Station& s = placed.chosen[i];
    Path leg(head, PathOf(*above), above->p_WT_W);
    const auto point = leg.Add(PathOf(s));
    if (!point) continue;
    s.p_WT_W = point->p_WT_W + Bulge(head, lines, *above, s);
    s.dogleg_severity = point->dogleg_severity;
    above = &s;
  }
}

void List(const std::vector<PassItems>& passes, double tie_md, bool misrun, Placed& placed) {
  for (const PassItems& pass : passes) {
    std::vector<Station> stations;
    for (const PassItem& item : pass) {
      if (!item.listed || item.carried || !item.on_line) continue;
      if (item.station.md <= tie_md + kSameDepth) continue;
      stations.push_back(item.station);
      if (misrun && stations.back().status != StationStatus::kRejected) {
        stations.back().status = StationStatus::kSuperseded;
      }
    }
    std::stable_sort(stations.begin(), stations.end(),
                     [](const Station& a, const Station& b) { return a.utc < b.utc; });
    placed.passes.insert(placed.passes.end(), stations.begin(), stations.end());
  }
}

void Choose(const Site& head, const Station& opening, const std::vector<PassLine>& lines,
            Placed& placed) {
  const std::vector<std::size_t> chosen = ChooseStations(placed.passes);
  placed.chosen.push_back(opening);
  std::vector<bool> is_chosen(placed.passes.size());
  for (std::size_t i : chosen) is_chosen[i] = true;
  for (std::size_t i = 0; i < placed.passes.size(); ++i) {
    Station& s = placed.passes[i];
    if (!is_chosen[i] && s.status != StationStatus::kRejected) {
      s.status = StationStatus::kSuperseded;
    }
  }
  for (std::size_t i : chosen) {
    placed.passes[i].number = static_cast<std::int32_t>(placed.chosen.size());
    placed.chosen.push_back(placed.passes[i]);
  }
  PlaceChosen(head, lines, placed);
}

/// What an error e of the depth's scale does to stations below the tie-in at `origin`. The path to
/// where the tool was grows by e (p - origin), and the hole at that depth lies e (md - md_tie) up
/// from there; both as in ByCommonDepth().
void AddDepthScale(const Job& job, const std::vector<DraftedRun>& runs,
                   const Eigen::Vector3d& origin, std::vector<Station>& stations) {
  for (Station& s : stations) {
    const auto run =
        std::find_if(runs.begin(), runs.end(), [&](const DraftedRun& r) { return r.run == s.run; });
    const double scale =
        run == runs.end() ? job.errors.depth_scale_sigma : run->SigmaOfDepthScale(job.errors);
    const double way = s.md - job.tie_in.md;
    if (s.kind == StationKind::kTieIn || !(way > 0) || !(scale > 0)) continue;
    const Eigen::Vector3d along = scale * way * Tangent(s.inclination, s.azimuth);
    const Eigen::Vector3d path = scale * (s.p_WT_W - origin), there = path - along;
    s.cov_p_WT_W += path * path.transpose() + there * there.transpose();
    s.cov_md_inc_azi(0, 0) += scale * way * scale * way;
  }
}

/// Why the tie-in is all that there is.
std::string WhyNoOpening(const Job& job, double first) {
  const double tie = job.tie_in.md;
  if (first < tie) {
    return fmt::format(
        "the survey begins at {:.2f} m, above the tie-in at {:.2f} m, and has no station there: "
        "give [tie_in] inclination_deg and azimuth_true_deg, or md_m = {:.2f} with the tvd_m there",
        first, tie, first);
  }
  return fmt::format(
      "the survey begins at {:.2f} m, below the tie-in at {:.2f} m: give [tie_in] "
      "inclination_deg and azimuth_true_deg for the {:.2f} m between, or md_m = {:.2f} with the "
      "tvd_m there",
      first, tie, first - tie, first);
}

std::string WhyNothing(const Job& job, const std::vector<PassItems>& passes, const Placed& placed) {
  double deepest = -HUGE_VAL;
  for (const PassItems& pass : passes) {
    for (const PassItem& item : pass) deepest = std::max(deepest, item.station.md);
  }
  if (deepest <= job.tie_in.md + kSameDepth) {
    return fmt::format("the survey ends at {:.2f} m, no deeper than the tie-in at {:.2f} m",
                       deepest, job.tie_in.md);
  }
  const bool rejected =
      std::any_of(placed.passes.begin(), placed.passes.end(),
                  [](const Station& s) { return s.status == StationStatus::kRejected; });
  if (rejected) return "every station was rejected";
  return fmt::format(
      "none of the depths that [stations] asks for was passed: the run went from {:.2f} to {:.2f} "
      "m, the tie-in is at {:.2f} m",
      ShallowestDepth(passes), deepest, job.tie_in.md);
}

}  // namespace

// P(x > 4) = 3.2e-5: one run in 30 000 begins further from its tie-in. With three sigmas it was one
// in 740, of which no survey was made.
double TieInReach(const Job& job) { return std::max(0.5, 4 * job.errors.depth_sigma); }

Placed Assemble(const Job& job, const std::vector<DraftedRun>& runs) {
  const Site head = SiteAt(job.well.latitude, job.well.datum_elevation);
  Placed placed;
  std::vector<std::vector<PassItems>> by_run;
  std::vector<PassItems> good;
  for (const DraftedRun& run : runs) {
    by_run.push_back(SplitPasses(job, run));
    if (!run.misrun) good.insert(good.end(), by_run.back().begin(), by_run.back().end());
  }
  if (good.empty()) {
    const bool misruns = std::any_of(by_run.begin(), by_run.end(),
                                     [](const auto& passes) { return !passes.empty(); });
    placed.unusable = misruns ? "every run with stations is a misrun"
                              : "no station was made: no run has both depth and an azimuth";
    return placed;
  }
  const std::optional<Station> opening = OpeningStation(job, good);
  if (!opening) {
    placed.unusable = WhyNoOpening(job, ShallowestDepth(good));
    return placed;
  }
  std::vector<PassLine> lines, misruns;
  for (const std::size_t i : ShallowestFirst(by_run)) {
    PlaceAll(head, job, *opening, lines, by_run[i], runs[i].misrun ? misruns : lines);
  }
  for (std::size_t i = 0; i < runs.size(); ++i) {
    List(by_run[i], job.tie_in.md, runs[i].misrun, placed);
  }
  Choose(head, *opening, lines, placed);
  AddDepthScale(job, runs, placed.chosen.front().p_WT_W, placed.passes);
  AddDepthScale(job, runs, placed.chosen.front().p_WT_W, placed.chosen);
  if (placed.chosen.size() == 1) placed.unusable = WhyNothing(job, good, placed);
  return placed;
}

}  // namespace wellgyro
