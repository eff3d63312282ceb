#include "wellgyro/survey/run_survey.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "wellgyro/alignment/gyrocompass.h"
#include "wellgyro/base/angle.h"
#include "wellgyro/calibration/field_checks.h"
#include "wellgyro/survey/choose.h"
#include "wellgyro/survey/hole_attitude.h"

namespace wellgyro {
namespace {

constexpr std::int64_t kKnotNs = 1'000'000'000;
// The still detector knows of a block when the one after it has ended.
constexpr Duration kMakeUpMind = Duration::Seconds(3);
constexpr double kRestSpeed = 0.006;       // [m/s], that of the still detector
constexpr double kSamePlace = 0.2;         // [m], between windows of one stop
constexpr double kSamePlaceSeconds = 120;  // the same where there is no depth
constexpr double kVague = FromDegrees(2);  // [rad], sigma of a fix's azimuth
constexpr double kLeastFraction = 1e-9;    // of a sample, at which it can be cut
constexpr double kJump = 50;  // [m] in one sample: no hole is logged so fast, the depth is wrong

VerticalSetup VerticalSetupOf(const Job& job) {
  VerticalSetup setup;
  setup.gyro = job.noise;
  setup.errors = job.errors;
  setup.start_is_axis = job.alignment.method == AlignmentSpec::Method::kExternal &&
                        job.alignment.of == AlignmentSpec::Of::kAxis;
  return setup;
}

TrackerOptions TrackerOptionsOf(const Job& job) {
  TrackerOptions options;
  // Below twice this the vertical filter takes over.
  options.inclination_min = std::asin(SineNearVertical(job.errors, false)) / 2;
  options.accel_noise = job.errors.accel_noise;
  options.angle_random_walk = job.noise.angle_random_walk;
  return options;
}

StillSetup StillSetupOf(const Job& job) {
  StillSetup setup;
  setup.gyro = job.noise;
  setup.errors = job.errors;
  setup.min_still = Duration::Seconds(job.alignment.min_still);
  return setup;
}

AlongHole Between(const AlongHole& a, const AlongHole& b, double fraction) {
  if (!a.known || !b.known) return {};
  const auto mix = [fraction](double x, double y) { return x + fraction * (y - x); };
  return {mix(a.md, b.md),
          mix(a.speed, b.speed),
          mix(a.acceleration, b.acceleration),
          mix(a.sigma_md, b.sigma_md),
          true,
          mix(a.sigma_speed, b.sigma_speed),
          mix(a.sigma_acceleration, b.sigma_acceleration)};
}

bool Covers(const StillWindow& window, ToolTime begin, ToolTime end) {
  return window.begin <= begin && end <= window.end;
}

}  // namespace

RunSurvey::RunSurvey(const Job& job, std::int32_t run, std::int32_t tool)
    : job_(job),
      site_(SiteAt(job.well.latitude, job.well.datum_elevation - job.tie_in.tvd)),
      north_(job.tie_in.north),
      tvd_(job.tie_in.tvd),
      plan_(job),
      tracker_(TrackerOptionsOf(job)),
      vertical_(VerticalSetupOf(job)),
      still_(StillSetupOf(job)),
      external_pending_(job.alignment.method == AlignmentSpec::Method::kExternal) {
  summary_.run = run;
  summary_.tool = tool;
}

void RunSurvey::Push(const ImuSample& sample, UtcTime utc, const AlongHole& along,
                     const AlongHole& middle) {
  if (summary_.samples == 0) summary_.begin = utc;
  ++summary_.samples;
  CountDepth(sample.stamp, along.known);
  PassState pass = passes_.state();
  if (along.known) pass = passes_.Push(utc, along.md);
  const bool taken = tracker_.Push(sample, middle, site_);
  if (sample.stamp.temperature_outside) temperature_outside_ = true;
  if (current_ && tracker_.ready() && tracker_.sample_begin() == current_->stamp.tool_time) {
    const bool contiguous = sample.stamp.seq == current_->stamp.seq + 1 &&
                            sample.stamp.session == current_->stamp.session;
    if (contiguous) current_->utc_end = utc;
    Summed(contiguous ? along : current_->along, pass);
  }
  if (taken) {
    const UtcTime utc_end = utc + Duration{sample.stamp.period_ns};
    current_ = Current{sample, middle, sample.stamp, utc, utc_end, along, pass};
    summary_.end = utc_end;
  }
  if (const auto window = still_.Push(sample, middle)) TakeWindow(*window);
  if (!group_.empty()) {
    const StillWindow& last = group_.back();
    const bool left = last.md && along.known
                          ? std::abs(along.md - *last.md) > kSamePlace
                          : (sample.stamp.tool_time - last.end).seconds() > kSamePlaceSeconds;
    if (left) CloseGroup();
  }
}

void RunSurvey::CountDepth(const SampleStamp& stamp, bool known) {
  if (known) {
    if (depth_seen_) summary_.seconds_without_depth += seconds_unknown_;
    seconds_unknown_ = 0;
    depth_seen_ = true;
  } else {
    seconds_unknown_ += 1e-9 * stamp.period_ns;
  }
}

void RunSurvey::Cut(std::optional<std::int32_t> index_position) {
  vertical_.Release();
  resting_ = false;
  if (const auto window = still_.Cut(index_position)) TakeWindow(*window);
}

void RunSurvey::TakeStation(std::optional<double> md) {
  asked_ = true;
  asked_md_ = md;
}

void RunSurvey::Flush() {
  tracker_.Flush();
  if (current_ && tracker_.ready() && tracker_.sample_begin() == current_->stamp.tool_time) {
    // A run that ends on its way down ends in a station.
    const AlongHole& end = current_->along;
    asked_ = asked_ || (end.known && passes_.state().pass == Pass::kIn &&
                        std::abs(end.md - last_mark_md_) > kSameDepth);
    Summed(end, passes_.state());
    current_.reset();
  }
  if (const auto window = still_.Flush()) TakeWindow(*window);
  Release(true);
  CloseGroup();
}

Draft RunSurvey::NewDraft(double md) const {
  Draft draft;
  Station& s = draft.station;
  s.run = summary_.run;
  s.tool = summary_.tool;
  s.pass = current_->pass.pass;
  s.pass_number = current_->pass.number;
  s.md = md;
  return draft;
}

/// The sample in current_ has been summed: makes the knots that fall into it.
void RunSurvey::Summed(const AlongHole& end, const PassState& pass_end) {
  cuts_.clear();
  const Current& c = *current_;
  vertical_.Push(c.sample, c.middle, site_);
  resting_ = c.middle.known && std::abs(c.middle.speed) < kRestSpeed;
  if (c.along.known && end.known && pass_end.number == c.pass.number &&
      c.pass.pass != Pass::kStationary) {
    AddTargets(pass_end.md);
  }
  const double period = static_cast<double>(c.stamp.period_ns);
  const std::int64_t begin = c.stamp.tool_time.ns;
  const std::int64_t second = (begin / kKnotNs + 1) * kKnotNs;
  if (second <= begin + c.stamp.period_ns) {
    cuts_.push_back({static_cast<double>(second - begin) / period, std::nullopt, false});
  }
  const std::optional<UtcTime>& at_utc = job_.alignment.at_utc;
  if (at_utc && *at_utc >= c.utc && *at_utc < c.utc_end) {
    const double fraction = (*at_utc - c.utc).seconds() / (period * 1e-9);
    cuts_.push_back({std::clamp(fraction, kLeastFraction, 1.0), std::nullopt, true});
  }
  if (asked_ && (asked_md_ || end.known)) {
    cuts_.push_back({1.0, NewDraft(asked_md_.value_or(end.md)), false});
  }
  asked_ = false;
  if (const auto rest = RestDraft(end)) cuts_.push_back({1.0, rest, false});
  std::stable_sort(cuts_.begin(), cuts_.end(),
                   [](const KnotAt& a, const KnotAt& b) { return a.fraction < b.fraction; });
  for (const KnotAt& cut : cuts_) CutAt(cut, end);
  if (!cuts_.empty()) Release(false);
}

/// The asked depths that the tool passes within the sample, up to `md_end`.
void RunSurvey::AddTargets(double md_end) {
  const PassState& pass = current_->pass;
  const double way = md_end - pass.md;
  if (std::abs(way) > kJump || (way == 0 && !pass.begins)) return;
  // A first pass begins where the tool stood; between any other turn and its discovery the depths
  // belong to the pass before.
  const bool first = pass.begins && std::abs(pass.md_turn - pass.md) <= 2 * kSameDepth;
  plan_.Between(first ? pass.md_turn : pass.md, md_end, first, targets_);
  for (const StationPlan::Target& target : targets_) {
    if (first && marked_ && std::abs(target.md - last_mark_md_) <= kSameDepth) {
      // The station of the stop is there already.
      if (target.listed) ListLastMark();
      continue;
    }
    const double fraction =
        way != 0 ? std::clamp((target.md - pass.md) / way, kLeastFraction, 1.0) : 1.0;
    Draft draft = NewDraft(target.md);
    draft.listed = target.listed;
    const bool external =
        job_.alignment.at_md && std::abs(target.md - *job_.alignment.at_md) <= kSameDepth;
    cuts_.push_back({fraction, draft, external});
  }
}

void RunSurvey::ListLastMark() {
  for (auto waiting = waiting_.rbegin(); waiting != waiting_.rend(); ++waiting) {
    if (!waiting->draft) continue;
    waiting->draft->listed = true;
    return;
  }
  if (drafts_.empty() || drafts_.back().listed) return;
  drafts_.back().listed = true;
  news_.push_back(drafts_.size() - 1);
}

/// A tool that comes to rest makes a station, listed only if the job asks for stops or if it turns
/// out to be the deepest.
std::optional<Draft> RunSurvey::RestDraft(const AlongHole& end) const {
  if (!end.known || std::abs(end.speed) > std::max(kRestSpeed, 4 * end.sigma_speed)) {
    return std::nullopt;
  }
  if (marked_ && std::abs(end.md - last_mark_md_) <= kSameDepth) return std::nullopt;
  Draft draft = NewDraft(end.md);
  draft.listed = false;
  return draft;
}

void RunSurvey::CutAt(const KnotAt& cut, const AlongHole& end) {
  const auto& [fraction, draft, external] = cut;
  const Current& c = *current_;
  const ToolTime begin = last_knot_.value_or(c.stamp.tool_time);
  Knot knot = tracker_.CutKnot(fraction);
  const bool again = last_knot_ && knot.time <= *last_knot_;
  if (again && (waiting_.empty() || waiting_.back().draft)) return;
  if (!again) {
    last_knot_ = knot.time;
    if (temperature_outside_) knot.quality |= Quality::kTemperature;
    temperature_outside_ = false;
    knot.utc = c.utc + Duration::Seconds(fraction * (c.utc_end - c.utc).seconds());
    knot.along = Between(c.along, end, fraction);
    vertical_.CutKnot((1 - fraction) * 1e-9 * c.stamp.period_ns, knot);
    waiting_.push_back({knot, begin, std::nullopt, false, std::nullopt});
    if (vertical_.running()) waiting_.back().from_zero = vertical_.azimuth_from_zero();
    lost_since_listed_ = lost_since_listed_ || knot.samples_lost > 0;
  }
  // Two cuts within one nanosecond are one knot.
  Waiting& last = waiting_.back();
  last.external = last.external || external;
  if (draft) {
    last.knot.along.md = draft->station.md;
    last_mark_md_ = draft->station.md;
    marked_ = true;
    last.draft = draft;
    Station& s = last.draft->station;
    s.utc = last.knot.utc;
    s.tool_time = last.knot.time;
    s.imu_seq_begin = last.knot.seq_begin;
    s.imu_seq_end = last.knot.seq_end;
    s.samples_lost = last.knot.samples_lost;
    if (lost_since_listed_) s.quality |= Quality::kGap;
    if (draft->listed) lost_since_listed_ = false;
  }
}

void RunSurvey::Release(bool all) {
  if (waiting_.empty()) return;
  const std::optional<StillWindow> open = still_.OpenWindow();
  const auto covered = [&](const Waiting& w) {
    if (open && Covers(*open, w.begin, w.knot.time)) return true;
    return std::any_of(group_.begin(), group_.end(), [&](const StillWindow& window) {
      return Covers(window, w.begin, w.knot.time);
    });
  };
  const ToolTime newest = waiting_.back().knot.time;
  std::size_t done = 0;
  for (; done < waiting_.size(); ++done) {
    Waiting& w = waiting_[done];
    const bool still = covered(w);
    if (!still && !all && newest - w.knot.time < kMakeUpMind) break;
    w.knot.still = still;
    // Known late, but nothing that has been seen since says that it has moved.
    if (still && resting_) vertical_.Hold();
    StepFilter(w);
  }
  waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(done));
}

