#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>

#include "wellgyro/attitude/filter_core_internal.h"
#include "wellgyro/attitude/level_noise.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/record/knot_sources.h"

namespace wellgyro {
namespace {

// An error of azimuth that feeds itself faster than so is held by the inclination [1/s].
constexpr double kFeedsItself = 1e-3;
constexpr double kFollowVariance = 0.25;  // of an azimuth that its growth can hold [rad^2]
constexpr double kBentSeconds = 100;      // that an error of the second order stays alike [s]
constexpr double kLevelFloor = 1e-12;     // of a tool without noise: sums over seconds [rad^2]

double Square(double x) { return x * x; }

}  // namespace

// Whether over this knot the inclination is followed, and tells of the azimuth.
bool FilterCore::Follows(const Knot& knot) const {
  if (!(knot.seconds > 0) || knot.vertical || (knot.axial && !knot.lifts)) return false;
  const double horizontal = kEarthRate * std::cos(place_.latitude);
  const double feeds = horizontal * std::abs(std::cos(knot.inclination));
  return feeds > kFeedsItself * std::sin(knot.inclination) && !diffuse_ &&
         covariance_(0, 0) < kFollowVariance;
}

// The tool's errors as they stand.
Knot::SourceVector FilterCore::Errors() const {
  Knot::SourceVector errors = Knot::SourceVector::Zero();
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const auto& at = layout_.drift[axis];
    if (at.level >= 0) errors[BiasOf(axis)] += state_[at.level];
    if (at.markov >= 0) errors[BiasOf(axis)] += state_[at.markov];
  }
  for (int source = 0; source < Knot::kSources; ++source) {
    const int at = layout_.source[static_cast<std::size_t>(source)];
    if (at >= 0) errors[source] = state_[at];
  }
  return errors;
}

// The true growth is the measured one less the errors' share, with the Earth's by the azimuth.
FilterRise FilterCore::RiseOver(const Knot& knot, double azimuth_begin,
                                double azimuth_growth) const {
  FilterRise rise{FilterVector::Zero(layout_.size)};
  if (knot.still) return rise;
  const double sampled = knot.seconds - knot.gap_seconds;
  const double north = kEarthRate * std::cos(place_.latitude);
  const double middle = azimuth_begin + azimuth_growth / 2;
  const double slope = north * std::cos(middle) * sampled;
  const double radius =
      (setup_.site.radius_north + setup_.site.radius_east) / 2 + place_.height - setup_.site.height;
  const double carried = MeanSpeed(knot, place_) * std::sin(MeanInclination(knot, place_)) / radius;
  Knot::SourceVector d = -knot.d_lift;
  rise.offset = knot.lift + (north * std::sin(middle) + carried) * sampled - slope * azimuth_begin;
  if (knot.lifts) {
    const Knot::SourceVector errors = Errors();
    const SourceForm form = SecondOrderOf(knot).lift;
    d += slope * knot.d_toolface - (form + form.transpose()) * errors;
    rise.offset += errors.dot(form * errors);
  }
  Load(layout_, d, 1, rise.row);
  rise.row[0] = slope;
  if (layout_.latitude >= 0) {
    const double up = kEarthRate * std::sin(place_.latitude);
    rise.row[layout_.latitude] = -up * std::sin(middle) * sampled;
  }
  rise.white = Square(setup_.gyro.angle_random_walk) * sampled + knot.var_unseen +
               0.75 * Square(north * covariance_(0, 0)) * sampled * kBentSeconds +
               VarBeyondOf(knot, setup_.errors, setup_.site.gravity, north).lift;
  return rise;
}

void FilterCore::Rise(const Knot& knot, double azimuth_begin, FilterTransition* t) {
  const bool goes_on = follows_;
  follows_ = Follows(knot);
  rise_ = FilterRise{FilterVector::Zero(layout_.size)};
  t->rise = {FilterVector::Zero(layout_.size), knot.inclination, kNoInclination};
  if (!follows_) return;
  const double growth = t->row[0] * azimuth_begin + t->offset - azimuth_begin;
  rise_ = RiseOver(knot, azimuth_begin, knot.still ? 0 : growth);
  if (!goes_on) return;
  t->rise = rise_;
  t->rise.row[layout_.inclination] = 1;
}

std::optional<FilterMeasurement> FilterCore::Level(const Knot& knot) const {
  const double sampled = knot.seconds - knot.gap_seconds;
  if (!follows_ || !knot.level || !(sampled > 0)) return std::nullopt;
  const double g = setup_.site.gravity;
  const double sine = std::sin(knot.inclination), cosine = std::cos(knot.inclination);
  Knot::SourceVector d = LevelSlopes(RolledOver(knot) / sampled, sine, cosine, g);
  double second = 0;
  if (knot.lifts) {
    const Knot::SourceVector errors = Errors();
    const SourceForm form = SecondLevelOf(knot) / sampled;
    d += (form + form.transpose()) * errors;
    second = errors.dot(form * errors);
  }
  FilterMeasurement m;
  m.h = -0.5 * rise_.row;
  m.h[layout_.inclination] = 1;
  Load(layout_, d, 1, m.h);
  m.value = knot.inclination_accel + second + rise_.offset / 2;
  m.variance = Square(setup_.errors.accel_noise / g) / sampled +
               Square(sine / g) * LevelNoise::MeanVariance(knot.along, knot.along, sampled) +
               (knot.along.known ? 0 : Square(LevelNoise::kUnknownForce)) + kLevelFloor;
  return m;
}

}  // namespace wellgyro
