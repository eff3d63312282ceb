#include "wellgyro/attitude/tracker.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "wellgyro/attitude/tracker_angles_internal.h"
#include "wellgyro/base/units.h"

namespace wellgyro {
namespace {

using tracker::FirstMoment;
using tracker::InverseSinc;
using tracker::NearAngle;
using tracker::Phase;
using tracker::Turn;

bool IsFinite(const ImuSample& s) {
  const double w = s.w_IT_T.x() + s.w_IT_T.y() + (s.has_gz ? s.w_IT_T.z() : 0);
  return std::isfinite(w + s.f_T.x() + s.f_T.y() + s.f_T.z());
}

// False: the sample is late. Otherwise says whether the window breaks before it, and the gap.
bool Follows(const SampleStamp& before, const SampleStamp& next, bool& breaks, std::int64_t& gap_ns,
             std::int64_t& lost) {
  if (next.session != before.session || next.tool != before.tool) {
    breaks = true;
    gap_ns = std::max<std::int64_t>(0, (next.utc - before.utc).ns - before.period_ns);
    lost = 0;
    return true;
  }
  const std::int64_t apart = (next.tool_time - before.tool_time).ns - before.period_ns;
  const std::int64_t tolerance = before.period_ns / 2;
  if (apart < -tolerance || next.seq <= before.seq) return false;
  const bool gap = apart > tolerance || next.seq != before.seq + 1;
  gap_ns = apart > tolerance ? apart : 0;
  lost = next.seq - before.seq - 1;
  breaks = gap || next.period_ns != before.period_ns;
  return true;
}

}  // namespace

void HighSideTracker::SetAzimuth(std::optional<double> azimuth) {
  const bool was_set = cos_azimuth_ != 0 || sin_azimuth_ != 0;
  const double earth_before = earth_r_;
  cos_azimuth_ = azimuth ? std::cos(*azimuth) : 0;
  sin_azimuth_ = azimuth ? std::sin(*azimuth) : 0;
  TakeEarth();
  // While the azimuth was unknown the observer took the Earth's rate for a bias of the gyros.
  if (was_set != azimuth.has_value() && memory_.seconds > 0) rate_bias_ += earth_r_ - earth_before;
}

double HighSideTracker::toolface() const {
  const Seen& s = last();
  return WrapPi(std::atan2(s.uy, s.ux) + 0.5 * c1_ + c2_ / 6);
}

// Two equal time constants, so matched to a continuous observer that means over any step agree.
HighSideTracker::Gains HighSideTracker::Steady(double dt) const {
  const double part = dt / options_.level_seconds, left = std::exp(-part);
  return {1 - left * (1 - part), left * part * part};
}

void HighSideTracker::Memory::Add(double dt, double trust) {
  second += dt * (dt * seconds - 2 * first);
  first -= dt * seconds;
  seconds += trust * dt;
  span += dt;
}

void HighSideTracker::Memory::Shorten(double left) {
  span *= left;
  seconds *= left;
  first *= left * left;
  second *= left * left * left;
}

// A sample's, by its trust: those of the line fitted to all that was seen and this one, until they
// fall to `steady`.
HighSideTracker::Gains HighSideTracker::Weighed(Gains steady, double dt, double trust,
                                                const Memory& memory) const {
  steady = {trust * steady.level, trust * steady.rate};
  if (!(trust > 0) || memory.seconds >= 2 * options_.level_seconds) return steady;
  const double weight = trust * dt, mean = memory.first / memory.seconds;
  const double spread = memory.second - mean * memory.first;
  // One that counts for more than all before it makes no line with them.
  if (!(spread > 0) || memory.seconds < 1.5 * weight) return {weight / memory.seconds, 0};
  const double rate = -weight * mean / spread;
  return {std::min(1.0, std::max(steady.level, weight / memory.seconds - mean * rate)),
          std::max(steady.rate, rate * dt)};
}

inline void HighSideTracker::TakeSite(const Site& site, std::int32_t period_ns) {
  if (site.latitude != latitude_ || !started_) {
    latitude_ = site.latitude;
    earth_cos_ = kEarthRate * std::cos(latitude_);
    earth_sin_ = kEarthRate * std::sin(latitude_);
    const double radius = 0.5 * (site.radius_north + site.radius_east);
    inverse_radius_ = radius > 0 ? 1 / radius : 0;
    TakeEarth();
  }
  if (site.gravity != gravity_) {
    if (!(site.gravity > 0)) {
      throw std::invalid_argument("Site.gravity must be positive, is " +
                                  std::to_string(site.gravity));
    }
    gravity_ = site.gravity;
    inverse_gravity_ = 1 / gravity_;
  }
  if (period_ns != period_ns_) {
    period_ns_ = period_ns;
    dt_ = 1e-9 * period_ns;
    inverse_dt_ = 1 / dt_;
    steady_ = Steady(dt_);
    sin_min_ = std::max(std::sin(options_.inclination_min),
                        options_.accel_noise / (units::kStandardGravity * std::sqrt(dt_) *
                                                options_.sigma_toolface_max));
  }
}

// Where the observer starts; its gain of one then takes the first sample's value in full.
void HighSideTracker::TakeFirst(const ImuSample& sample) {
  const Eigen::Vector3d& f = sample.f_T;
  inclination_ = std::atan2(std::hypot(f.x(), f.y()), -f.z());
  TakeReference();
  seen_[newest_].ux = 1;
}

void HighSideTracker::TakeReference() {
  reference_ = inclination_;
  reference_sin_ = std::sin(reference_);
  reference_cos_ = std::cos(reference_);
  const double bounded = std::max(reference_sin_, sin_min_);
  reference_cot_ = reference_cos_ / bounded;
  reference_reach_ = std::min(0.015, 0.05 * bounded);
  TakeEarth();
}

// The Earth's rate on high side and right, close enough at the reference.
void HighSideTracker::TakeEarth() {
  earth_h_ = earth_cos_ * cos_azimuth_ * reference_cos_ + earth_sin_ * reference_sin_;
  earth_r_ = -earth_cos_ * sin_azimuth_;
  carried_ = reference_sin_ * inverse_radius_;
}

// Rolling at p about an axis rho = x + iy away adds (i p' - p^2) rho across and 2 p Re(W rho*)
// along. p from the raw phase, so that no loop closes through the correction.
void HighSideTracker::TakeLeverArm(const ImuSample& sample, double dt, double& fx, double& fy,
                                   double& fz) {
  const double across = std::hypot(sample.f_T.x(), sample.f_T.y());
  if (across == 0) return;
  const double x = sample.f_T.x() / across, y = -sample.f_T.y() / across;
  const bool follows = waiting_;
  double p = follows ? Phase(y * raw_x_ - x * raw_y_, x * raw_x_ + y * raw_y_) / dt : roll_rate_1_;
  if (sample.has_gz) p = sample.w_IT_T.z();
  raw_x_ = x;
  raw_y_ = y;
  const double gain = dt / (options_.roll_rate_seconds + dt);
  roll_rate_1_ += gain * (p - roll_rate_1_);
  roll_rate_2_ += gain * (roll_rate_1_ - roll_rate_2_);
  const double rate = roll_rate_1_;
  const double growth = (roll_rate_1_ - roll_rate_2_) / options_.roll_rate_seconds;
  const double rx = options_.p_accel_T.x(), ry = options_.p_accel_T.y();
  fx -= -growth * ry - rate * rate * rx;
  fy -= growth * rx - rate * rate * ry;
  fz -= 2 * rate * (sample.w_IT_T.x() * rx + sample.w_IT_T.y() * ry);
}

inline void HighSideTracker::Prepare(const ImuSample& sample, const AlongHole& along, Seen& s) {
  s.stamp = sample.stamp;
  s.along = along;
  s.has_gz = sample.has_gz;
  s.quality = Quality::kGood;
  if (sample.stamp.gyro_saturated | sample.stamp.accel_saturated) s.quality |= Quality::kSaturated;
  if (sample.stamp.utc_unsynced) s.quality |= Quality::kClock;
  if (!along.known) s.quality |= Quality::kDepth;

  const double dt = dt_;
  double v = 0;
  const double wx = sample.w_IT_T.x(), wy = sample.w_IT_T.y();
  double fx = sample.f_T.x(), fy = sample.f_T.y(), fz = sample.f_T.z();
  s.e_r = earth_r_;
  if (along.known) {
    v = along.speed;
    fx -= v * wy;
    fy += v * wx;
    fz -= along.acceleration;
    s.e_r -= v * carried_;
  }
  if (off_axis_) {
    TakeLeverArm(sample, dt, fx, fy, fz);
  }

  s.dt = dt;
  s.spin = sample.has_gz ? sample.w_IT_T.z() * dt : 0;
  s.fz = fz;
  // v times the Earth's rate adds -v e_r + i v e_h to the force seen from the high side.
  const double across = std::sqrt(fx * fx + fy * fy);
  if (across > 0) {
    const double inverse = 1 / across, late = v * earth_h_ * inverse;
    s.ux = (fx - fy * late) * inverse;
    s.uy = (-fy - fx * late) * inverse;
  } else {
    s.ux = seen_[newest_].ux;
    s.uy = seen_[newest_].uy;
  }
  if (sample.has_gz) {
    // T' = w_z - A' cos I, but for the Earth's rate, which is slow.
    const double carried = (wx * s.ux - wy * s.uy) * dt * reference_cot_;
    roll_.Take(s.spin + carried, dt, across > 0 && !sample.stamp.accel_saturated, s.ux, s.uy);
  } else {
    roll_.Forget();
  }
  s.across = std::max(0.0, across - v * s.e_r);
  s.vh = (wx * s.ux - wy * s.uy) * dt;
  s.vr = (wx * s.uy + wy * s.ux) * dt;
  const bool saturated = Has(s.quality, Quality::kSaturated);
  s.unseen = saturated ? options_.unseen.Beyond(along, std::hypot(s.vh, s.vr), dt) : 0;
}

// Inclinations are counted from a reference near by whose sine and cosine are exact, so that the
// accelerometers' value does not wait for the observer's.
inline HighSideTracker::Mean HighSideTracker::Level(const Seen& s, double rise, double curve,
                                                    double across) {
  const double to_mean = 0.5 * rise - curve * (1. / 12);
  const double from_reference = inclination_ - reference_ + to_mean;
  double sine = reference_sin_, cosine = reference_cos_;
  Turn(from_reference, sine, cosine);
  Mean mean;
  mean.vertical = sine < sin_min_;
  mean.csc = 1 / std::max(sine, sin_min_);
  mean.cot = cosine * mean.csc;

  const double a = across * reference_cos_ + s.fz * reference_sin_;
  const double b = across * reference_sin_ - s.fz * reference_cos_;
  const double accel = NearAngle(a, b);
  mean.accel = reference_ + accel;

  const double full = 2 * options_.level_seconds;
  const bool young = memory_.seconds < full;
  const double said = s.along.known ? s.along.acceleration / Reach(memory_, s.dt) : 0;
  mean.trust = s.stamp.accel_saturated ? 0 : 1 / (Quiet(s.along) + said * said);
  Gains gains{mean.trust * steady_.level, mean.trust * steady_.rate};
  if (young) {
    memory_.Add(s.dt, mean.trust);
    memory_.span = std::min(memory_.span, full);
    gains = Weighed(steady_, s.dt, mean.trust, memory_);
  }
  const double off = accel - from_reference;
  const double raised = inclination_ + rise + gains.level * off;
  rate_bias_ += gains.rate * off * inverse_dt_;
  const double bounded = std::clamp(raised, 0.0, kPi);
  rise_ = rise;
  inclination_ = bounded;
  if (std::abs(inclination_ - reference_) > reference_reach_) TakeReference();
  return mean;
}

// Change of toolface since the end of the sample before, whose last angle was extrapolated from
// its own window.
inline double HighSideTracker::Roll(const Seen& s, const Slopes& slopes) {
  if (has_before_) {
    return delta_in_ + 0.5 * (slopes.c1 - c1_) + (slopes.c2 - c2_) / 6;
  }
  if (!ready_) return slopes.c1;
  const double begin = std::atan2(s.uy, s.ux) - 0.5 * slopes.c1 + slopes.c2 / 6;
  // No gyro took part in that.
  unseen_roll_ += WrapPi(begin - end_toolface_);
  return slopes.c1;
}

inline void HighSideTracker::AddSample(const Seen& s, bool vertical) {
  const bool gap = (s.gap_ns | s.lost) != 0;
  // A block is short against the observer's memory and against a turn.
  if (block_[kSeconds] + s.dt > 0.0125 * memory_.seconds ||
      std::abs(block_[kRoll] + part_[kRoll]) > 0.2 || gap || s.has_gz != has_gz_) {
    CloseBlock(s.along);
    if (gap) observed_.noise.Break();
    has_gz_ = s.has_gz;
  }
  for (int i = 0; i < kSums; ++i) block_[i] += part_[i];
  block_memory_ = memory_;
  if (empty_) {
    seq_begin_ = s.stamp.seq;
    along_begin_ = s.along;
    empty_ = false;
  }
  ns_ += s.stamp.period_ns;
  quality_ |= sample_quality_;
  if (s.stamp.accel_saturated) level_ = false;
  unseen_.Pass(s.dt, options_.unseen.seconds);
  if (gap) {
    ns_ += s.gap_ns;
    gap_ns_ += s.gap_ns;
    lost_ += s.lost;
    quality_ |= Quality::kGap;
  }
  sample_vertical_ = vertical;
  all_vertical_ = all_vertical_ && vertical;
  cut_ = 0;
  ready_ = true;
}

// Slopes across the waiting sample, central where it has both neighbours.
template <TrackerOptions::Order kOrder>
inline HighSideTracker::Slopes HighSideTracker::Across(const Seen& s, const Seen* next) {
  Slopes slopes;
  if (next == nullptr) {
    if (!has_before_) return slopes;
    slopes.c1 = delta_in_;
    if constexpr (kOrder == TrackerOptions::kThird) {
      slopes.a1h = s.vh - before_vh_;
      slopes.a1r = s.vr - before_vr_;
    }
    return slopes;
  }
  const double delta = Phase(next->uy * s.ux - next->ux * s.uy, next->ux * s.ux + next->uy * s.uy);
  delta_out_ = delta;
  slopes.c1 = has_before_ ? 0.5 * (delta + delta_in_) : delta;
  slopes.c2 = has_before_ ? 0.5 * (delta - delta_in_) : 0;
  if constexpr (kOrder == TrackerOptions::kThird) {
    slopes.a1h = has_before_ ? 0.5 * (next->vh - before_vh_) : next->vh - s.vh;
    slopes.a1r = has_before_ ? 0.5 * (next->vr - before_vr_) : next->vr - s.vr;
  }
  return slopes;
}

template <TrackerOptions::Order kOrder>
inline void HighSideTracker::SumUp(const Seen& s, const Seen* next) {
  constexpr bool kThird = kOrder == TrackerOptions::kThird;
  const Slopes slopes = Across<kOrder>(s, next);
  if (s.unseen_before > 0) AddUnseen(s.along, s.unseen_before, s.var_unseen_before);
  if (s.unseen > 0) AddUnseen(s.along, s.unseen, unseen_.VarOf(s.unseen));
  // By the turn since the sample before, where second order will do: the square of a difference
  // from c1 is of third, and the rest does not wait for the next sample's phase.
  const double turned = kThird || !has_before_ ? slopes.c1 : delta_in_;
  const double inverse = InverseSinc(turned), free_rise = (rate_bias_ - s.e_r) * s.dt;
  double vh = s.vh * inverse, vr = s.vr * inverse, curve_h = 0, curve_r = 0;
  if constexpr (kThird) {
    const double moment = FirstMoment(slopes.c1);
    curve_h = slopes.a1h * inverse;
    curve_r = slopes.a1r * inverse;
    // The phase of the mean force leads while sin I grows, by cot I (rise) times the moment.
    const double lead = reference_cot_ * (vr + free_rise) * moment;
    const double h = vh - curve_r * moment, r = vr + curve_h * moment;
    vh = h + lead * r;
    vr = r - lead * h;
  }
  const double rise = vr + free_rise;
  const Mean mean = Level(s, rise, curve_r, s.across * inverse);
  double turn = vh * mean.csc;
  if constexpr (kThird) {
    const double csc = mean.csc, cot = mean.cot;
    turn += csc * (vh * (cot * cot + csc * csc) * rise * rise * (1. / 24) -
                   cot * rise * curve_h * (1. / 12));
    before_vh_ = s.vh;
    before_vr_ = s.vr;
  }
  const double roll = Roll(s, slopes);
  c1_ = slopes.c1;
  c2_ = slopes.c2;
  part_ = {turn,   mean.accel * s.dt, vr,  vh, roll, mean.cot * s.dt, s.ux * s.dt, s.uy * s.dt,
           s.spin, mean.trust * s.dt, s.dt};
  sample_quality_ = s.quality;
  if (mean.vertical) {
    sample_quality_ |= Quality::kVertical;
  } else if (std::abs(slopes.c1) + std::abs(slopes.c2) > options_.roll_limit) {
    sample_quality_ |= Quality::kAliased;
  }
  AddSample(s, mean.vertical);
  delta_in_ = delta_out_;
  has_before_ = true;
}

void HighSideTracker::Integrate(const Seen& s, const Seen* next) {
  if (options_.order == TrackerOptions::kThird) {
    SumUp<TrackerOptions::kThird>(s, next);
  } else {
    SumUp<TrackerOptions::kSecond>(s, next);
  }
}

// Private members are inline: exported and position-independent, they could not be otherwise.
bool HighSideTracker::Push(const ImuSample& sample, const AlongHole& along, const Site& site) {
  if (sample.stamp.period_ns <= 0 || !IsFinite(sample)) return false;
  const Seen& now = newest_ == 0 ? seen_[0] : seen_[1];
  Seen& next = newest_ == 0 ? seen_[1] : seen_[0];
  bool breaks = false;
  std::int64_t gap_ns = 0, lost = 0;
  if (started_ && !Follows(now.stamp, sample.stamp, breaks, gap_ns, lost)) return false;
  if (breaks) {
    Flush();
    roll_.Forget();
  }

  TakeSite(site, sample.stamp.period_ns);
  if (!started_) TakeFirst(sample);
  Prepare(sample, along, next);
  next.gap_ns = gap_ns;
  next.lost = lost;
  next.unseen_before = next.var_unseen_before = 0;
  gap_cut_ns_ = 0;
  if (gap_ns > 0) {
    const double seconds = 1e-9 * static_cast<double>(gap_ns);
    next.unseen_before =
        options_.unseen.Between(now.along, next.along, seconds, seconds + 0.5 * (now.dt + next.dt));
    next.var_unseen_before = unseen_.VarOf(next.unseen_before);
  }

  if (waiting_) Integrate(now, &next);
  newest_ = 1 - newest_;
  waiting_ = true;
  started_ = true;
  return true;
}

void HighSideTracker::Flush() {
  if (!waiting_) return;
  Integrate(seen_[newest_], nullptr);
  waiting_ = false;
  has_before_ = false;
  end_toolface_ = toolface();
}

}  // namespace wellgyro
