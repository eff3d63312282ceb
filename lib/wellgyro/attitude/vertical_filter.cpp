#include "wellgyro/attitude/vertical_filter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include "wellgyro/attitude/roll_walk_internal.h"
#include "wellgyro/attitude/vertical_core_internal.h"
#include "wellgyro/attitude/vertical_knot_internal.h"
#include "wellgyro/attitude/vertical_lift_internal.h"
#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/math/drift.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/record/knot_sources.h"
#include "wellgyro/record/unknown_angle.h"

namespace wellgyro {
namespace {

using vertical::Core;
using vertical::Counted;
using vertical::Cut;
using vertical::CutOf;
using vertical::FillKnot;
using vertical::Gap;
using vertical::kWalks;
using vertical::Noise;
using vertical::Reference;
using vertical::RollWalk;
using vertical::SensedOf;
using vertical::VarOf;

constexpr double kHeld = 1e-5;  // of the axial rate at rest [rad/s]
constexpr double kBlockSeconds = 0.2;
constexpr double kByNoise = 500;  // [sqrt(Hz)], see the header
constexpr double kByBias = 50;
constexpr double kSineLeast = 2e-3;
constexpr double kSineByThird = 0.25;  // with a third gyro axis the sum grows best up to there
constexpr double kLeave = 1.3;         // of the sine at which the filter takes over
constexpr double kRun = 6, kStop = 7;
constexpr double kNoiseLeast = 1e-5;     // no accelerometer is better [m/s^2 sqrt(s)]
constexpr double kToolfaceVague = 0.1;   // [rad], beyond it azimuth and toolface mean little
constexpr double kToolfaceClear = 0.03;  // of its noise alone, up to which rates are turned with it
constexpr double kLostVariance = 0.25;   // of the sum: nothing learned later brings it back [rad^2]

bool IsFinite(const ImuSample& s) {
  return s.w_IT_T.head<2>().allFinite() && s.f_T.allFinite() &&
         (!s.has_gz || std::isfinite(s.w_IT_T.z()));
}

}  // namespace

double SineNearVertical(const ErrorPriors& errors, bool has_gz) {
  if (has_gz) return kSineByThird;
  return std::max({kByNoise * errors.accel_noise / units::kStandardGravity,
                   kByBias * errors.accel_bias_sigma / units::kStandardGravity, kSineLeast});
}

struct VerticalFilter::Impl {
  explicit Impl(const VerticalSetup& s);
  bool StartsAt(const ImuSample& sample) const;
  void Start(const ImuSample& sample, const AlongHole& along, const Site& site);
  void Close();
  void CloseBank(double seconds);
  void CloseThird(double seconds);
  void TakeThird(bool has_gz);
  vertical::Gap GapOf(double seconds) const;
  void Bridge(const ImuSample& next, const AlongHole& next_along, double seconds);
  void AddUnseen(const ImuSample& sample, const AlongHole& now);
  Noise NoiseOf(double axial_walk) const;
  Eigen::Matrix3d CovTurn() const;
  void SetHeading(double azimuth, double variance);
  Cut CutAt(double rest) const;
  bool IsVague(const Cut& cut) const;
  bool IsClear(const Cut& cut) const;
  void Fill(const Cut& now, bool axial, const std::optional<vertical::Lift>& lift, Knot& knot);
  void FloorAtAccelerometers(Knot& knot) const;
  void CountSum();
  void ForgetBias();

