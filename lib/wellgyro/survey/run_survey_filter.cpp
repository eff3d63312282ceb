// Knots into the filter, once the still detector has made up its mind about them.
#include <algorithm>
#include <cmath>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/survey/hole_attitude.h"
#include "wellgyro/survey/run_survey.h"

namespace wellgyro {
namespace {

// The still detector knows of a block when the one after it has ended.
constexpr Duration kMakeUpMind = Duration::Seconds(3);

/// The filter carries of the accelerometers' errors a bias alone: their scale and misalignment, at
/// one g, count in it.
ErrorPriors WithScaleInBias(ErrorPriors errors) {
  const double relative = std::hypot(errors.accel_scale_sigma, errors.accel_misalignment_sigma);
  errors.accel_bias_sigma = std::hypot(errors.accel_bias_sigma, relative * units::kStandardGravity);
  return errors;
}

}  // namespace

/// A stop, or what may still become one, covers all of this knot.
bool RunSurvey::IsStill(const Waiting& waiting, const std::optional<StillWindow>& open) const {
  const auto covers = [&waiting](const StillWindow& window) {
    return window.begin <= waiting.begin && waiting.knot.time <= window.end;
  };
  return (open && covers(*open)) || std::any_of(group_.begin(), group_.end(), covers);
}

void RunSurvey::Release(bool all) {
  if (waiting_.empty()) return;
  const std::optional<StillWindow> open = still_.OpenWindow();
  const ToolTime newest = waiting_.back().knot.time;
  std::size_t done = 0;
  for (; done < waiting_.size(); ++done) {
    Waiting& w = waiting_[done];
    const bool still = IsStill(w, open);
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
  setup.errors = WithScaleInBias(job_.errors);
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

/// The job's azimuth holds at this knot.
void RunSurvey::UseExternal(const Knot& knot) {
  external_pending_ = false;
  NorthFix fix;
  fix.run = summary_.run;
  fix.tool = summary_.tool;
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
  if (waiting.external && external_pending_) UseExternal(knot);
  SetTrackerAzimuth();
}

void RunSurvey::TellUnheard() {
  news_.insert(news_.end(), unheard_.begin(), unheard_.end());
  unheard_.clear();
}

bool RunSurvey::IsUnheard(std::size_t draft) const {
  return std::binary_search(unheard_.begin(), unheard_.end(), draft);
}

void RunSurvey::SetTrackerAzimuth() {
  const AttitudeSample& now = filter_->attitude();
  tracker_.SetAzimuth(now.azimuth_known ? std::optional<double>(now.azimuth) : std::nullopt);
  if (!from_zero_) return;
  std::optional<double> zero;
  const FilterEpoch& last = filter_->history().epochs.back();
  if (now.azimuth_known) zero = last.azimuth - *from_zero_;
  vertical_.SetNorth(zero, last.sigma_azimuth);
}

/// Latitude and height follow the path, roughly: a kilometre is 1e-2 deg and 0.1 mg.
void RunSurvey::MoveSite(const Knot& knot) {
  if (!knot.along.known || !std::isfinite(knot.along.md) || !std::isfinite(knot.inclination))
    return;
  if (!site_md_) {
    // Where a run begins below the tie-in, the hole between counts as vertical.
    tvd_ += std::max(knot.along.md - job_.tie_in.md, 0.0);
  } else {
    const double way = knot.along.md - *site_md_;
    tvd_ += way * std::cos(knot.inclination);
    const bool north = filter_ && filter_->attitude().azimuth_known;
    if (north && std::isfinite(filter_->attitude().azimuth)) {
      north_ += way * std::sin(knot.inclination) * std::cos(filter_->attitude().azimuth);
    }
  }
  site_md_ = knot.along.md;
  // Damaged depths may lead anywhere; the site stays on the Earth.
  constexpr double kReach = 1e5;  // [m]
  tvd_ = std::clamp(tvd_, -kReach, kReach);
  north_ = std::clamp(north_, -kReach, kReach);
  const double latitude = job_.well.latitude + north_ / site_.radius_north;
  site_ = SiteAt(std::clamp(latitude, -kPi / 2, kPi / 2), job_.well.datum_elevation - tvd_);
}

}  // namespace wellgyro