void RunSurvey::StartFilter(const Knot& knot) {
  FilterSetup setup;
  setup.gyro = job_.noise;
  setup.errors = job_.errors;
  setup.site = site_;
  const AlignmentSpec& spec = job_.alignment;
  if (external_pending_ && !spec.at_md && !spec.at_utc) {
    external_pending_ = false;
    setup.start_azimuth = AxisAzimuth(knot.inclination, knot.toolface - knot.roll);
    setup.start_sigma = spec.sigma_azimuth;
  }
  filter_.emplace(setup);
}

/// The job's external azimuth as that of the axis, for a tool at this inclination and toolface.
double RunSurvey::AxisAzimuth(double inclination, double toolface) const {
  if (job_.alignment.of == AlignmentSpec::Of::kAxis) return job_.alignment.azimuth;
  AttitudeSample at_zero;
  at_zero.inclination = inclination;
  at_zero.toolface = toolface;
  return job_.alignment.azimuth - DirectionOfMark(at_zero);
}

void RunSurvey::StepFilter(const Waiting& waiting) {
  const Knot& knot = waiting.knot;
  MoveSite(knot);
  if (!filter_) StartFilter(knot);
  filter_->Step(knot);
  from_zero_ = waiting.from_zero;
  // Also without a fix: behind a stretch near vertical it may turn out never to have been lost.
  if (filter_->attitude().azimuth_known) TellUnheard();
  if (waiting.draft) {
    filter_->MarkStation();
    drafts_.push_back(*waiting.draft);
    Draft& draft = drafts_.back();
    draft.state = filter_->stations().size() - 1;
    if (!knot.along.known) draft.station.quality |= Quality::kDepth;
    (filter_->attitude().azimuth_known ? news_ : unheard_).push_back(drafts_.size() - 1);
  }
  if (waiting.external && external_pending_) {
    external_pending_ = false;
    NorthFix fix;
    fix.begin = fix.end = knot.time;
    fix.utc_begin = fix.utc_end = knot.utc;
    fix.md = knot.along.md;
    fix.external = true;
    fix.inclination = knot.inclination;
    fix.toolface = knot.toolface;
    fix.azimuth = AxisAzimuth(knot.inclination, knot.toolface);
    fix.cov_attitude(1, 1) = job_.alignment.sigma_azimuth * job_.alignment.sigma_azimuth;
    UseFix(fix);
  }
  SetTrackerAzimuth();
}