  VerticalSetup setup;
  Noise noise;
  double bias_sigma = 0;
  double sine_of_two = kSineLeast, sine_enter = kSineLeast;  // with two gyro axes; now
  Reference reference;
  // The stretch near vertical.
  bool axial = false, linked = false, cut_before = false;
  Cut last;  // at the knot before
  Counted counted;
  Knot::SourceVector source_sigma;
  vertical::LiftSums lift_sums;
  Core main;
  std::array<Core, kWalks.size()> bank;
  RollWalk walk;
  std::optional<double> rate_before;  // about the axis where measured, in the block before [rad/s]
  UnseenTurn unseen_across, unseen_about;  // of the axis, and about it
  AlongHole last_along;                    // of the last sample
  double dt = 0;                           // its period [s]
  bool started = false, ready = false;
  bool lost = false;   // of the sum nothing is left, and gravity has not shown the toolface since
  bool found = false;  // now it does: with the next sample all begins anew
  ToolTime end;
  std::int64_t seq = 0;
  std::int32_t session = 0;
};

VerticalFilter::Impl::Impl(const VerticalSetup& s) : setup(s) {
  const NoiseCoefficients& g = s.gyro;
  sine_of_two = SineNearVertical(s.errors, false);
  noise.rate = g.angle_random_walk;
  noise.force = std::max(s.errors.accel_noise, kNoiseLeast);
  noise.bias_walk = g.rate_random_walk;
  double instability = g.bias_instability;
  if (g.bias_instability_correlation_time) {
    instability *= kMarkovSigmaPerInstability;
    noise.bias_walk = std::hypot(noise.bias_walk,
                                 instability * std::sqrt(2 / *g.bias_instability_correlation_time));
  }
  // For the gains alone, with a margin: of what each sample shows the slopes tell.
  noise.skewed = std::hypot(s.errors.gyro_misalignment_sigma, s.errors.gyro_scale_sigma);
  bias_sigma = std::hypot(s.errors.gyro_bias_sigma, instability);
  source_sigma = SourceSigmas(s.errors);
  source_sigma[Knot::kGyroBiasX] = source_sigma[Knot::kGyroBiasY] = bias_sigma;
}

Noise VerticalFilter::Impl::NoiseOf(double axial_walk) const {
  Noise n = noise;
  n.axial_walk = axial_walk;
  return n;
}

// The gains rest on what the filter models; what all errors do with these gains is known better.
Eigen::Matrix3d VerticalFilter::Impl::CovTurn() const {
  const auto slopes = main.sources().topLeftCorner<3, Knot::kSources>();
  return main.cov_noise().topLeftCorner<3, 3>() +
         slopes * source_sigma.cwiseAbs2().asDiagonal() * slopes.transpose();
}

inline bool VerticalFilter::Impl::StartsAt(const ImuSample& sample) const {
  const Eigen::Vector3d& f = sample.f_T;
  const double sine = std::min(kRun * (sample.has_gz ? kSineByThird : sine_of_two), 0.5);
  const double across = f.x() * f.x() + f.y() * f.y();
  return f.z() < 0 && across < sine * sine * (across + f.z() * f.z());
}

void VerticalFilter::Impl::Start(const ImuSample& sample, const AlongHole& along,
                                 const Site& site) {
  const Eigen::Vector3d& f = sample.f_T;
  const Eigen::Matrix3d R_LT =
      AttitudeMatrix(0, std::atan2(std::hypot(f.x(), f.y()), -f.z()), std::atan2(-f.y(), f.x()));
  reference.latitude = site.latitude;
  sine_enter = sample.has_gz ? kSineByThird : sine_of_two;
  main.Start(SensedOf(sample, along, site, reference.heading(), R_LT), R_LT, setup.errors,
             bias_sigma);
  bank.fill(main);
  walk.Reset();
  rate_before.reset();
  last = Cut();
  last.toolface = std::atan2(-f.y(), f.x());
  last.inclination = std::atan2(std::hypot(f.x(), f.y()), -f.z());
  counted = Counted();
  linked = !cut_before;
  axial = std::sin(last.inclination) < sine_enter && f.z() < 0;
  unseen_across = unseen_about = UnseenTurn();
  lift_sums = vertical::LiftSums();
  started = true;
  ready = lost = found = false;
}

void VerticalFilter::Impl::SetHeading(double azimuth, double variance) {
  if (main.block_seconds() > 0) Close();
  const auto azimuth_of = [](const Core& core) {
    return std::atan2(core.R_LT()(1, 2), core.R_LT()(0, 2));
  };
  const double turn = azimuth - azimuth_of(main);
  for (Core& core : bank) core.SetHeading(azimuth_of(core) + turn, variance);
  main.SetHeading(azimuth, variance);
}

// Samples are missing, and how deep the tool was behind them is not known yet.
Gap VerticalFilter::Impl::GapOf(double seconds) const {
  AlongHole behind = last_along;
  behind.md += last_along.speed * seconds;
  const double turned = setup.unseen.Between(last_along, behind, seconds, seconds);
  return {seconds, unseen_across.VarOf(turned), walk.Over(seconds), std::nullopt, std::nullopt};
}

void VerticalFilter::Impl::Bridge(const ImuSample& next, const AlongHole& next_along,
                                  double seconds) {
  Close();
  lift_sums.Break();
  Gap gap = GapOf(seconds);
  const double apart = seconds + (dt + 1e-9 * next.stamp.period_ns) / 2;
  const double turned = setup.unseen.Between(last_along, next_along, seconds, apart);
  gap.var_across = unseen_across.VarOf(turned);
  if (next.has_gz) gap.axial_end = next.w_IT_T.z();
  if (!next.stamp.accel_saturated) gap.toolface_end = std::atan2(-next.f_T.y(), next.f_T.x());
  main.Bridge(gap);
  for (Core& core : bank) core.Bridge(gap);
  rate_before.reset();
  unseen_across.Add(turned);
  walk.Pass(seconds);
}

// A gyro stands at full scale, and which is not said.
void VerticalFilter::Impl::AddUnseen(const ImuSample& sample, const AlongHole& now) {
  unseen_across.Pass(dt, setup.unseen.seconds);
  unseen_about.Pass(dt, setup.unseen.seconds);
  if (!sample.stamp.gyro_saturated) return;
  const double turned = setup.unseen.Beyond(now, dt * sample.w_IT_T.head<2>().norm(), dt);
  const double rolled = sample.has_gz ? dt * std::abs(sample.w_IT_T.z()) : 0;
  const double var_across = unseen_across.VarOf(turned), var_about = unseen_about.VarOf(rolled);
  main.Widen(var_across, var_about);
  for (Core& core : bank) core.Widen(var_across, var_about);
  unseen_across.Add(turned);
  unseen_about.Add(rolled);
}

Cut VerticalFilter::Impl::CutAt(double rest) const {
  Core core = main;
  core.Close(NoiseOf(walk.mean()));
  if (rest < 0) core.Bridge(GapOf(-rest));
  return CutOf(core, core.Before(std::max(rest, 0.0)));
}

// From here on: what was given to knots so far is theirs for good.
void VerticalFilter::Impl::CountSum() {
  main.CountSum();
  for (Core& core : bank) core.CountSum();
  last.in_sum.d.setZero();
  counted = Counted();
}

// It was learned with the Earth's rate as the azimuth then seemed to be: with an azimuth that has
// since become worse it would be wrong in every stretch, and its noise would be one in all of them.
void VerticalFilter::Impl::ForgetBias() {
  main.ForgetBias(bias_sigma);
  for (Core& core : bank) core.ForgetBias(bias_sigma);
}

// Where gravity does not show how the tool rolls, a lean is not told from the accelerometers' bias.
void VerticalFilter::Impl::FloorAtAccelerometers(Knot& knot) const {
  const double bias = setup.errors.accel_bias_sigma;
  const auto d = knot.d_inclination.segment<2>(static_cast<int>(Knot::kAccelBiasX));
  const double missing = 1 / (units::kStandardGravity * units::kStandardGravity) - d.squaredNorm();
  if (missing > 0) {
    knot.sigma_inclination = std::hypot(knot.sigma_inclination, bias * std::sqrt(missing));
  }
}

bool VerticalFilter::Impl::IsVague(const Cut& cut) const {
  const Knot::SourceVector d_toolface = cut.in_toolface.by_sources();
  return VarOf(cut.in_toolface, reference) + d_toolface.cwiseProduct(source_sigma).squaredNorm() >
         kToolfaceVague * kToolfaceVague;
}

// Rates and forces may be turned with the toolface.
bool VerticalFilter::Impl::IsClear(const Cut& cut) const {
  return !IsVague(cut) && cut.in_toolface.var < kToolfaceClear * kToolfaceClear;
}

// The knot from the cut before to this one; `is_axial`: what it leaves behind is S - toolface.
void VerticalFilter::Impl::Fill(const Cut& now, bool is_axial,
                                const std::optional<vertical::Lift>& lift, Knot& knot) {
  const bool vague = IsVague(now);
  const bool clear = linked && IsClear(last) && IsClear(now);
  FillKnot(
      {last, now, reference, is_axial, main.heading_feeds_back(), lift && clear ? &*lift : nullptr},
      &counted, &knot);
  knot.vertical = !linked;
  if (is_axial && !knot.lifts) FloorAtAccelerometers(knot);
  // What was learned while the sum was anything rests on slopes taken far from the truth.
  found = lost && is_axial && !vague;
  constexpr auto kAll = ~static_cast<std::uint32_t>(Quality::kVertical);
  knot.quality = knot.quality & static_cast<Quality>(kAll);
  if (vague) knot.quality |= Quality::kVertical;
  linked = true;
}

void VerticalFilter::Impl::CloseBank(double seconds) {
  vertical::PerWalk likelihood;
  for (std::size_t i = 0; i < kWalks.size(); ++i) {
    likelihood[i] = bank[i].Close(NoiseOf(kWalks[i]));
  }
  main.Close(NoiseOf(walk.mean()));
  walk.Weigh(likelihood, seconds);
  for (std::size_t i = 0; i < kWalks.size(); ++i) {
    if (walk.TakeIdle(i)) bank[i] = main;
  }
}

// Where the rate is measured, so is its walk.
void VerticalFilter::Impl::CloseThird(double seconds) {
  if (seconds > 0) {
    const double rate = main.block_spin() / seconds;
    if (rate_before) {
      vertical::PerWalk likelihood;
      for (std::size_t i = 0; i < kWalks.size(); ++i) {
        const double var =
            kWalks[i] * kWalks[i] * seconds * 2 / 3 + 2 * noise.rate * noise.rate / seconds;
        const double off = rate - *rate_before;
        likelihood[i] = -0.5 * (off * off / var + std::log(var));
      }
      walk.Weigh(likelihood, seconds);
    }
    rate_before = rate;
  }
  main.Close(noise);
}

// The third gyro axis came, or fell away.
void VerticalFilter::Impl::TakeThird(bool has_gz) {
  if (main.block_seconds() > 0) Close();
  main.TakeThird(has_gz, has_gz ? bias_sigma : noise.rate / std::sqrt(dt));
  bank.fill(main);
  sine_enter = has_gz ? kSineByThird : sine_of_two;
  rate_before.reset();
}

void VerticalFilter::Impl::Close() {
  const double seconds = main.block_seconds();
  if (!main.has_gz()) {
    CloseBank(seconds);
  } else {
    CloseThird(seconds);
  }
  const Eigen::RowVector3d toolface = vertical::EulerSlopes(main.R_LT()).row(2);
  lift_sums.TakeToolface((toolface * main.sources().topLeftCorner<3, Knot::kSources>()).transpose(),
                         main.regained());
  ready = true;
}

VerticalFilter::VerticalFilter(const VerticalSetup& setup) : impl_(std::make_unique<Impl>(setup)) {}
VerticalFilter::~VerticalFilter() = default;
VerticalFilter::VerticalFilter(const VerticalFilter& other)
    : impl_(std::make_unique<Impl>(*other.impl_)) {}
VerticalFilter& VerticalFilter::operator=(const VerticalFilter& other) {
  *impl_ = *other.impl_;
  return *this;
}
VerticalFilter::VerticalFilter(VerticalFilter&&) noexcept = default;
VerticalFilter& VerticalFilter::operator=(VerticalFilter&&) noexcept = default;

bool VerticalFilter::Wants(const ImuSample& sample) const {
  return impl_->started || impl_->StartsAt(sample);
}

void VerticalFilter::Push(const ImuSample& sample, const AlongHole& along, const Site& site) {
  Impl& m = *impl_;
  const SampleStamp& stamp = sample.stamp;
  if (!Wants(sample)) return;
  if (stamp.period_ns <= 0 || !IsFinite(sample)) return;
  if (!m.started) {
    m.Start(sample, along, site);
  } else {
    const double apart = (stamp.tool_time - m.end).seconds(), period = 1e-9 * stamp.period_ns;
    if (stamp.session == m.session && apart < -period / 2) return;
    if (stamp.session != m.session || m.found) {
      m.Start(sample, along, site);
    } else if (apart > period / 2) {
      m.Bridge(sample, along, apart);
    }
    if (sample.has_gz != m.main.has_gz()) m.TakeThird(sample.has_gz);
  }
  m.session = stamp.session;
  m.end = stamp.tool_time + Duration{stamp.period_ns};
  m.last_along = along;
  m.dt = 1e-9 * stamp.period_ns;
  const vertical::Heading heading = m.reference.heading();
  const vertical::Sensed sensed = SensedOf(sample, along, site, heading, m.main.R_LT());
  m.main.Predict(sensed);
  m.lift_sums.Add(sensed, m.main.R_middle(), m.main.axial_rate());
  if (!sample.has_gz) {
    for (Core& core : m.bank) core.Predict(SensedOf(sample, along, site, heading, core.R_LT()));
  }
  m.AddUnseen(sample, along);
  if (m.main.block_seconds() > kBlockSeconds - 1e-9) m.Close();
}

void VerticalFilter::SetAzimuth(double azimuth, double variance) {
  const Reference& r = impl_->reference;
  impl_->SetHeading(azimuth - r.azimuth.value_or(0), variance);
  if (!r.azimuth) SetNorth(0.0, std::sqrt(variance));
}

void VerticalFilter::SetNorth(std::optional<double> azimuth_of_zero, double sigma) {
  impl_->reference.azimuth = azimuth_of_zero;
  impl_->reference.sigma = sigma;
}

void VerticalFilter::CutKnot(double rest, Knot& knot) {
  Impl& m = *impl_;
  if (!m.started) {
    m.cut_before = true;
    return;
  }
  const bool from_axis = !m.cut_before && m.axial && m.setup.start_is_axis;
  m.cut_before = true;
  if (from_axis) m.SetHeading(m.CutAt(0).azimuth, 0);
  Cut now = m.CutAt(rest);
  const auto lift = m.lift_sums.Cut(rest, knot.seconds, now.in_toolface.by_sources());
  const double sine = std::sin(now.inclination);
  if (m.axial) {
    if (from_axis) m.last = now, m.last.in_sum.d.setZero();
    const double turn = knot.turn, cot = knot.cot;
    m.axial = sine < kLeave * m.sine_enter;
    m.Fill(now, m.axial, lift, knot);
    // Until its first forces are in, the filter cannot tell how the azimuth grew.
    if (from_axis) knot.turn = turn, knot.cot = cot, knot.axial_cot = 0;
  }
  if (!m.axial) {
    if (sine > std::min(kStop * m.sine_enter, 0.6)) {
      m.started = m.ready = false;
    } else if (sine < m.sine_enter) {
      m.axial = m.linked = true;
      m.counted = Counted();
      m.SetHeading(m.CutAt(0).azimuth, 0);
      m.ForgetBias();
      now = m.CutAt(rest);
      // What the filter holds there is azimuth, which is taken for free of error.
      now.in_sum.d.setZero();
    } else {
      // Whoever told of north tells of the azimuth: nothing is to be learned of it here.
      m.SetHeading(now.azimuth, 0);
    }
  }
  m.last = now;
  if (m.axial && now.in_sum.var > kLostVariance) {
    m.lost = true;
    if (m.main.block_seconds() > 0) m.Close();
    m.CountSum();
  }
}

void VerticalFilter::Hold() {
  Impl& m = *impl_;
  if (!m.started) return;
  if (m.main.block_seconds() > 0) m.Close();
  m.main.Hold(kHeld);
  for (Core& core : m.bank) core.Hold(kHeld);
  m.CountSum();
  m.walk.Reset();
}

void VerticalFilter::Release() {
  Impl& m = *impl_;
  if (!m.started) return;
  if (m.main.block_seconds() > 0) m.Close();
  m.main.Release();
  for (Core& core : m.bank) core.Release();
  m.walk.Reset();
}

bool VerticalFilter::running() const { return impl_->started; }
double VerticalFilter::azimuth_from_zero() const { return impl_->last.azimuth; }
bool VerticalFilter::ready() const { return impl_->ready; }

AttitudeSample VerticalFilter::attitude() const {
  const Core& core = impl_->main;
  const Eigen::Matrix3d& R = core.R_LT();
  AttitudeSample a;
  a.time = impl_->end;
  a.inclination = std::atan2(std::hypot(R(0, 2), R(1, 2)), R(2, 2));
  a.azimuth = WrapTwoPi(std::atan2(R(1, 2), R(0, 2)) + impl_->reference.azimuth.value_or(0));
  a.toolface = std::atan2(R(2, 1), -R(2, 0));
  const Eigen::Matrix3d slopes = vertical::EulerSlopes(R);
  a.cov_attitude = slopes * impl_->CovTurn() * slopes.transpose();
  a.azimuth_known = a.cov_attitude(1, 1) < kUnknownAngleVariance;
  return a;
}

double VerticalFilter::axial_rate() const { return impl_->main.axial(); }
double VerticalFilter::sigma_axial_rate() const {
  return std::sqrt(impl_->main.cov()(vertical::kAxial, vertical::kAxial));
}

}  // namespace wellgyro
