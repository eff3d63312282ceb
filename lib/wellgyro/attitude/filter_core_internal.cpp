#include "wellgyro/attitude/filter_core_internal.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "wellgyro/base/angle.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/record/knot_sources.h"

namespace wellgyro {
namespace {

// Of an unknown azimuth, which the Earth's rate makes grow as any error of it; beyond, what links
// it to what comes is not worth its digits.
constexpr double kFaintestVariance = 100 * kDiffuseAzimuthVariance;

double Square(double x) { return x * x; }

double Sinc(double x) { return std::abs(x) < 1e-4 ? 1 - x * x / 6 : std::sin(x) / x; }

FilterMatrix PriorOf(const FilterSetup& setup, const FilterLayout& layout) {
  FilterMatrix prior = FilterMatrix::Zero(layout.size, layout.size);
  prior(0, 0) = setup.start_azimuth ? Square(setup.start_sigma) : kDiffuseAzimuthVariance;
  const Eigen::Matrix4d drift = DriftPrior(DriftOf(setup));
  for (const auto& axis : layout.drift) {
    if (axis.level >= 0) prior(axis.level, axis.level) = drift(kDriftLevel, kDriftLevel);
    if (axis.markov >= 0) prior(axis.markov, axis.markov) = drift(kDriftMarkov, kDriftMarkov);
    if (axis.ramp >= 0) prior(axis.ramp, axis.ramp) = drift(kDriftRamp, kDriftRamp);
  }
  const Knot::SourceVector sigma = SourceSigmas(setup.errors);
  for (int i = 0; i < Knot::kSources; ++i) {
    const int at = layout.source[static_cast<std::size_t>(i)];
    if (at >= 0) prior(at, at) = Square(sigma[i]);
  }
  if (layout.latitude >= 0) {
    prior(layout.latitude, layout.latitude) = Square(setup.errors.latitude_sigma);
  }
  prior(layout.inclination, layout.inclination) = kNoInclination;
  return prior;
}

}  // namespace

double MeanSpeed(const Knot& knot, const FilterPlace& before) {
  if (!knot.along.known || !(knot.seconds > 0)) return 0;
  if (!before.any_knot || !before.along.known) return knot.along.speed;
  return (knot.along.md - before.along.md) / knot.seconds;
}

double MeanInclination(const Knot& knot, const FilterPlace& before) {
  return before.any_knot ? (knot.inclination + before.inclination) / 2 : knot.inclination;
}

DriftCoefficients DriftOf(const FilterSetup& setup) {
  // White noise comes in through Knot::white_turn, which knows the inclination inside the knot.
  return {.angle_random_walk = 0,
          .constant = setup.errors.gyro_bias_sigma,
          .bias_instability = setup.gyro.bias_instability,
          .correlation_time = setup.gyro.bias_instability_correlation_time,
          .rate_random_walk = setup.gyro.rate_random_walk,
          .rate_ramp = setup.gyro.rate_ramp};
}

FilterLayout LayoutOf(const FilterSetup& setup) {
  FilterLayout layout;
  const DriftCoefficients drift = DriftOf(setup);
  const bool markov = drift.correlation_time && drift.bias_instability > 0;
  const bool ramp = drift.rate_ramp > 0;
  const bool level = drift.constant > 0 || drift.rate_random_walk > 0 || ramp ||
                     (!drift.correlation_time && drift.bias_instability > 0);
  for (auto& axis : layout.drift) {
    if (level) axis.level = layout.size++;
    if (markov) axis.markov = layout.size++;
    if (ramp) axis.ramp = layout.size++;
  }
  const Knot::SourceVector sigma = SourceSigmas(setup.errors);
  for (int i = 0; i < Knot::kSources; ++i) {
    layout.source[static_cast<std::size_t>(i)] = sigma[i] > 0 ? layout.size++ : -1;
  }
  if (setup.errors.latitude_sigma > 0) layout.latitude = layout.size++;
  layout.inclination = layout.size++;
  return layout;
}

AzimuthGrowth GrowthOver(const Knot& knot, const FilterPlace& before, const Site& site,
                         double azimuth, bool backwards) {
  const double north = kEarthRate * std::cos(before.latitude);
  const double up = kEarthRate * std::sin(before.latitude);
  const double inclination = MeanInclination(knot, before);
  const double across = MeanSpeed(knot, before) * std::sin(inclination);
  const double rise = before.height - site.height;
  const double per_north = across / (site.radius_north + rise);
  const double per_east = across / (site.radius_east + rise);
  const double tan_latitude = std::tan(before.latitude);
  // In a gap the hole is taken to keep its direction, and nothing is measured: no share of either.
  const double seconds = knot.seconds - knot.gap_seconds;

  AzimuthGrowth result;
  double c = 0, s = 0;
  std::complex<double> axial;
  for (int pass = 0; pass < 4; ++pass) {
    const double half = result.growth / 2;
    const double mid = backwards ? azimuth - half : azimuth + half;
    const double mean = Sinc(half);
    c = std::cos(mid) * mean, s = std::sin(mid) * mean;
    axial = std::polar(1.0, backwards ? azimuth - result.growth : azimuth) * knot.axial_cot;
    result.growth = knot.turn + knot.cot * (c * (north + per_east * s) - s * per_north * c) +
                    north * axial.real() + seconds * (up + per_east * s * tan_latitude);
  }
  const double slope = -knot.cot * north * s;  // against the azimuth at the middle
  result.by_azimuth = slope / (1 - slope / 2) - north * axial.imag();
  result.by_latitude = -(knot.cot * c + axial.real()) * up + seconds * north;
  if (knot.axial) return result;
  const double cot = seconds > 0 ? knot.cot / seconds : 0;
  result.by_inclination = -north * c * (1 + cot * cot) * seconds;
  return result;
}

double StillGrowth(const Knot& knot) { return knot.axial ? -knot.roll : 0; }

FilterCore::FilterCore(const FilterSetup& setup)
    : setup_(setup), layout_(LayoutOf(setup)), drift_(DriftOf(setup)) {
  state_ = FilterVector::Zero(layout_.size);
  state_[0] = setup.start_azimuth.value_or(0);
  covariance_ = PriorOf(setup, layout_);
  diffuse_ = !(covariance_(0, 0) < kUnknownAngleVariance);
  place_.latitude = setup.site.latitude;
  place_.height = setup.site.height;
}

double FilterCore::WhiteVariance(const Knot& knot) const {
  double variance = Square(setup_.gyro.angle_random_walk) * knot.white_turn +
                    knot.toolface_noise_turn +
                    VarBeyondOf(knot, setup_.errors, setup_.site.gravity, 0).turn;
  if (knot.var_unseen > 0 && !knot.axial) {
    variance += knot.var_unseen / Square(std::max(std::sin(MeanInclination(knot, place_)), 1e-6));
  }
  return variance;
}

FilterTransition FilterCore::TransitionOver(const Knot& knot, double azimuth_begin) const {
  FilterTransition t;
  t.seconds = knot.seconds;
  if (drift_.correlation_time) t.decay = std::exp(-knot.seconds / *drift_.correlation_time);
  t.row = FilterVector::Zero(layout_.size);
  t.row[0] = 1;
  if (knot.still) t.offset = StillGrowth(knot);
  if (knot.still || !(knot.seconds > 0)) return t;

  const AzimuthGrowth g = GrowthOver(knot, place_, setup_.site, azimuth_begin, false);
  t.row[0] = 1 + g.by_azimuth;
  // The true turn is the measured one less the errors' share; the true inclination, in the Earth's
  // share, is the measured one less theirs.
  const Knot::SourceVector share = -(knot.d_turn + g.by_inclination * knot.d_inclination);
  for (int source = 0; source < Knot::kSources; ++source) {
    const int at = layout_.source[static_cast<std::size_t>(source)];
    if (at >= 0) t.row[at] = share[source];
  }
  if (layout_.latitude >= 0) t.row[layout_.latitude] = g.by_latitude;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const auto& at = layout_.drift[axis];
    t.gain[axis] = share[BiasOf(axis)] / knot.seconds;
    const DriftStep step = DriftOver(drift_, t.gain[axis], knot.seconds);
    if (at.level >= 0) t.row[at.level] = step.transition(kDriftIntegral, kDriftLevel);
    if (at.markov >= 0) t.row[at.markov] = step.transition(kDriftIntegral, kDriftMarkov);
    if (at.ramp >= 0) t.row[at.ramp] = step.transition(kDriftIntegral, kDriftRamp);
  }
  t.offset = g.growth + azimuth_begin - t.row[0] * azimuth_begin;
  t.white = WhiteVariance(knot);
  return t;
}

