#include "wellgyro/survey/intake/sample_watch.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/depth/stop_match.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/survey/intake/station_marks.h"
#include "wellgyro/survey/verdict/check_internal.h"

namespace wellgyro {
namespace {

// [ns], of faster streams one sample in 20 ms is looked at: 10 kHz then cost as 50 Hz do, and 20
// rpm turn by 2.4 deg from one to the next.
constexpr std::int64_t kEveryNs = 20'000'000;
// An axis that repeats one value for so long is suspected: at rest later, where a good axis may
// stay within one quantisation step.
constexpr double kStuckMoving = 2, kStuckAtRest = 20;  // [s]
constexpr std::int64_t kRepeats = 10;                  // at least, where samples are seconds apart
// P(so many repeats) of a working axis, below which it fails: six axes looked at 50 times a second
// have one such in 39 days.
constexpr double kChance = 1e-9;
constexpr double kDead = 0.9;  // share of the run, from which an axis told next to nothing of it
// [s], of the integrals of w x f that are compared with f_z: near horizontal at 0.5 m/s a bend of
// 3 deg/30 m changes f_z by 0.26 m/s^2 in it, nine times kForceLeft.
constexpr double kStretch = 30;
// Of a value, what dividing counts by a sample's length leaves of a repeat: lengths are differences
// of times, exact to 1e-16 of hours.
constexpr double kSameValue = 1e-9;
// 1-sigma of what the products do not predict of f_z's change over a stretch, by the string's
// starts and stops [m/s^2]. Two ends within kSteady, evenly: 0.016; twice that.
constexpr double kForceLeft = 0.03;
// Chi-square by which another pairing must explain more, 5 sigma ...
constexpr double kBetter = 25;
// ... and the share of it that it may leave, half in amplitude: one that is right leaves noise.
constexpr double kLeaves = 0.25;
// Of the ratio of turns, no calibrated gyro is so far off as kUnitWrong; with a sigma of kUnitTells
// the limit kUnitWrong + 6 sigma is 0.75, below the 0.98 of deg/s that are taken for rad/s.
constexpr double kUnitTells = 0.1;
constexpr double kUnitWrong = 0.15;
// [s], of a mean rate at rest: gyros of 0.05 deg/sqrt(h) tell it to 0.95 deg/h, 6 % of the Earth's.
constexpr double kRestBlock = 10;
// Where the place is left open [m/s^2]: 9.780 to 9.832 on the ellipsoid are within 0.28 % of it.
constexpr double kGravity = units::kStandardGravity;
// [s], of either end of a stop that may move: the string still swings when its depth rests.
constexpr double kSettles = 10;

constexpr const char* kAxisNames[] = {"gyro x",  "gyro y",  "gyro z",
                                      "accel x", "accel y", "accel z"};
// In the order of PredictionsOf().
constexpr const char* kPairingNames[] = {
    "as the job has them",
    "accelerometer x or gyro y inverted",
    "accelerometer y or gyro x inverted",
    "accelerometer z or both gyros inverted",
    "gyros x and y swapped",
    "gyros or accelerometers swapped, and one of x inverted",
    "gyros or accelerometers swapped, and one of y inverted",
    "accelerometers x and y swapped",
};

/// f_z' by each pairing, from the integrals of products(gyro axis, accelerometer axis).
std::array<double, 8> PredictionsOf(const Eigen::Matrix2d& p) {
  const double xx = p(0, 0), xy = p(0, 1), yx = p(1, 0), yy = p(1, 1);
  return {yx - xy, -yx - xy, yx + xy, -yx + xy, xx - yy, -xx - yy, xx + yy, -xx + yy};
}

/// Where the string neither starts nor stops, f_z is gravity's share.
bool IsSteady(const AlongHole& along) {
  // [m/s^2]: 1 cm of encoder at 10 Hz gives an acceleration to 3e-3, a start has 0.3.
  constexpr double kSteady = 0.02;
  return along.known && std::abs(along.acceleration) < kSteady;
}

double ValueOf(const ImuSample& sample, std::size_t axis) {
  const auto i = static_cast<Eigen::Index>(axis % 3);
  return axis < 3 ? sample.w_IT_T[i] : sample.f_T[i];
}

/// Units that are taken for m/s2.
std::string_view AccelUnitOf(double ratio) {
  struct Unit {
    double ratio;
    std::string_view words;
  };
  constexpr Unit kUnits[] = {{1 / kGravity, ": g taken for m/s2"},
                             {1000 / kGravity, ": thousandths of g taken for m/s2"},
                             {1 / units::kFoot, ": ft/s2 taken for m/s2"},
                             {100, ": Gal taken for m/s2"}};
  // Thousandths of g and Gal are 2 % apart, gravity and accelerometers together .5 %.
  for (const Unit& unit : kUnits) {
    if (std::abs(ratio / unit.ratio - 1) < 0.01) return unit.words;
  }
  return {};
}

Check Failed(std::string code, std::int32_t run, double value, std::string unit, std::string why) {
  Check check = NotDone(std::move(code), run, std::move(why));
  check.value = value;
  check.unit = std::move(unit);
  check.verdict = Verdict::kFail;
  return check;
}

}  // namespace

SampleWatch::SampleWatch(const Job& job) : job_(job) {}

void SampleWatch::Push(std::span<const ImuSample> samples, const AlongHoleBlock& along,
                       std::size_t at) {
  const auto n = static_cast<std::int64_t>(samples.size());
  std::int64_t i = std::max<std::int64_t>(wait_ - 1, 0);
  for (; i < n; i += stride_) {
    const auto k = static_cast<std::size_t>(i);
    Watch(samples[k], along.At(at + k));
  }
  wait_ = i - n + 1;
}

SampleWatch::Stretch SampleWatch::StretchFrom(const ImuSample& sample, const AlongHole& along) {
  Stretch stretch{.begin_f_z = sample.f_T.z(), .steady = IsSteady(along)};
  if (along.known) stretch.md = along.md;
  return stretch;
}

void SampleWatch::Watch(const ImuSample& sample, const AlongHole& along) {
  const SampleStamp& stamp = sample.stamp;
  const bool continues =
      last_ && last_->session == stamp.session && last_->seq + stride_ == stamp.seq;
  stride_ = std::max<std::int64_t>(1, kEveryNs / std::max(stamp.period_ns, 1));
  period_ = 1e-9 * static_cast<double>(stride_ * stamp.period_ns);
  const bool rests = along.known && std::abs(along.speed) < kRestSpeed;
  if (!continues) stretch_ = StretchFrom(sample, along);
  WatchAxes(sample, along, rests);
  WatchBend(sample, along, period_);
  WatchRest(sample, along, rests, period_);
  ++samples_;
  seconds_ += period_;
  last_ = stamp;
}

std::int64_t SampleWatch::Busiest(std::size_t besides) const {
  std::int64_t most = 0;
  for (std::size_t i = 0; i < kAxes; ++i) {
    if (i != besides) most = std::max(most, axes_[i].changes);
  }
  return most;
}

/// P(this many repeats) for a working axis: a signal amid one quantisation step, Gaussian noise as
/// stated, erf(step / (sqrt(8) sigma))^repeats.
double SampleWatch::ChanceOfRepeats(std::size_t i) const {
  const Axis& axis = axes_[i];
  const double noise = i < 3 ? job_.noise.angle_random_walk : job_.errors.accel_noise;
  const double sigma = noise / std::sqrt(1e-9 * static_cast<double>(last_->period_ns));
  if (!(sigma > 0)) return 1;
  const double same = std::erf(axis.step / (std::sqrt(8.0) * sigma));
  return std::pow(same, static_cast<double>(axis.repeats));
}

/// How long the axis has been stuck by the repeats in hand [s]; 0: it is not.
double SampleWatch::StuckNow(std::size_t i) const {
  const Axis& axis = axes_[i];
  const double seconds = period_ * static_cast<double>(axis.repeats);
  const bool long_enough = seconds >= (axis.rests ? kStuckAtRest : kStuckMoving);
  const bool alone = 2 * (Busiest(i) - axis.others) > axis.repeats;
  const bool stuck = axis.repeats >= kRepeats && long_enough && alone;
  return stuck && ChanceOfRepeats(i) < kChance ? seconds : 0;
}

void SampleWatch::WatchAxes(const ImuSample& sample, const AlongHole& along, bool rests) {
  for (std::size_t i = 0; i < kAxes; ++i) {
    if (i == 2 && !sample.has_gz) continue;
    Axis& axis = axes_[i];
    const double value = ValueOf(sample, i);
    axis.truncation.Push(value, axis.step);
    const double step = std::abs(value - axis.value);
    if (samples_ > 0 && step <= kSameValue * std::abs(axis.value)) {
      if (axis.repeats == 0) {
        axis.others = Busiest(i);
        axis.rests = true;
      }
      ++axis.repeats;
      axis.rests = axis.rests && rests;
      continue;
    }
    if (const double stuck = StuckNow(i); stuck > 0) {
      axis.stuck += stuck;
      if (!axis.md && along.known) axis.md = along.md;
    }
    if (samples_ > 0 && (axis.step == 0 || step < axis.step)) axis.step = step;
    axis.repeats = 0;
    axis.value = value;
    ++axis.changes;
  }
}

void SampleWatch::WatchBend(const ImuSample& sample, const AlongHole& along, double seconds) {
  stretch_.products += seconds * sample.w_IT_T.head<2>() * sample.f_T.head<2>().transpose();
  stretch_.seconds += seconds;
  if (stretch_.seconds < kStretch) return;
  const Stretch stretch = stretch_;
  stretch_ = StretchFrom(sample, along);
  if (!stretch.steady || !stretch_.steady) return;
  const double found = (sample.f_T.z() - stretch.begin_f_z) / kForceLeft;
  const std::array<double, kPairings> predicted = PredictionsOf(stretch.products / kForceLeft);
  ++stretches_;
  // The gyros have the Earth's rate too, which adds up to w_E t g to the products: 0.021 m/s^2 in
  // 30 s. It is alike in all stretches of a hole that goes on eastwards, so that it is no variance
  // but a bound, within which nothing is left. Squares are bounded, so that a single bad sample at
  // an end does not decide.
  const double earth = kEarthRate * stretch.seconds * kGravity / kForceLeft;
  std::array<double, kPairings> squares;
  for (std::size_t i = 0; i < kPairings; ++i) {
    const double left = std::max(std::abs(found - predicted[i]) - earth, 0.0);
    squares[i] = std::min(left * left, 100.0);
    squares_[i] += squares[i];
  }
  WatchSpells(stretch.md, stretch.seconds, squares);
  if (std::abs(found) < 100 && std::abs(predicted[0]) < 1e4) {
    predicted2_ += predicted[0] * predicted[0];
    predicted_found_ += predicted[0] * found;
  }
}

/// Page's sums of ln odds, that begin anew where they are negative.
void SampleWatch::WatchSpells(std::optional<double> md, double seconds,
                              const std::array<double, kPairings>& squares) {
  for (std::size_t i = 1; i < kPairings; ++i) {
    Spell& spell = spells_[i];
    if (!(spell.better > 0)) spell = {.md = md};
    spell.better += squares[0] - squares[i];
    spell.right += squares[0];
    spell.left += squares[i];
    spell.seconds += seconds;
    if (spell.better > longest_[i].better) longest_[i] = spell;
  }
}

void SampleWatch::WatchRest(const ImuSample& sample, const AlongHole& along, bool rests,
                            double seconds) {
  const SampleStamp& stamp = sample.stamp;
  if (!rests) {
    rest_ = {};
    resting_ = false;
    return;
  }
  if (!resting_ && stops_.size() < kRestsMost) {
    stops_.push_back({stamp.tool_time, stamp.tool_time, along.md});
    resting_ = true;
  }
  if (resting_) stops_.back().end = stamp.tool_time + Duration{stamp.period_ns};
  const Eigen::Vector2d w = sample.w_IT_T.head<2>();
  rest_.turn += seconds * w;
  rest_.squares += seconds * w.squaredNorm();
  rest_.force_T += seconds * sample.f_T;
  rest_.seconds += seconds;
  ++rest_.samples;
  if (rest_.seconds < kRestBlock) return;
  // A tool that swings turns by something within any stretch: its rates scatter by far more.
  const double mean = rest_.turn.norm() / rest_.seconds;
  const double scatter = std::sqrt(std::max(rest_.squares / rest_.seconds - mean * mean, 0.0));
  const double rate = std::max(mean - 5 * scatter / std::sqrt(rest_.samples), 0.0);
  least_at_rest_ = std::min(least_at_rest_.value_or(rate), rate);
  const double force = rest_.force_T.norm() / rest_.seconds;
  rest_force_ += force;
  ++rests_;
  if (!lean_ && force > 0) lean_ = rest_.force_T.z() / rest_.seconds / force;
  rest_ = {};
}

void SampleWatch::AddStuck(std::int32_t run, std::vector<Check>& checks) const {
  for (const bool gyros : {true, false}) {
    std::size_t worst = gyros ? 0 : 3;
    double longest = 0;
    for (std::size_t i = gyros ? 0 : 3; i < (gyros ? 3u : 6u); ++i) {
      const double stuck = axes_[i].stuck + StuckNow(i);
      if (stuck <= longest) continue;
      longest = stuck;
      worst = i;
    }
    const std::string sensor = gyros ? "gyro" : "accel";
    if (longest > 0) {
      const bool dead = longest > kDead * seconds_;
      checks.push_back(Failed(sensor + (dead ? "_dead" : "_stuck"), run, longest, "s",
                              fmt::format("{} repeats one value", kAxisNames[worst])));
      checks.back().limit = 0;
      checks.back().md = axes_[worst].md;
    } else {
      checks.push_back(CountOf(sensor + "_stuck", run, 0, "no axis repeats one value"));
      checks.back().unit = "s";
    }
  }
}

void SampleWatch::AddTruncation(std::int32_t run, std::vector<Check>& checks) const {
  for (const std::size_t first : {0u, 3u}) {
    const std::string code = first == 0 ? "gyro_truncated" : "accel_truncated";
    const auto found = TruncationWatch::Of(axes_[first].truncation, axes_[first + 1].truncation);
    if (!(found.sigma > 0)) {
      checks.push_back(NotDone(code, run, "the axes do not pass zero by whole steps"));
      continue;
    }
    // Nearer to ln 2 than to 0, and five sigmas from 0.
    const double limit = std::max(std::log(2.0) / 2, 5 * found.sigma);
    Check check = CompareWith(code, run, {std::max(found.ln_ratio, 0.0), found.sigma}, limit, 1,
                              "1", "ln of how often they read zero over how often they should");
    // Half a step that the noise of all samples together hides does no harm.
    const double noise = first == 0 ? job_.noise.angle_random_walk : job_.errors.accel_noise;
    const bool hidden = found.step / 2 < noise / std::sqrt(seconds_);
    if (check.verdict == Verdict::kWarn) check.verdict = Verdict::kPass;
    if (check.verdict == Verdict::kFail && hidden) check.verdict = Verdict::kWarn;
    checks.push_back(check);
  }
}

void SampleWatch::AddPairing(std::int32_t run, std::vector<Check>& checks) const {
  const auto best = std::min_element(squares_.begin() + 1, squares_.end());
  const double right = squares_.front();
  const bool wrong = *best + kBetter < right && *best < kLeaves * right;
  if (wrong) {
    const auto i = static_cast<std::size_t>(best - squares_.begin());
    checks.push_back(Failed("axes", run, right, "1", kPairingNames[i]));
    return;
  }
  const auto spell =
      std::max_element(longest_.begin() + 1, longest_.end(),
                       [](const Spell& a, const Spell& b) { return a.better < b.better; });
  // P(some sum of ln odds passes h) < n e^-h of n begins (Wald), of all pairings together.
  const double chances = 2 * std::log(std::max(stretches_, 1.0) * (kPairings - 1));
  if (spell->better > kBetter + chances && spell->left < kLeaves * spell->right) {
    const auto i = static_cast<std::size_t>(spell - longest_.begin());
    checks.push_back(Failed("axes_change", run, spell->right, "1",
                            fmt::format("{} for {:.0f} s", kPairingNames[i], spell->seconds)));
    checks.back().md = spell->md;
    return;
  }
  const bool bends = right + kBetter < *best;
  if (!bends) {
    checks.push_back(NotDone("axes", run, "the hole bends too little to tell the axes apart"));
    return;
  }
  Check check = CountOf("axes", run, 0, "gyros turn as the accelerometers tilt");
  checks.push_back(check);
}

/// False where the force at rest is none that gravity makes.
bool SampleWatch::AddForce(std::int32_t run, std::vector<Check>& checks) const {
  if (!(rests_ > 0)) {
    checks.push_back(NotDone("accel_unit", run, "nowhere its depth rests"));
    return true;
  }
  const double ratio = rest_force_ / rests_ / kGravity;
  if (std::abs(ratio - 1) > kUnitWrong) {
    checks.push_back(Failed(
        "accel_unit", run, ratio, "1",
        fmt::format("the force at rest over gravity is {:.3g}{}", ratio, AccelUnitOf(ratio))));
    return false;
  }
  checks.push_back(CompareWith("accel_unit", run, {ratio - 1, 0}, kUnitWrong, 1, "1",
                               "the force at rest over gravity, less one"));
  return true;
}

void SampleWatch::AddUnit(std::int32_t run, std::vector<Check>& checks) const {
  const double allowed =
      5 * std::hypot(job_.errors.gyro_bias_sigma, job_.noise.bias_instability,
                     job_.noise.angle_random_walk / std::sqrt(kRestBlock)) +
      5 * std::hypot(job_.errors.mass_unbalance_sigma, job_.errors.quadrature_sigma) * kGravity;
  if (least_at_rest_ && *least_at_rest_ > 2 * kEarthRate + allowed) {
    checks.push_back(Failed("gyro_unit", run, *least_at_rest_ / kEarthRate, "1",
                            "the rate at rest over the Earth's: at most 1"));
    checks.back().limit = 1;
    return;
  }
  const double sigma = predicted2_ > 0 ? 1 / std::sqrt(predicted2_) : HUGE_VAL;
  const double slope = predicted2_ > 0 ? predicted_found_ / predicted2_ : 0;
  if (sigma > kUnitTells && squares_.front() > 100 && squares_.front() > 16 * stretches_) {
    checks.push_back(Failed("gyro_unit", run, slope, "1",
                            "the gyros do not turn where the accelerometers tilt"));
    return;
  }
  // Of few stretches, or of gyros that read far too little, the slope has no meaning.
  if (sigma > kUnitTells) {
    checks.push_back(
        NotDone("gyro_unit", run, "the hole bends too little to tell the gyros' unit"));
    return;
  }
  checks.push_back(CompareWith("gyro_unit", run, {slope - 1, sigma}, kUnitWrong + 6 * sigma, 1, "1",
                               "tilt by the accelerometers over turn by the gyros, less one"));
}

void SampleWatch::AddMotion(std::int32_t run, const std::vector<NorthFix>& fixes,
                            std::vector<Check>& checks) const {
  double longest = 0;
  std::optional<double> where;
  const double least = job_.alignment.min_still + 2 * kSettles;
  for (const Stop& stop : stops_) {
    const double rest = (stop.end - stop.begin).seconds();
    if (rest < least) continue;
    double still = 0;
    for (const NorthFix& fix : fixes) {
      if (fix.external || !fix.from_samples) continue;
      const ToolTime begin = std::max(fix.begin, stop.begin), end = std::min(fix.end, stop.end);
      if (begin < end) still += (end - begin).seconds();
    }
    const double moving = rest - 2 * kSettles - still;
    if (moving < rest / 2 || moving <= longest) continue;
    longest = moving;
    where = stop.md;
  }
  Check check =
      CompareWith("rest_motion", run, {longest, 0}, 0, 1, "s", "a tool whose depth rests is still");
  if (check.verdict == Verdict::kFail) check.verdict = Verdict::kWarn;
  check.md = where;
  checks.push_back(check);
}

std::vector<Check> SampleWatch::Checks(std::int32_t run, const std::vector<NorthFix>& fixes) const {
  std::vector<Check> checks;
  if (samples_ == 0) return checks;
  AddStuck(run, checks);
  AddTruncation(run, checks);
  const bool forces = AddForce(run, checks);
  if (forces) {
    AddPairing(run, checks);
  } else {
    checks.push_back(NotDone("axes", run, "first the accelerometers' unit must be right"));
  }
  const bool paired = checks.back().verdict != Verdict::kFail;
  if (forces && paired) {
    AddUnit(run, checks);
  } else {
    checks.push_back(NotDone("gyro_unit", run, "first axes and accelerometers must be right"));
  }
  AddMotion(run, fixes, checks);
  return checks;
}

}  // namespace wellgyro