void RunSurvey::TellUnheard() {
  news_.insert(news_.end(), unheard_.begin(), unheard_.end());
  unheard_.clear();
}

void RunSurvey::SetTrackerAzimuth() {
  const AttitudeSample& now = filter_->attitude();
  tracker_.SetAzimuth(now.azimuth_known ? std::optional<double>(now.azimuth) : std::nullopt);
  if (!from_zero_) return;
  std::optional<double> zero;
  if (now.azimuth_known) zero = filter_->history().epochs.back().azimuth - *from_zero_;
  vertical_.SetNorth(zero);
}

/// Latitude and height follow the path, roughly: a kilometre is 1e-2 deg and 0.1 mg.
void RunSurvey::MoveSite(const Knot& knot) {
  if (!knot.along.known) return;
  if (!site_md_) {
    // Where a run begins below the tie-in, the hole between counts as vertical.
    tvd_ += std::max(knot.along.md - job_.tie_in.md, 0.0);
  } else {
    const double way = knot.along.md - *site_md_;
    tvd_ += way * std::cos(knot.inclination);
    if (filter_ && filter_->attitude().azimuth_known) {
      north_ += way * std::sin(knot.inclination) * std::cos(filter_->attitude().azimuth);
    }
  }
  site_md_ = knot.along.md;
  site_ =
      SiteAt(job_.well.latitude + north_ / site_.radius_north, job_.well.datum_elevation - tvd_);
}