void FilterCore::Propagate(const Knot& knot, const FilterTransition& t) {
  ApplyTransition(layout_, t, &state_);
  state_[0] += t.offset;
  state_[layout_.inclination] += t.rise.offset;
  ApplyTransition(layout_, t, &covariance_);
  covariance_.transposeInPlace();
  ApplyTransition(layout_, t, &covariance_);
  if (cross_.size() > 0) {
    cross_.transposeInPlace();
    ApplyTransition(layout_, t, &cross_);
    cross_.transposeInPlace();
  }
  covariance_(0, 0) += t.white;
  covariance_(layout_.inclination, layout_.inclination) += t.rise.white;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const auto& at = layout_.drift[axis];
    const DriftStep step = DriftOver(drift_, t.gain[axis], knot.seconds);
    const auto add = [&](int i, int j, DriftState a, DriftState b) {
      if (i < 0) return;
      covariance_(i, j) += step.noise(a, b);
      if (i != j) covariance_(j, i) += step.noise(a, b);
    };
    if (at.level >= 0 || at.markov >= 0) covariance_(0, 0) += step.noise(0, 0);
    add(at.level, 0, kDriftLevel, kDriftIntegral);
    add(at.level, at.level, kDriftLevel, kDriftLevel);
    add(at.markov, 0, kDriftMarkov, kDriftIntegral);
    add(at.markov, at.markov, kDriftMarkov, kDriftMarkov);
  }
}

