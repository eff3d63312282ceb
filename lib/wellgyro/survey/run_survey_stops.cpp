// What a run learns at rest: stops, their north fixes and checks.
#include <cmath>
#include <utility>

#include "wellgyro/alignment/gyrocompass.h"
#include "wellgyro/base/angle.h"
#include "wellgyro/calibration/field_checks.h"
#include "wellgyro/survey/run_survey.h"

namespace wellgyro {
namespace {

constexpr double kSamePlace = 0.2;         // [m], between windows of one stop
constexpr double kSamePlaceSeconds = 120;  // the same where there is no depth

/// What the Earth measured at the stop, and what it is.
void TakeReferences(const NorthFix& fix, Station& station) {
  station.gravity = fix.gravity;
  station.gravity_ref = fix.gravity_ref;
  station.earth_rate = fix.earth_rate;
  station.earth_rate_ref = fix.earth_rate_ref;
}

}  // namespace

/// Whether the tool still is where the windows of group_, if any, were taken.
bool RunSurvey::SamePlace(ToolTime time, std::optional<double> md) const {
  if (group_.empty()) return true;
  const StillWindow& last = group_.back();
  return last.md && md ? std::abs(*md - *last.md) <= kSamePlace
                       : (time - last.end).seconds() <= kSamePlaceSeconds;
}

void RunSurvey::TakeWindow(const StillWindow& window) {
  if (!SamePlace(window.begin, window.md)) CloseGroup();
  group_.push_back(window);
}

void RunSurvey::CheckStop() {
  FieldCheckSetup setup;
  setup.reference.gravity = site_.gravity;
  setup.reference.latitude = site_.latitude;
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
  NorthFix fix = Gyrocompass(windows, site_, setup);
  fix.md = windows.back().md;
  fix.run = summary_.run;
  fix.tool = summary_.tool;
  return fix;
}

void RunSurvey::CloseGroup() {
  if (group_.empty()) return;
  // What lies before the end of the stop is decided; the fix needs it in the filter.
  const ToolTime end = group_.back().end;
  while (!waiting_.empty() && waiting_.front().knot.time <= end) {
    Waiting first = waiting_.front();
    first.knot.still = IsStill(first, std::nullopt);
    waiting_.erase(waiting_.begin());
    StepFilter(first);
  }
  CheckStop();
  const NorthFix fix = FixOf(group_);
  group_.clear();
  if (magnet_pending_ && fix.magnetic_azimuth && !Has(fix.quality, Quality::kVertical)) {
    TieByMagnet(fix);
  }
  UseFix(fix);
}

/// The magnetic azimuth of a stop, before its own fix, which it may tell from its mirror. Once:
/// what is wrong with one is wrong with all.
void RunSurvey::TieByMagnet(const NorthFix& fix) {
  magnet_pending_ = false;
  NorthFix tie;
  tie.run = fix.run;
  tie.tool = fix.tool;
  tie.md = fix.md;
  tie.external = true;
  tie.begin = tie.end = fix.begin;
  tie.utc_begin = tie.utc_end = fix.utc_begin;
  tie.inclination = fix.inclination;
  tie.toolface = fix.toolface;
  tie.magnetic_azimuth = fix.magnetic_azimuth;
  tie.azimuth = WrapTwoPi(*fix.magnetic_azimuth + job_.magnetic->declination);
  tie.cov_attitude(1, 1) = job_.magnetic->sigma * job_.magnetic->sigma;
  UseFix(tie);
}

void RunSurvey::UseFix(NorthFix fix) {
  const bool wanted = fix.external || job_.alignment.use_fixes ||
                      job_.alignment.method == AlignmentSpec::Method::kGyrocompass;
  if (wanted && filter_) {
    const bool known_before = filter_->attitude().azimuth_known;
    const FilterFix used = filter_->Update(fix);
    if (known_before && used.use != FixUse::kNoKnot) {
      fix.chi_square = used.chi_square;
      fix.closure = used.closure;
      fix.sigma_closure = used.sigma_closure;
    }
    if (used.use == FixUse::kAmbiguous) {
      fix.quality |= Quality::kMirror;
    } else if (used.use != FixUse::kNoKnot) {
      fix.quality = Without(fix.quality, Quality::kMirror);
    }
    if (used.use == FixUse::kMirror) {
      std::swap(fix.azimuth, *fix.mirror_azimuth);
      fix.mirror_cost = -fix.mirror_cost;
    }
    if (filter_->attitude().azimuth_known) TellUnheard();
    SetTrackerAzimuth();
  }
  summary_.fixes.push_back(fix);
  if (!fix.external) ListStop(fix);
}

void RunSurvey::ListStop(const NorthFix& fix) {
  if (!fix.md) return;
  for (auto draft = drafts_.rbegin(); draft != drafts_.rend(); ++draft) {
    Station& s = draft->station;
    if (s.utc > fix.utc_end) continue;
    if (std::abs(s.md - *fix.md) > kSamePlace) return;
    s.kind = StationKind::kGyrocompass;
    TakeReferences(fix, s);
    s.quality |= fix.quality;
    if (job_.stations.at_stops && !draft->listed) {
      draft->listed = true;
      news_.push_back(static_cast<std::size_t>(drafts_.rend() - draft) - 1);
    }
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
  drafts_.push_back(draft);
  news_.push_back(drafts_.size() - 1);
}

}  // namespace wellgyro
