// What a run learns at rest: stops, their north fixes and checks.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "wellgyro/alignment/gyrocompass.h"
#include "wellgyro/base/angle.h"
#include "wellgyro/calibration/field_checks.h"
#include "wellgyro/survey/run_survey.h"

namespace wellgyro {
namespace {

constexpr double kOneStop = 0.2;           // [m], between windows of one stop
constexpr double kSamePlaceSeconds = 120;  // the same where there is no depth
// 2 ln of odds of 90: by less one azimuth does not beat another.
constexpr double kDecides = 9;
constexpr double kTells = 1e-3;  // of a variance, from which a stop has said something of it

/// What the Earth measured at the stop, and what it is.
void TakeReferences(const NorthFix& fix, Station& station) {
  station.gravity = fix.gravity;
  station.gravity_ref = fix.gravity_ref;
  station.earth_rate = fix.earth_rate;
  station.earth_rate_ref = fix.earth_rate_ref;
}

/// Which of a fix's two azimuths holds, by the one known before.
void ChooseBranch(const AttitudeSample& before, NorthFix& fix) {
  if (!fix.mirror_azimuth) return;
  const double var = fix.cov_attitude(1, 1) + before.cov_attitude(1, 1);
  const auto cost = [&](double azimuth) {
    const double off = WrapPi(azimuth - before.azimuth);
    return off * off / var;
  };
  const double more = cost(*fix.mirror_azimuth) + fix.mirror_cost - cost(fix.azimuth);
  if (std::abs(more) <= kDecides) {
    fix.quality |= Quality::kMirror;
    return;
  }
  fix.quality = Without(fix.quality, Quality::kMirror);
  if (more > 0) return;
  std::swap(fix.azimuth, *fix.mirror_azimuth);
  fix.mirror_cost = -fix.mirror_cost;
}

/// What a stop says against what was known before it, errors that both share left out: the variance
/// of the step that the estimate makes is what the stop takes off the azimuth's, and the step is
/// that share of what the stop by itself is off.
void CloseOn(const AttitudeSample& before, const AttitudeSample& after, NorthFix& fix) {
  const double known = before.cov_attitude(1, 1), gained = known - after.cov_attitude(1, 1);
  if (!(gained > kTells * known)) return;
  const double step = WrapPi(after.azimuth - before.azimuth);
  fix.chi_square = step * step / gained;
  fix.closure = step * known / gained;
  fix.sigma_closure = known / std::sqrt(gained);
}

}  // namespace

/// Whether the tool still is where the windows of group_, if any, were taken.
bool RunSurvey::SamePlace(ToolTime time, std::optional<double> md) const {
  if (group_.empty()) return true;
  const StillWindow& last = group_.back();
  return last.md && md ? std::abs(*md - *last.md) <= kOneStop
                       : (time - last.end).seconds() <= kSamePlaceSeconds;
}

void RunSurvey::TakeWindow(const StillWindow& window) {
  if (!SamePlace(window.begin, window.md)) CloseGroup();
  group_.push_back(window);
}

void RunSurvey::CheckStop() {
  FieldCheckSetup setup;
  setup.reference.gravity = site_.site().gravity;
  setup.reference.latitude = site_.site().latitude;
  setup.gyro = job_.noise;
  setup.errors = job_.errors;
  for (const StillWindow& window : group_) {
    if (!window.has_gz) continue;
    for (Check& check : CheckWindow(window, setup)) {
      // Gravity and the rate itself are checked with the fix.
      if (check.code != "earth_rate_vertical" && check.code != "earth_rate_horizontal") continue;
      check.run = summary_.run;
      summary_.stop_checks.push_back(std::move(check));
    }
  }
}

/// North from windows at one place.
NorthFix RunSurvey::FixOf(std::span<const StillWindow> windows) const {
  GyrocompassSetup setup;
  setup.gyro = job_.noise;
  setup.errors = job_.errors;
  NorthFix fix = Gyrocompass(windows, site_.site(), setup);
  fix.md = windows.back().md;
  fix.run = summary_.run;
  fix.tool = summary_.tool;
  return fix;
}

/// The tool has left: what lies within the stop is decided, and its north is found. It counts when
/// the knots up to its end are known.
void RunSurvey::CloseGroup() {
  if (group_.empty()) return;
  for (Waiting& waiting : waiting_) {
    if (waiting.end <= group_.back().end) waiting.still = IsStill(waiting);
  }
  CheckStop();
  closed_.push_back(FixOf(group_));
  group_.clear();
}

/// Stops that end by then; all of them where no knot follows for now.
void RunSurvey::UseClosedStops(std::optional<ToolTime> until) {
  while (!closed_.empty() && (!until || closed_.front().end <= *until)) {
    const NorthFix fix = closed_.front();
    closed_.pop_front();
    // Before its own fix, which the magnetic azimuth may tell from its mirror.
    const auto magnetic = outside_.Magnetic(fix);
    if (magnetic && !knots_.empty()) Tie(*magnetic, false);
    UseFix(fix);
  }
}

void RunSurvey::UseFix(NorthFix fix) {
  const bool wanted =
      job_.alignment.use_fixes || job_.alignment.method == AlignmentSpec::Method::kGyrocompass;
  if (wanted && !knots_.empty()) {
    const bool roll_hidden = std::exchange(roll_hidden_, false);
    history_.fixes.push_back({fix, knots_.size(), roll_hidden});
    const std::optional<AttitudeSample> before = knots_.KnownAt(fix.begin);
    if (AzimuthKnown() && before && before->azimuth_known) {
      ChooseBranch(*before, fix);
      if (!roll_hidden) CloseOn(*before, known_, fix);
    } else if (!AzimuthKnown()) {
      BeginForward();
      const bool alone = AzimuthKnown() || !fix.mirror_azimuth;
      fix.quality = alone ? Without(fix.quality, Quality::kMirror) : fix.quality | Quality::kMirror;
    }
  }
  summary_.fixes.push_back(fix);
  ListStop(fix);
}

/// Of stops to which the tool came on a roll that gravity did not show, on which the azimuth on the
/// way then hangs, what the run as a whole, which every stop is part of, leaves of the stop's own
/// azimuth: the variance of that difference is the difference of the variances.
void RunSurvey::CloseOnWhole(std::span<const AttitudeSample> whole) {
  for (const FixAtNode& at : history_.fixes) {
    if (!at.roll_hidden || at.node > whole.size()) continue;
    const auto listed =
        std::find_if(summary_.fixes.begin(), summary_.fixes.end(), [&at](const NorthFix& fix) {
          return !fix.external && fix.from_samples && fix.begin == at.fix.begin;
        });
    if (listed == summary_.fixes.end()) continue;
    const AttitudeSample& run = whole[at.node - 1];
    const double alone = listed->cov_attitude(1, 1), gained = alone - run.cov_attitude(1, 1);
    const bool doubtful = Has(listed->quality, Quality::kMirror | Quality::kVertical);
    if (doubtful || !run.azimuth_known || !(gained > kTells * alone)) continue;
    listed->closure = WrapPi(listed->azimuth - run.azimuth);
    listed->sigma_closure = std::sqrt(gained);
    listed->chi_square = listed->closure * listed->closure / gained;
  }
}

void RunSurvey::ListStop(const NorthFix& fix) {
  if (!fix.md) return;
  for (std::size_t i = drafts().size(); i-- > 0;) {
    Station& s = drafts()[i].station;
    if (s.utc > fix.utc_end) continue;
    if (std::abs(s.md - *fix.md) > kOneStop) return;
    s.kind = StationKind::kGyrocompass;
    TakeReferences(fix, s);
    s.quality |= fix.quality;
    if (job_.stations.at_stops) book_.List(i);
    return;
  }
}

void RunSurvey::Push(const StillWindow& window, const AlongHole& along) {
  StillWindow placed = window;
  if (!placed.md && along.known) placed.md = along.md;
  if (summary_.fixes.empty() && summary_.samples == 0) summary_.begin = window.utc_begin;
  summary_.end = window.utc_end;
  NorthFix fix = FixOf({&placed, 1});
  fix.from_samples = false;
  summary_.fixes.push_back(fix);
  if (!fix.md) {
    summary_.seconds_without_depth += window.seconds();
    return;
  }
  Draft draft;
  Station& s = draft.station;
  s.run = summary_.run;
  s.tool = summary_.tool;
  s.pass = Pass::kStationary;
  s.pass_number = 1;
  s.kind = StationKind::kStill;
  s.md = *fix.md;
  s.utc = window.utc_end;
  s.tool_time = window.end;
  TakeReferences(fix, s);
  draft.attitude = {window.end, fix.inclination,  fix.azimuth, fix.toolface,
                    true,       fix.cov_attitude, fix.quality};
  draft.mirror_azimuth = fix.mirror_azimuth;
  draft.mirror_cost = fix.mirror_cost;
  book_.Add(draft, true);
}

}  // namespace wellgyro