FilterTransition FilterCore::Step(const Knot& knot, double azimuth_begin,
                                  std::optional<double> nominal_end) {
  FilterTransition t = TransitionOver(knot, azimuth_begin);
  const double variance = t.row.dot(covariance_ * t.row) + t.white;
  const bool lost = !azimuth_diffuse() && variance > kUnknownAngleVariance;
  const bool too_long = variance > kFaintestVariance;
  const double azimuth_before = state_[0];
  Rise(knot, azimuth_begin, &t);
  if (!knot.still && knot.seconds > 0 && (knot.vertical || lost || too_long)) {
    t.row.setZero();
    t.gain = {};
    t.white = kDiffuseAzimuthVariance;
    t.offset = nominal_end.value_or(azimuth_before);
    diffuse_ = true;
  }
  Propagate(knot, t);

  if (knot.seconds > 0 && knot.along.known && (nominal_end || azimuth_known())) {
    const double to = nominal_end.value_or(state_[0]);
    const double mid = azimuth_begin + (to - azimuth_begin) / 2;
    const double along = MeanSpeed(knot, place_) * knot.seconds;
    const double inclination = MeanInclination(knot, place_);
    const double rise = place_.height - setup_.site.height;
    place_.latitude +=
        along * std::sin(inclination) * std::cos(mid) / (setup_.site.radius_north + rise);
    place_.height -= along * std::cos(inclination);
  }
  place_.any_knot = true;
  place_.inclination = knot.inclination;
  place_.along = knot.along;
  return t;
}

