#include "wellgyro/attitude/tracker.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "wellgyro/base/units.h"

namespace wellgyro {
namespace {

// What is summed over an interval; V = W e^{iT} over the period, c = 1 / sin I.
enum Sum {
  kTurn,    // V_h c
  kTurnR,   // V_r c
  kLift,    // V_r
  kLiftH,   // V_h
  kRoll,    // of the toolface
  kCot,     // cot I dt
  kAccel,   // accelerometers' inclination dt
  kWhite,   // c^2 dt
  kJitter,  // (V_r c^2)^2 / dt
  kBiasC,   // cos T c dt
  kBiasS,   // sin T c dt
  kUnitC,   // cos T dt
  kUnitS,   // sin T dt
  kMass,    // g sin I c dt
  kQuad,    // g sin I dt
  kScaleX,  // turn and lift by either gyro alone ...
  kScaleY,
  kScaleXLift,
  kScaleYLift,
  kCrossX,  // ... and by the rate about z, seen in either
  kCrossY,
  kCrossXLift,
  kCrossYLift,
  kSkew,
  kSkewLift,
  kAccelS,  // V_r c^2 sin T / g
  kAccelC,
  kAccelSLift,
  kAccelCLift,
  kThrough  // from here: V_h c cot I times the error of inclination, by state
};

// Errors of inclination that are followed through its observer.
enum State {
  kStateBiasX,
  kStateBiasY,
  kStateQuad,
  kStateScaleX,
  kStateScaleY,
  kStateCrossX,
  kStateCrossY,
  kStateOffset,
  kStateSkew,
  kStateAccelX,
  kStateAccelY,
  kStateAccelZ
};

// Their sources.
constexpr Knot::Source kSourceOfState[] = {
    Knot::kGyroBiasX,  Knot::kGyroBiasY,     Knot::kQuadrature,    Knot::kGyroScaleX,
    Knot::kGyroScaleY, Knot::kMisalignmentX, Knot::kMisalignmentY, Knot::kToolfaceOffset,
    Knot::kTimeSkew,   Knot::kAccelBiasX,    Knot::kAccelBiasY,    Knot::kAccelBiasZ};

// atan2(s, c) where s^2 + c^2 = 1; the series is good to 1e-14 where it is used.
double Phase(double s, double c) {
  if (c <= 0 || std::abs(s) > 0.15) return std::atan2(s, c);
  const double q = s * s;
  return s * (1 + q * (1. / 6 +
                       q * (3. / 40 +
                            q * (5. / 112 + q * (35. / 1152 + q * (63. / 2816 + q * 0.01735))))));
}

// (x/2) / sin(x/2): what a mean over a period that turns by x falls short of. 1e-7 at pi/2.
double InverseSinc(double x) {
  const double q = x * x;
  return 1 + q * (1. / 24 +
                  q * (7. / 5760 + q * (31. / 967680 + q * (127. / 154828800 + q * 2.08386e-8))));
}

// Mean of u sin(x u) over [-1/2, 1/2] by the mean of cos(x u): (1 - x/2 cot(x/2)) / x.
double FirstMoment(double x) {
  const double q = x * x;
  return x * (1. / 12 + q * (1. / 720 + q * (1. / 30240 + q * (1. / 1209600))));
}

// (s, c) turned by d.
void Turn(double d, double& s, double& c) {
  double sd, cd;
  if (std::abs(d) < 0.02) {
    const double q = d * d;
    sd = d * (1 - q * (1. / 6 - q * (1. / 120)));
    cd = 1 - q * (0.5 - q * (1. / 24));
  } else {
    sd = std::sin(d);
    cd = std::cos(d);
  }
  const double turned = s * cd + c * sd;
  c = c * cd - s * sd;
  s = turned;
}

void CheckPositive(const char* name, double value) {
  if (value > 0 && std::isfinite(value)) return;
  throw std::invalid_argument(std::string("TrackerOptions.") + name + " must be positive, is " +
                              std::to_string(value));
}

void CheckNotNegative(const char* name, double value) {
  if (value >= 0 && std::isfinite(value)) return;
  throw std::invalid_argument(std::string("TrackerOptions.") + name + " must not be negative, is " +
                              std::to_string(value));
}

}  // namespace

HighSideTracker::HighSideTracker(const TrackerOptions& options) : options_(options) {
  static_assert(kThrough + kStates == kSums && kStateAccelZ + 1 == kStates);
  CheckNotNegative("accel_noise", options.accel_noise);
  CheckNotNegative("angle_random_walk", options.angle_random_walk);
  CheckPositive("level_seconds", options.level_seconds);
  CheckPositive("inclination_min", options.inclination_min);
  CheckPositive("sigma_toolface_max", options.sigma_toolface_max);
  CheckPositive("roll_limit", options.roll_limit);
  CheckPositive("roll_rate_seconds", options.roll_rate_seconds);
  if (!options.p_accel_T.allFinite()) {
    throw std::invalid_argument("TrackerOptions.p_accel_T is not finite");
  }
}

void HighSideTracker::SetAzimuth(std::optional<double> azimuth) {
  cos_azimuth_ = azimuth ? std::cos(*azimuth) : 0;
  sin_azimuth_ = azimuth ? std::sin(*azimuth) : 0;
}

double HighSideTracker::toolface() const {
  return WrapPi(std::atan2(end_y_, end_x_) + 0.5 * slopes_.c1 + slopes_.c2 / 6);
}

bool HighSideTracker::Push(const ImuSample& sample, const AlongHole& along, const Site& site) {
  if (sample.stamp.period_ns <= 0) return false;
  bool breaks = false;
  std::int64_t gap_ns = 0, lost = 0;
  if (started_ && !Follows(sample.stamp, breaks, gap_ns, lost)) return false;
  if (breaks) Flush();

  TakeSite(site, 1e-9 * sample.stamp.period_ns);
  if (!started_) TakeFirst(sample);
  const Seen& now = seen_[newest_];
  Seen& next = seen_[1 - newest_];
  Prepare(sample, along, next);
  next.gap_ns = gap_ns;
  next.lost = lost;

  if (waiting_) {
    const double delta =
        Phase(next.uy * now.ux - next.ux * now.uy, next.ux * now.ux + next.uy * now.uy);
    Slopes slopes{delta, 0, next.vh - now.vh, next.vr - now.vr};
    if (has_before_) {
      slopes = {0.5 * (delta + delta_in_), 0.5 * (delta - delta_in_), 0.5 * (next.vh - before_vh_),
                0.5 * (next.vr - before_vr_)};
    }
    Integrate(now, slopes);
    before_vh_ = now.vh;
    before_vr_ = now.vr;
    delta_in_ = delta;
    has_before_ = true;
  }
  newest_ = 1 - newest_;
  waiting_ = true;
  started_ = true;
  return true;
}

void HighSideTracker::Flush() {
  if (!waiting_) return;
  const Seen& now = seen_[newest_];
  Slopes slopes;
  if (has_before_) slopes = {delta_in_, 0, now.vh - before_vh_, now.vr - before_vr_};
  Integrate(now, slopes);
  waiting_ = false;
  has_before_ = false;
}

// False: the sample is late. Otherwise says whether the window breaks before it, and the gap.
bool HighSideTracker::Follows(const SampleStamp& next, bool& breaks, std::int64_t& gap_ns,
                              std::int64_t& lost) const {
  const SampleStamp& before = seen_[newest_].stamp;
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

void HighSideTracker::TakeSite(const Site& site, double dt) {
  if (site.latitude != latitude_ || gravity_ == 0) {
    latitude_ = site.latitude;
    earth_cos_ = kEarthRate * std::cos(latitude_);
    earth_sin_ = kEarthRate * std::sin(latitude_);
    const double radius = 0.5 * (site.radius_north + site.radius_east);
    inverse_radius_ = radius > 0 ? 1 / radius : 0;
  }
  if (site.gravity != gravity_) {
    if (!(site.gravity > 0)) {
      throw std::invalid_argument("Site.gravity must be positive, is " +
                                  std::to_string(site.gravity));
    }
    gravity_ = site.gravity;
    inverse_gravity_ = 1 / gravity_;
  }
  if (dt != dt_) {
    dt_ = dt;
    alpha_steady_ = std::min(1.0, 2 * dt / options_.level_seconds);
    beta_steady_ = std::min(0.5, dt * dt / (options_.level_seconds * options_.level_seconds));
    sin_min_ = std::max(std::sin(options_.inclination_min),
                        options_.accel_noise / (units::kStandardGravity * std::sqrt(dt) *
                                                options_.sigma_toolface_max));
  }
}

// Where the observer starts; its gain of one then takes the first sample's value in full.
void HighSideTracker::TakeFirst(const ImuSample& sample) {
  const Eigen::Vector3d& f = sample.f_T;
  inclination_ = std::atan2(std::hypot(f.x(), f.y()), -f.z());
  sin_i_ = std::sin(inclination_);
  cos_i_ = std::cos(inclination_);
  csc_ = 1 / std::max(sin_i_, sin_min_);
  seen_[newest_].ux = 1;
}

void HighSideTracker::Prepare(const ImuSample& sample, const AlongHole& along, Seen& s) {
  s.stamp = sample.stamp;
  s.along = along;
  s.has_gz = sample.has_gz;
  s.quality = Quality::kGood;
  if (sample.stamp.gyro_saturated || sample.stamp.accel_saturated) s.quality |= Quality::kSaturated;
  if (sample.stamp.utc_unsynced) s.quality |= Quality::kClock;
  if (!along.known) s.quality |= Quality::kDepth;

  const double dt = dt_;
  const double wx = sample.w_IT_T.x(), wy = sample.w_IT_T.y();
  double fx = sample.f_T.x(), fy = sample.f_T.y(), fz = sample.f_T.z();
  s.e_r = -earth_cos_ * sin_azimuth_;
  if (along.known) {
    const double v = along.speed + 0.5 * dt * along.acceleration;
    const double e_h = earth_cos_ * cos_azimuth_ * cos_i_ + earth_sin_ * sin_i_;
    // e^{-iT} by the raw force: v W_e is so small that its own dynamics do not matter.
    const double scale = csc_ * inverse_gravity_;
    const double ex = (e_h * fx - s.e_r * fy) * scale, ey = (e_h * fy + s.e_r * fx) * scale;
    fx -= v * (wy + ey);
    fy += v * (wx + ex);
    fz -= along.acceleration;
    s.e_r -= v * sin_i_ * inverse_radius_;
  }
  if (options_.p_accel_T.x() != 0 || options_.p_accel_T.y() != 0) {
    TakeLeverArm(sample, dt, fx, fy, fz);
  }

  s.dt = dt;
  s.ax = wx * dt;
  s.ay = wy * dt;
  s.az = sample.w_IT_T.z() * dt;
  s.fz = fz;
  s.across = std::sqrt(fx * fx + fy * fy);
  const Seen& before = seen_[newest_];
  const double inverse = s.across > 0 ? 1 / s.across : 0;
  s.ux = s.across > 0 ? fx * inverse : before.ux;
  s.uy = s.across > 0 ? -fy * inverse : before.uy;
  s.vh = s.ax * s.ux - s.ay * s.uy;
  s.vr = s.ax * s.uy + s.ay * s.ux;
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

// The observer's gains: those of a line fitted to all that was seen, until they fall to those of
// two equal time constants.
void HighSideTracker::TakeGains(double dt) {
  alpha_ = alpha_steady_;
  beta_ = beta_steady_;
  if (memory_ >= 2 * options_.level_seconds) return;
  memory_ += dt;
  const double n = std::max(1.0, memory_ / dt);
  alpha_ = std::min(1.0, std::max(alpha_, 2 * (2 * n - 1) / (n * (n + 1))));
  beta_ = n < 1.5 ? 0 : std::max(beta_, 6 / (n * (n + 1)));
}

HighSideTracker::Mean HighSideTracker::Level(const Seen& s, double rise, double curve,
                                             double across) {
  Mean mean;
  mean.rise = rise;
  mean.sine = sin_i_;
  mean.cosine = cos_i_;
  const double to_mean = 0.5 * rise - curve / 12;
  Turn(to_mean, mean.sine, mean.cosine);
  mean.csc = 1 / std::max(mean.sine, sin_min_);

  const double a = across * mean.cosine + s.fz * mean.sine;
  const double b = across * mean.sine - s.fz * mean.cosine;
  double off = 0;
  if (b > 0 && std::abs(a) < 0.05 * b) {
    const double x = a / b;
    off = x * (1 - x * x * (1. / 3 - x * x * (1. / 5)));
  } else {
    off = std::atan2(a, b);
  }
  mean.accel = inclination_ + to_mean + off;

  TakeGains(s.dt);
  if (s.stamp.accel_saturated) alpha_ = beta_ = 0;
  double step = rise + alpha_ * off;
  rate_bias_ += beta_ * off / s.dt;
  const double raised = inclination_ + step;
  const double bounded = std::clamp(raised, 0.0, kPi);
  if (++since_exact_ >= 256 || bounded != raised) {
    since_exact_ = 0;
    sin_i_ = std::sin(bounded);
    cos_i_ = std::cos(bounded);
  } else {
    Turn(step, sin_i_, cos_i_);
  }
  rise_ = bounded - inclination_;
  inclination_ = bounded;
  csc_ = mean.csc;
  return mean;
}

// Change of toolface since the end of the sample before, whose last angle was extrapolated from
// its own window.
double HighSideTracker::Roll(const Seen& s, const Slopes& slopes) const {
  if (has_before_) {
    return delta_in_ + 0.5 * (slopes.c1 - slopes_.c1) + (slopes.c2 - slopes_.c2) / 6;
  }
  if (!ready_) return slopes.c1;
  const double begin = std::atan2(s.uy, s.ux) - 0.5 * slopes.c1 + slopes.c2 / 6;
  return WrapPi(begin - toolface()) + slopes.c1;
}

void HighSideTracker::Integrate(const Seen& s, const Slopes& slopes) {
  if (s.gap_ns > 0) {
    memory_ = std::max(0.0, memory_ - 1e-8 * static_cast<double>(s.gap_ns));
  }
  const double inverse = InverseSinc(slopes.c1);
  double vh = s.vh * inverse, vr = s.vr * inverse, curve_h = 0, curve_r = 0;
  if (options_.order == TrackerOptions::kThird) {
    const double moment = FirstMoment(slopes.c1);
    curve_h = slopes.a1h * inverse;
    curve_r = slopes.a1r * inverse;
    // The phase of the mean force leads while sin I grows, by cot I (rise) times the moment.
    const double lead = cos_i_ * csc_ * (vr + (rate_bias_ - s.e_r) * s.dt) * moment;
    const double h = vh - curve_r * moment, r = vr + curve_h * moment;
    vh = h + lead * r;
    vr = r - lead * h;
  }
  const Mean mean = Level(s, vr + (rate_bias_ - s.e_r) * s.dt, curve_r, s.across * inverse);
  const double csc = mean.csc, cot = mean.cosine * csc;

  double* part = part_.data();
  part[kTurn] = vh * csc;
  if (options_.order == TrackerOptions::kThird) {
    const double rise = mean.rise;
    part[kTurn] = csc * (vh * (1 + (cot * cot + csc * csc) * rise * rise * (1. / 24)) -
                         cot * rise * curve_h * (1. / 12));
  }
  part[kTurnR] = vr * csc;
  part[kLift] = vr;
  part[kLiftH] = vh;
  part[kRoll] = Roll(s, slopes);
  part[kCot] = cot * s.dt;
  part[kAccel] = mean.accel * s.dt;
  FollowErrors(s, slopes, mean, vh, vr);

  slopes_ = slopes;
  end_x_ = s.ux;
  end_y_ = s.uy;
  sample_quality_ = s.quality;
  sample_vertical_ = mean.sine < sin_min_;
  if (sample_vertical_) sample_quality_ |= Quality::kVertical;
  const double steepest = std::abs(slopes.c1) + std::abs(slopes.c2);
  if (!sample_vertical_ && steepest > options_.roll_limit) sample_quality_ |= Quality::kAliased;
  AddSample(s, sample_vertical_);
}

void HighSideTracker::FollowErrors(const Seen& s, const Slopes& slopes, const Mean& mean, double vh,
                                   double vr) {
  double* part = part_.data();
  const double dt = s.dt, csc = mean.csc, cot = mean.cosine * csc;
  const double ux = s.ux, uy = s.uy;
  // w_z dt = T' + A' cos I + e_t with A' from the gyros: what is left of the Earth is cL cA / sin
  // I.
  const double spin = s.has_gz ? s.az : slopes.c1 - cot * vh + earth_cos_ * cos_azimuth_ * csc * dt;
  const double roll_rate = slopes.c1 / dt;
  const double per_force = csc * inverse_gravity_;
  const double jitter = vr * csc * csc;

  part[kWhite] = csc * csc * dt;
  part[kJitter] = jitter * jitter / dt;
  part[kUnitC] = ux * dt;
  part[kUnitS] = uy * dt;
  part[kBiasC] = ux * dt * csc;
  part[kBiasS] = uy * dt * csc;
  part[kQuad] = gravity_ * mean.sine * dt;
  part[kMass] = gravity_ * mean.sine * dt * csc;
  part[kScaleXLift] = s.ax * uy;
  part[kScaleYLift] = s.ay * ux;
  part[kScaleX] = s.ax * ux * csc;
  part[kScaleY] = s.ay * uy * csc;
  part[kCrossXLift] = spin * uy;
  part[kCrossYLift] = spin * ux;
  part[kCrossX] = spin * ux * csc;
  part[kCrossY] = spin * uy * csc;
  part[kSkew] = roll_rate * vr * csc;
  part[kSkewLift] = roll_rate * vh;
  part[kAccelS] = vr * csc * per_force * uy;
  part[kAccelC] = vr * csc * per_force * ux;
  part[kAccelSLift] = vh * per_force * uy;
  part[kAccelCLift] = vh * per_force * ux;

  const double rates[kStates] = {
      part[kUnitS],      part[kUnitC],       -part[kQuad],       part[kScaleXLift],
      part[kScaleYLift], part[kCrossXLift],  part[kCrossYLift],  vh,
      part[kSkewLift],   -part[kAccelSLift], -part[kAccelCLift], 0};
  const double level = mean.cosine * inverse_gravity_;
  const double levels[kStates] = {0, 0, 0, 0,          0,           0,
                                  0, 0, 0, level * ux, -level * uy, mean.sine * inverse_gravity_};
  const double through = vh * csc * cot, beta = beta_ / dt;
  for (int i = 0; i < kStates; ++i) {
    const double begin = error_[i];
    const double rise = rates[i] + error_rate_[i] * dt;
    const double middle = begin + 0.5 * rise;
    const double off = levels[i] - middle;
    error_[i] = begin + rise + alpha_ * off;
    error_rate_[i] += beta * off;
    part[kThrough + i] = through * middle;
  }
}

void HighSideTracker::AddSample(const Seen& s, bool vertical) {
  for (int i = 0; i < kSums; ++i) sums_[i] += part_[i];
  if (empty_) {
    empty_ = false;
    seq_begin_ = s.stamp.seq;
  }
  ns_ += s.stamp.period_ns + s.gap_ns;
  gap_ns_ += s.gap_ns;
  lost_ += s.lost;
  quality_ |= sample_quality_;
  if (s.gap_ns > 0 || s.lost > 0) quality_ |= Quality::kGap;
  all_vertical_ = all_vertical_ && vertical;
  begin_ = s.stamp.tool_time;
  end_ = begin_ + Duration{s.stamp.period_ns};
  cut_ = 0;
  ready_ = true;
}

void HighSideTracker::FillErrors(const Sums& sums, Knot& knot) const {
  Knot::SourceVector& turn = knot.d_turn;
  turn(Knot::kGyroBiasX) = -sums[kBiasC];
  turn(Knot::kGyroBiasY) = sums[kBiasS];
  turn(Knot::kMassUnbalance) = -sums[kMass];
  turn(Knot::kGyroScaleX) = -sums[kScaleX];
  turn(Knot::kGyroScaleY) = sums[kScaleY];
  turn(Knot::kMisalignmentX) = -sums[kCrossX];
  turn(Knot::kMisalignmentY) = sums[kCrossY];
  turn(Knot::kToolfaceOffset) = sums[kTurnR];
  turn(Knot::kTimeSkew) = sums[kSkew];
  turn(Knot::kAccelBiasX) = -sums[kAccelS];
  turn(Knot::kAccelBiasY) = -sums[kAccelC];
  Knot::SourceVector& lift = knot.d_lift;
  lift(Knot::kGyroBiasX) = sums[kUnitS];
  lift(Knot::kGyroBiasY) = sums[kUnitC];
  lift(Knot::kQuadrature) = -sums[kQuad];
  lift(Knot::kGyroScaleX) = sums[kScaleXLift];
  lift(Knot::kGyroScaleY) = sums[kScaleYLift];
  lift(Knot::kMisalignmentX) = sums[kCrossXLift];
  lift(Knot::kMisalignmentY) = sums[kCrossYLift];
  lift(Knot::kToolfaceOffset) = sums[kLiftH];
  lift(Knot::kTimeSkew) = sums[kSkewLift];
  lift(Knot::kAccelBiasX) = -sums[kAccelSLift];
  lift(Knot::kAccelBiasY) = -sums[kAccelCLift];
  for (int i = 0; i < kStates; ++i) {
    turn(kSourceOfState[i]) += sums[kThrough + i];
    knot.d_inclination(kSourceOfState[i]) = error_[i];
  }
}

Knot HighSideTracker::CutKnot(double fraction) {
  if (!ready_) throw std::invalid_argument("CutKnot before the first sample has been summed");
  if (!(fraction > 0 && fraction <= 1 && fraction >= cut_)) {
    throw std::invalid_argument("CutKnot: fraction must lie in (0, 1] and not before " +
                                std::to_string(cut_) + ", is " + std::to_string(fraction));
  }
  const Seen& s = last();
  const double rest = 1 - fraction, u = fraction - 0.5;
  Sums remainder;
  for (int i = 0; i < kSums; ++i) remainder[i] = rest * part_[i];
  remainder[kRoll] = slopes_.c1 * (0.5 - u) + slopes_.c2 * (0.25 - u * u);
  Sums sums;
  for (int i = 0; i < kSums; ++i) sums[i] = sums_[i] - remainder[i];
  const std::int64_t rest_ns = std::llround(rest * s.stamp.period_ns);
  const Duration into{s.stamp.period_ns - rest_ns};

  Knot knot;
  knot.time = s.stamp.tool_time + into;
  knot.utc = s.stamp.utc + into;
  knot.along = s.along;
  if (s.along.known) {
    const double t = into.seconds();
    knot.along.md += t * (s.along.speed + 0.5 * t * s.along.acceleration);
    knot.along.speed += t * s.along.acceleration;
  }
  knot.seconds = 1e-9 * static_cast<double>(ns_ - rest_ns);
  knot.gap_seconds = 1e-9 * static_cast<double>(gap_ns_);
  knot.inclination = inclination_ - rest * rise_;
  knot.toolface = WrapPi(toolface() - remainder[kRoll]);
  knot.turn = -sums[kTurn];
  knot.cot = sums[kCot];
  knot.lift = sums[kLift];
  knot.roll = sums[kRoll];
  FillErrors(sums, knot);
  knot.white_turn = sums[kWhite];
  const double noise = options_.accel_noise * inverse_gravity_;
  knot.toolface_noise_turn = noise * noise * sums[kJitter];
  const double sampled = knot.seconds - knot.gap_seconds;
  knot.inclination_accel = sampled > 0 ? sums[kAccel] / sampled : knot.inclination;
  knot.sigma_inclination_accel = noise / std::sqrt(std::max(sampled, 1e-9));
  // Accelerometer noise through a line fit of the time seen, later through the observer; the gyros'
  // through the observer.
  const double seconds = options_.level_seconds;
  const double walk = options_.angle_random_walk;
  knot.sigma_inclination =
      std::sqrt(noise * noise * std::max(4 / std::max(memory_, s.dt), 1.25 / seconds) +
                walk * walk * seconds / 4);
  knot.vertical = !empty_ && all_vertical_;
  knot.seq_begin = empty_ ? s.stamp.seq + (cut_ >= 1 ? 1 : 0) : seq_begin_;
  knot.seq_end = s.stamp.seq + 1;
  knot.samples_lost = lost_;
  knot.quality = quality_;

  sums_ = remainder;
  ns_ = rest_ns;
  gap_ns_ = lost_ = 0;
  empty_ = rest <= 0;
  seq_begin_ = s.stamp.seq;
  cut_ = fraction;
  all_vertical_ = empty_ || sample_vertical_;
  quality_ = empty_ ? Quality::kGood : sample_quality_;
  return knot;
}

}  // namespace wellgyro