void RunSurvey::TakeWindow(const StillWindow& window) {
  if (!group_.empty()) {
    const StillWindow& last = group_.back();
    const bool here = last.md && window.md
                          ? std::abs(*window.md - *last.md) <= kSamePlace
                          : (window.begin - last.end).seconds() <= kSamePlaceSeconds;
    if (!here) CloseGroup();
  }
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
      if (check.code != "earth_rate_vertical") continue;
      check.run = summary_.run;
      summary_.stop_checks.push_back(std::move(check));
    }
  }
}

void RunSurvey::CloseGroup() {
  if (group_.empty()) return;
  // What lies before the end of the stop is decided; the fix needs it in the filter.
  const ToolTime end = group_.back().end;
  while (!waiting_.empty() && waiting_.front().knot.time <= end) {
    Waiting first = waiting_.front();
    first.knot.still = std::any_of(group_.begin(), group_.end(), [&](const StillWindow& window) {
      return Covers(window, first.begin, first.knot.time);
    });
    waiting_.erase(waiting_.begin());
    StepFilter(first);
  }
  CheckStop();
  GyrocompassSetup setup;
  setup.gyro = job_.noise;
  setup.errors = job_.errors;
  NorthFix fix = Gyrocompass(group_, site_, setup);
  fix.md = group_.back().md;
  group_.clear();
  UseFix(fix);
}

