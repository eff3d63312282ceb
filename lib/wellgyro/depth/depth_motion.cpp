#include "wellgyro/depth/depth_motion.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace wellgyro {
namespace {

// Between marks: 2 s less jitter, and at most T = 10 s, over which white noise N = 2e-4
// m/s^2/sqrt(Hz), integrated twice, makes N T^1.5 / sqrt(3) = 3.7 mm.
constexpr Duration kMarksApart{1'900'000'000};
constexpr double kFar = 10;
// Between samples, from which nothing is felt: a start at 0.3 m/s^2 hidden in it is 4 cm.
constexpr Duration kGap{500'000'000};
constexpr double kLeast = 1e-3;  // sigma of a step: no depth is read to less [m]
// Lag [s] that a step at a start may be in place of itself. Marks that are later than this by their
// stamps are told twice, as a step too; with 2 s a true step of 1 m would pass where a string
// starts at 0.5 m/s.
constexpr double kLag = 1;
// Lag [s] that is told in full: half of the 6 s that four marks span, where first order in it ends.
constexpr double kLagMost = 3;
constexpr double kScaleMost = 5;  // that is told in full: more than the feet of a metre
// Resolution of depth that does not matter [m]; what digits round off a multiple is less.
constexpr double kNoStep = 1e-3;
// Steps before their scatter is known, then to sqrt((pi/2 - 1) / 20) = 17 %.
constexpr std::int64_t kFirst = 20;

/// Nothing that a sample's force does not tell of.
bool IsBridged(Duration gap) { return gap <= kGap && Duration{-gap.ns} <= kGap; }

/// The way between the middle two less the mean of the ways beside it, of values at four times.
double Bow(const std::array<double, 4>& t, const std::array<double, 4>& x) {
  const auto slope = [&](std::size_t i) { return (x[i + 1] - x[i]) / (t[i + 1] - t[i]); };
  return (slope(1) - (slope(0) + slope(2)) / 2) * (t[2] - t[1]);
}

/// Greatest length of which both are whole multiples, to kNoStep; Euclid's.
double CommonStep(double a, double b) {
  while (b > kNoStep) a = std::exchange(b, std::abs(std::remainder(a, b)));
  return a;
}

}  // namespace

void DepthMotion::Restart() { passed_count_ = 0; }

/// Of a sample: the force along the tool, less gravity's share at its middle.
inline double DepthMotion::Fall::Force(const SixAxes& s, double length) {
  const double change = (s[1] * s[3] - s[0] * s[4]) * length;
  const double f_z = s[5] - gravity - change / 2;
  gravity += change;
  return f_z;
}

inline void DepthMotion::Fall::Go(double f_z, double seconds) {
  way += (speed + f_z * seconds / 2) * seconds;
  speed += f_z * seconds;
}

void DepthMotion::Feel(std::span<const UtcTime> utc, Duration period,
                       std::span<const SixAxes> samples, const DepthTrack& track) {
  NoMark none = NoMarkYet();
  for (std::size_t i = 0; i < utc.size(); ++i) {
    i += FeelOn(utc.subspan(i), period, samples.subspan(i), none);
    if (i < utc.size()) none = FeelOne(utc[i], period, samples[i], track);
  }
}

/// Feels the samples at the begin that adjoin each other and pass no mark, nearly all there are;
/// how many that is.
std::size_t DepthMotion::FeelOn(std::span<const UtcTime> utc, Duration period,
                                std::span<const SixAxes> samples, const NoMark& none) {
  if (!felt_until_) return 0;
  const double length = period.seconds();
  UtcTime begin = *felt_until_;
  Fall fall = fall_;
  std::size_t i = 0;
  for (; i < utc.size(); ++i) {
    const Duration gap = utc[i] - begin;
    const UtcTime end = utc[i] + period;
    if (!IsBridged(gap) || !none.Holds(begin, end)) break;
    fall.Go(fall.Force(samples[i], length), length + gap.seconds());
    begin = end;
  }
  felt_until_ = begin;
  fall_ = fall;
  return i;
}

/// One sample, whatever it brings. Where the next may pass no mark.
DepthMotion::NoMark DepthMotion::FeelOne(UtcTime utc, Duration period, const SixAxes& sample,
                                         const DepthTrack& track) {
  const double length = period.seconds(), f_z = fall_.Force(sample, length);
  const Duration gap = felt_until_ ? utc - *felt_until_ : Duration{};
  if (!IsBridged(gap)) {
    passed_count_ = 0;
    fall_.speed = fall_.way = 0;
  }
  // A gap up to kGap is bridged with the force of the sample behind it. So is what the clocks'
  // tie moves UTC by, either way: in 10 s of fall 3 ms between its time and the marks' are 0.3 m.
  const bool bridged = felt_until_ && IsBridged(gap);
  const UtcTime begin = bridged ? *felt_until_ : utc;
  felt_until_ = utc + period;
  NoMark none = NoMarkYet();
  if (!none.Holds(begin, *felt_until_)) none = PassMark(begin, f_z, track);
  fall_.Go(f_z, bridged ? length + gap.seconds() : length);
  return none;
}

/// Marks are compared that are far enough behind the last.
DepthMotion::NoMark DepthMotion::NoMarkYet() const {
  if (!last_mark_) return {};
  return {UtcTime{INT64_MIN}, *last_mark_ + kMarksApart};
}

/// The mark, if there is one to be compared, in a sample that begins at `begin`. Where no other is.
DepthMotion::NoMark DepthMotion::PassMark(UtcTime begin, double f_z, const DepthTrack& track) {
  const UtcTime wanted = last_mark_ ? std::max(begin, *last_mark_ + kMarksApart) : begin;
  if (wanted >= *felt_until_) return NoMarkYet();
  const std::optional<MarkRead> mark = track.FirstMark(wanted);
  if (!mark) return {begin, UtcTime{INT64_MAX}};
  if (mark->utc >= *felt_until_) return {begin, mark->utc};
  const double t = (mark->utc - begin).seconds();
  last_mark_ = mark->utc;
  if (!first_md_) first_md_ = mark->md;
  Resolve(mark->md - *first_md_);
  const double way = fall_.way + (fall_.speed + f_z * t / 2) * t;
  Pass({mark->utc, mark->md, fall_.speed + f_z * t, way});
  FallFromOldest(begin);
  return NoMarkYet();
}

void DepthMotion::Pass(const Passed& passed) {
  if (passed_count_ > 0 && (passed.utc - passed_[passed_count_ - 1].utc).seconds() > kFar) {
    passed_count_ = 0;
  }
  if (passed_count_ == kMarks) {
    std::rotate(passed_.begin(), passed_.begin() + 1, passed_.end());
    --passed_count_;
  }
  passed_[passed_count_++] = passed;
  if (passed_count_ < kMarks) return;
  Compare();
}

void DepthMotion::Resolve(double way) {
  if (std::abs(way) > kNoStep) found_.resolution = CommonStep(std::abs(way), found_.resolution);
}

/// A third difference does not see a constant speed, but a clock does: gravity summed up over hours
/// is 1e5 m/s, by which a microsecond between the samples' time and the marks' is a step of 0.1 m.
void DepthMotion::FallFromOldest(UtcTime now) {
  const Passed oldest = passed_.front();
  const auto take = [&oldest](UtcTime utc, double& speed, double& way) {
    way -= oldest.way + oldest.speed * (utc - oldest.utc).seconds();
    speed -= oldest.speed;
  };
  take(now, fall_.speed, fall_.way);
  for (std::size_t i = 0; i < passed_count_; ++i) {
    take(passed_[i].utc, passed_[i].speed, passed_[i].way);
  }
}

/// 1-sigma of one step from the mean |step|: E|x| = sqrt(2/pi) sigma = sigma / 1.2533.
double DepthMotion::Sigma() const {
  if (found_.compared < kFirst) return 0;
  return std::max(1.2533 * sum_size_ / static_cast<double>(found_.compared), kLeast);
}

void DepthMotion::Compare() {
  std::array<double, kMarks> t, way, rate, md;
  const Passed& first = passed_.front();
  const double whole = (passed_.back().utc - first.utc).seconds();
  const double mean = (passed_.back().speed - first.speed) / whole;  // gravity's share
  for (std::size_t i = 0; i < kMarks; ++i) {
    const Passed& p = passed_[i];
    t[i] = (p.utc - first.utc).seconds();
    way[i] = p.way - first.way - first.speed * t[i] - mean * t[i] * t[i] / 2;
    rate[i] = p.speed - first.speed - mean * t[i];
  }
  std::array<double, kMarks> left;
  for (std::size_t i = 0; i < kMarks; ++i) md[i] = passed_[i].md - first.md;
  for (std::size_t i = 0; i < kMarks; ++i) left[i] = md[i] - way[i];
  const double step = Bow(t, left), felt = Bow(t, rate);
  const double sigma = Sigma();
  const double most = sigma > 0 ? 4 * sigma : HUGE_VAL;
  ++found_.compared;
  sum_size_ += std::min(std::abs(step), most);
  const double beyond_lag = std::max(std::abs(step) - kLag * std::abs(felt), 0.0);
  if (beyond_lag > std::abs(found_.step)) {
    found_.step = std::copysign(beyond_lag, step);
    found_.step_md = passed_[2].md;
  }
  // A step that falls on a start must not count as lag: bounded to kLagMost.
  const double lags = most + kLagMost * std::abs(felt);
  const double held = std::clamp(step, -lags, lags);
  rate2_ += felt * felt;
  rate_step_ += felt * held;
  AddScale(Bow(t, way), Bow(t, md));
}

/// A jump of the marks is none of what is felt there, and counts for no more than a start.
void DepthMotion::AddScale(double way, double mark) {
  const double most = kScaleMost * std::abs(way) + kLeast;
  const double held = std::clamp(mark, -most, most);
  way2_ += way * way;
  way_mark_ += way * held;
  mark2_ += held * held;
}

DepthMotion::Found DepthMotion::found() const {
  Found found = found_;
  found.sigma_step = Sigma();
  if (way2_ > 0 && found.compared > kFirst) {
    found.scale = way_mark_ / way2_;
    const double left = std::max(mark2_ - found.scale * way_mark_, 0.0);
    found.sigma_scale = std::sqrt(left / static_cast<double>(found.compared) / way2_);
  }
  if (!(found.sigma_step > 0) || !(rate2_ > 0)) return found;
  found.lag = -rate_step_ / rate2_;
  found.sigma_lag = found.sigma_step / std::sqrt(rate2_);
  return found;
}

}  // namespace wellgyro