StillMeasurements FilterCore::AtRest(const Knot& knot, const StillWindowPoint& about) const {
  const double azimuth = about.azimuth;
  const double north = kEarthRate * std::cos(place_.latitude);
  const double up = kEarthRate * std::sin(place_.latitude);
  const double faded = std::exp(-about.variance / 2);  // the mean over all azimuths
  const double c = faded * std::cos(azimuth), s = faded * std::sin(azimuth);
  const double cot = knot.cot / knot.seconds;
  const double white = Square(setup_.gyro.angle_random_walk);
  const double quantum = 2 * Square(setup_.gyro.quantization);
  // Against a noiseless setup: a turn of 1e-9 rad is beyond any gyro.
  constexpr double kFloor = 1e-18;
  // What the second order leaves out, (dA^2 / 2)^2 in the mean, is one error for the whole window.
  const double bent = 0.75 * Square(north * about.variance) * knot.seconds * about.seconds;
  StillMeasurements m;

  // 0 = turn + Earth - errors' share.
  m.turn.h = FilterVector::Zero(layout_.size);
  // An inclination that is off reads the Earth's rate as another; d_turn holds that by the measured
  // rate, whose noise is in the reading too, so that hundreds of knots would seem to tell of it.
  const double by_inclination = (cot * up - north * c) * knot.seconds + cot * knot.turn;
  Load(layout_, Knot::SourceVector(knot.d_turn + by_inclination * knot.d_inclination), -1,
       m.turn.h);
  m.turn.h[0] = -knot.cot * north * s;
  if (layout_.latitude >= 0) {
    m.turn.h[layout_.latitude] = -knot.cot * c * up + knot.seconds * north;
  }
  m.turn.value = -(knot.turn + knot.cot * north * c + knot.seconds * up) + m.turn.h[0] * azimuth;
  m.turn.variance = white * knot.white_turn + knot.toolface_noise_turn + quantum * (1 + cot * cot) +
                    kFloor + bent * Square(cot * c) + knot.var_unseen * (1 + cot * cot);

  // 0 = lift + W_e cos L sin A - errors' share: the inclination does not change.
  m.lift.h = FilterVector::Zero(layout_.size);
  Load(layout_, knot.d_lift, -1, m.lift.h);
  m.lift.h[0] = north * c * knot.seconds;
  if (layout_.latitude >= 0) m.lift.h[layout_.latitude] = -up * s * knot.seconds;
  m.lift.value = -(knot.lift + north * s * knot.seconds) + m.lift.h[0] * azimuth;
  m.lift.variance = white * knot.seconds + quantum + kFloor + bent * Square(s) + knot.var_unseen;
  return m;
}

FilterMeasurement FilterCore::OfAzimuth(double azimuth, double variance) const {
  FilterMeasurement m;
  m.h = FilterVector::Zero(layout_.size);
  m.h[0] = 1;
  m.value = azimuth;
  m.variance = variance;
  return m;
}

FilterMatrix FilterCore::shown_covariance() const {
  FilterMatrix shown = covariance_;
  shown(0, 0) = variance();
  return shown;
}

void FilterCore::Take(FilterMeasurement* m) {
  const double before = covariance_(0, 0);
  const FilterVector ph = covariance_ * m->h;
  m->innovation = m->value - m->h.dot(state_);
  m->innovation_variance = m->h.dot(ph) + m->variance;
  if (!(m->innovation_variance > 0)) {  // both certain already: nothing to learn
    m->gain = FilterVector::Zero(layout_.size);
    m->innovation_variance = 1;
    m->h.setZero();
    m->innovation = 0;
    return;
  }
  m->gain = ph / m->innovation_variance;
  state_ += m->gain * m->innovation;
  // Joseph's form, in two rank-one steps: stays positive when a diffuse azimuth becomes known.
  const FilterMatrix half = covariance_ - m->gain * ph.transpose();
  const FilterVector hh = half * m->h;
  covariance_ = half - hh * m->gain.transpose() + m->gain * m->variance * m->gain.transpose();
  covariance_ = ((covariance_ + covariance_.transpose()) / 2).eval();
  if (cross_.size() > 0) cross_ -= (cross_ * m->h) * m->gain.transpose();
  if (covariance_(0, 0) < std::min(kUnknownAngleVariance, kTellsOfAzimuth * before)) {
    diffuse_ = false;
  }
}

AttitudeRows RowsOf(const FilterLayout& layout, const Knot& knot, double gravity) {
  AttitudeRows rows = AttitudeRows::Zero(3, layout.size);
  Load(layout, knot.d_inclination, -1, rows.row(0));
  rows(1, 0) = 1;
  if (knot.axial) {
    Load(layout, knot.d_toolface, 1, rows.row(1));
    Load(layout, knot.d_toolface, -1, rows.row(2));
    return rows;
  }
  const double weight = gravity * std::max(std::sin(knot.inclination), 1e-6);
  Knot::SourceVector toolface = Knot::SourceVector::Zero();
  toolface[Knot::kToolfaceOffset] = 1;
  toolface[Knot::kTimeSkew] = knot.seconds > 0 ? knot.roll / knot.seconds : 0;
  toolface[Knot::kAccelBiasX] = -std::sin(knot.toolface) / weight;
  toolface[Knot::kAccelBiasY] = -std::cos(knot.toolface) / weight;
  Load(layout, toolface, -1, rows.row(2));
  return rows;
}