void RunSurvey::UseFix(const NorthFix& fix) {
  NorthFix kept = fix;
  kept.run = summary_.run;
  kept.tool = summary_.tool;
  const bool wanted = fix.external || job_.alignment.use_fixes ||
                      job_.alignment.method == AlignmentSpec::Method::kGyrocompass;
  if (wanted && filter_) {
    const bool known_before = filter_->attitude().azimuth_known;
    NorthFix given = kept;
    // Near east-west and horizontal the cost of azimuth is no parabola: the filter, which is
    // linear, would take the rates of such a stop for far more than the fix itself says.
    if (std::sqrt(fix.cov_attitude(1, 1)) > kVague) given.from_samples = false;
    const FilterFix used = filter_->Update(given);
    if (known_before && used.use != FixUse::kNoKnot) kept.chi_square = used.chi_square;
    if (used.use == FixUse::kAmbiguous) kept.quality |= Quality::kMirror;
    if (filter_->attitude().azimuth_known) TellUnheard();
    SetTrackerAzimuth();
  }
  summary_.fixes.push_back(kept);
  if (!fix.external) ListStop(kept);
}

void RunSurvey::ListStop(const NorthFix& fix) {
  if (!fix.md) return;
  for (auto draft = drafts_.rbegin(); draft != drafts_.rend(); ++draft) {
    Station& s = draft->station;
    if (s.utc > fix.utc_end) continue;
    if (std::abs(s.md - *fix.md) > kSamePlace) return;
    s.kind = StationKind::kGyrocompass;
    s.gravity = fix.gravity;
    s.gravity_ref = fix.gravity_ref;
    s.earth_rate = fix.earth_rate;
    s.earth_rate_ref = fix.earth_rate_ref;
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
  GyrocompassSetup setup;
  setup.gyro = job_.noise;
  setup.errors = job_.errors;
  NorthFix fix = Gyrocompass({&placed, 1}, site_, setup);
  fix.md = placed.md;
  fix.run = summary_.run;
  fix.tool = summary_.tool;
  fix.from_samples = false;
  summary_.fixes.push_back(fix);
  if (!fix.md) return;
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
  s.gravity = fix.gravity;
  s.gravity_ref = fix.gravity_ref;
  s.earth_rate = fix.earth_rate;
  s.earth_rate_ref = fix.earth_rate_ref;
  draft.attitude = {window.end, fix.inclination,  fix.azimuth, fix.toolface,
                    true,       fix.cov_attitude, fix.quality};
  drafts_.push_back(draft);
  news_.push_back(drafts_.size() - 1);
}

std::vector<std::size_t> RunSurvey::News() { return std::exchange(news_, {}); }

void RunSurvey::ListLastDepth() {
  Draft* deepest = nullptr;
  for (Draft& draft : drafts_) {
    if (draft.station.pass == Pass::kOut) continue;
    if (!deepest || draft.station.md > deepest->station.md) deepest = &draft;
  }
  if (deepest && job_.stations.every > 0) deepest->listed = true;
}

}  // namespace wellgyro