AttitudeSample AttitudeOf(const Knot& knot, const Eigen::Vector3d& estimate,
                          const Eigen::Matrix3d& cov, const NoiseCoefficients& gyro) {
  AttitudeSample a;
  a.time = knot.time;
  a.inclination = knot.inclination + estimate[0];
  a.azimuth = WrapTwoPi(estimate[1]);
  a.toolface = WrapPi(knot.toolface + estimate[2]);
  // Of the sum, where that is held: near vertical the azimuth itself comes and goes with the noise.
  const double held = knot.axial ? cov(1, 1) + cov(2, 2) + 2 * cov(1, 2) : cov(1, 1);
  a.azimuth_known = held < kUnknownAngleVariance;
  a.quality = knot.quality;
  if (knot.vertical) a.quality |= Quality::kVertical;
  if (a.inclination < 0) {
    a.inclination = -a.inclination;
    a.azimuth = WrapTwoPi(a.azimuth + kPi);
    a.toolface = WrapPi(a.toolface - kPi);
  }

  const double sine2 = std::max(Square(std::sin(knot.inclination)), 1e-12);
  const double noise = Square(knot.sigma_inclination);
  a.cov_attitude = cov;
  a.cov_attitude(0, 0) += noise;
  a.cov_attitude(1, 1) += Square(gyro.quantization) / sine2;
  if (knot.axial) {
    const double beyond = knot.var_azimuth_beyond;
    a.cov_attitude(1, 1) = std::max(cov(1, 1) + beyond, cov(1, 1) / 16);
    a.cov_attitude(2, 2) += knot.var_toolface;
    a.cov_attitude(1, 2) -= std::clamp(beyond, 0.0, knot.var_toolface);
    a.cov_attitude(2, 1) = a.cov_attitude(1, 2);
  } else {
    a.cov_attitude(2, 2) += std::max(noise / sine2, knot.var_toolface);
  }
  CapAtUnknown(&a.cov_attitude);
  return a;
}

// How long the noise of the inclination lasts: the tracker's observer, two time constants w of 20
// s, makes exp(-w t) (1 - 0.6 w t) of white noise, whose integral is that of exp(-t / 8 s).
constexpr double kLeanSeconds = 8;

StationState StationOf(std::size_t epoch, const Knot& knot, const AttitudeSample& attitude,
                       const AttitudeRows& rows, const FilterMatrix& cov, const FilterMatrix& cross,
                       const NoiseCoefficients& gyro) {
  StationState station;
  station.epoch = epoch;
  station.attitude = attitude;
  station.along = knot.along;
  station.cov = cov;
  station.cov_with_previous = cross;
  station.angles = rows.topRows<2>();
  // An unknown azimuth is flat round the circle, however wide its variance in the algebra.
  if (cov(0, 0) > kUnknownAngleVariance) {
    station.angles(1, 0) *= std::sqrt(kUnknownAngleVariance / cov(0, 0));
  }
  const double sine2 = std::max(Square(std::sin(knot.inclination)), 1e-12);
  station.cov_white(0, 0) = Square(knot.sigma_inclination);
  station.lean_seconds = kLeanSeconds;
  station.cov_white(1, 1) = std::min(Square(gyro.quantization) / sine2, kUnknownAngleVariance);
  if (knot.axial) station.cov_white(1, 1) += std::max(0.0, knot.var_azimuth_beyond);
  return station;
}

double GrowthSince(const Knot& knot, const NorthFix& fix, double growth_of_knot) {
  if (!(knot.seconds > 0)) return 0;
  const double after = (knot.time - fix.end).seconds() / knot.seconds;
  return growth_of_knot * std::clamp(after, 0.0, 1.0);
}

}  // namespace wellgyro
