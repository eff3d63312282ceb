#include <algorithm>
#include <cmath>

#include "wellgyro/attitude/level_noise.h"
#include "wellgyro/base/angle.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/fit/adjust_span_internal.h"

namespace wellgyro {
namespace {

constexpr double kBrokenVariance = 100;     // of the azimuth across a vertical stretch [rad^2]
constexpr double kVerticalVariance = 1e-2;  // of the inclination's growth there [rad^2]
constexpr double kVerticalLevel = 5e-4;     // of the accelerometers' inclination there [rad]
constexpr double kAxialTurn = 1e-5;         // of the turn there [rad]
constexpr double kAxialSeconds = 10;        // that an error of the inclination lasts there [s]
constexpr double kAxialLifts = 20;          // sigmas of the inclination there, of its growth
// Acceleration at which depth tells too late by half of it: see TrackerOptions.
constexpr double kAccelerationDoubt = 0.01;  // [m/s^2]
constexpr double kSmear = 2.5;               // of the depth track, and half a knot [s]
constexpr double kFloor = 1e-18;             // against a setup without noise [rad^2]
// Of an error of azimuth at a span's begin, by which the Earth's rate may make it grow: a span
// takes that for linear, and is shorter near vertical.
constexpr double kFeedsItself = 0.1;

double Square(double x) { return x * x; }

double Sinc(double x) { return std::abs(x) < 1e-4 ? 1 - x * x / 6 : std::sin(x) / x; }

// One epoch with what it needs of the one before.
struct Step {
  const Knot& knot;
  double sampled, speed, inclination;
};

Step StepAt(const FilterHistory& history, std::size_t i) {
  const Knot& knot = history.epochs[i].knot;
  const Knot* before = i > 0 ? &history.epochs[i - 1].knot : nullptr;
  double speed = 0;
  if (knot.along.known && knot.seconds > 0) {
    const bool two = before != nullptr && before->along.known;
    speed = two ? (knot.along.md - before->along.md) / knot.seconds : knot.along.speed;
  }
  const double inclination =
      before != nullptr ? (knot.inclination + before->inclination) / 2 : knot.inclination;
  return {knot, knot.seconds - knot.gap_seconds, speed, inclination};
}

// Sums that a span's means are made of.
struct Sums {
  double sampled = 0, level = 0, path = 0, turned = 0, white_turn = 0, jitter = 0;
  double sine_time = 0, cosine_time = 0;                // of the inclination
  double acceleration = 0;                              // the largest
  double unseen = 0, unseen_turn = 0, unseen_lift = 0;  // see Knot
  std::complex<double> rolled;
  VarBeyond beyond;
  Knot::SourceVector d_path = Knot::SourceVector::Zero();
  Knot::SourceVector d_level = Knot::SourceVector::Zero();  // of axial knots
  SourceForm second_path = SourceForm::Zero();
};

void AddEarth(const Step& s, const AdjustPlace& place, const Site& site, double begin, double grown,
              AdjustSpan* span) {
  const double north = kEarthRate * std::cos(place.latitude);
  const double up = kEarthRate * std::sin(place.latitude);
  const double radius = (site.radius_north + site.radius_east) / 2 + place.height - site.height;
  const double across = s.speed * std::sin(s.inclination) / radius;
  const std::complex<double> to =
      std::polar(Sinc(grown / 2), begin + grown / 2);  // mean direction from the span's begin
  const std::complex<double> i(0, 1);
  const double cot = s.sampled > 0 ? s.knot.cot / s.sampled : 0;
  const std::complex<double> turn = to * s.knot.cot + std::polar(1.0, begin) * s.knot.axial_cot;
  span->earth_turn += turn * north - to * i * s.sampled * across * std::tan(place.latitude);
  span->earth_lift += to * (s.sampled * north);
  span->up += s.sampled * up;
  span->carried += s.sampled * across;
  span->turn_by_latitude -= turn * up;
  span->lift_by_latitude -= to * (s.sampled * up);
  span->up_by_latitude += s.sampled * north;
  span->by_inclination -= to * (north * (1 + cot * cot) * s.sampled);
}

void AddKnot(const FilterHistory& history, const Step& s, const AdjustPlace& place,
             double acceleration, AdjustSpan* span, Sums* sums) {
  const Knot& knot = s.knot;
  const double grown = span->still ? 0 : place.grown;
  AddEarth(s, place, history.setup.site, sums->turned, grown, span);
  sums->turned += grown;
  sums->path += s.sampled * (span->lift + knot.lift / 2);
  sums->d_path += s.sampled * (span->d_lift + knot.d_lift / 2);
  sums->level += s.sampled * knot.inclination_accel;
  sums->sampled += s.sampled;
  sums->rolled += RolledOver(knot);
  if (!span->still) {
    const FilterSetup& setup = history.setup;
    const VarBeyond beyond =
        VarBeyondOf(knot, setup.errors, setup.site.gravity, kEarthRate * std::cos(place.latitude));
    sums->beyond.turn += beyond.turn;
    sums->beyond.lift += beyond.lift;
  }
  sums->white_turn += knot.white_turn;
  sums->jitter += knot.toolface_noise_turn;
  sums->sine_time += s.sampled * std::sin(s.inclination);
  sums->cosine_time += s.sampled * std::cos(s.inclination);
  sums->acceleration = std::max(sums->acceleration, acceleration);
  span->turn += knot.turn;
  if (span->still && knot.axial) span->still_turn -= knot.roll;
  span->lift += knot.lift;
  span->d_turn += knot.d_turn;
  span->d_lift += knot.d_lift;
  sums->d_level += s.sampled * (knot.d_inclination - knot.d_lift / 2);
  span->d_inclination +=
      s.sampled * knot.d_inclination.segment<3>(static_cast<int>(Knot::kAccelBiasX));
  if (knot.lifts) {
    span->d_azimuth += s.sampled * knot.d_toolface;
  }
  if (knot.lifts || history.setup.errors.time_skew_sigma > 0) {
    const SecondOrderShare second = SecondOrderOf(knot);
    sums->second_path += s.sampled * (span->second.lift + second.lift / 2);
    span->second.turn += second.turn;
    span->second.lift += second.lift;
    span->second_level += SecondLevelOf(knot);
    span->curved = true;
  }
  span->seconds += knot.seconds;
  if (knot.var_unseen > 0 && !knot.axial) {
    sums->unseen += knot.unseen;
    sums->unseen_lift += knot.var_unseen;
    sums->unseen_turn += knot.var_unseen / Square(std::max(std::sin(s.inclination), 1e-6));
  }
}

// Of the mean acceleration along the hole, by the depths at both ends of the span: taken out of the
// accelerometers at rest too.
double VarAcceleration(const FilterHistory& history, const AdjustSpan& span, double time) {
  const AlongHole& end = history.epochs[span.epoch_end - 1].knot.along;
  const std::size_t before = span.epoch_begin > 0 ? span.epoch_begin - 1 : span.epoch_begin;
  const AlongHole& begin = history.epochs[before].knot.along;
  return LevelNoise::MeanVariance(begin.known ? begin : end, end, time);
}

void FinishLevel(const FilterHistory& history, const Sums& sums, AdjustSpan* span) {
  const FilterSetup& setup = history.setup;
  const Knot& last = history.epochs[span->epoch_end - 1].knot;
  const double g = setup.site.gravity, time = sums.sampled;
  if (!(time > 0)) return;
  span->levelled = last.level && !(last.gap_seconds > 0);
  span->d_inclination /= time;
  const double sine = sums.sine_time / time, cosine = sums.cosine_time / time;
  span->level = sums.level / time;
  if (!span->still) {
    span->bow = sums.path / time - span->lift / 2;
    span->d_level = span->d_lift / 2 - sums.d_path / time;
  }
  if (span->axial && !span->lifts) {
    span->d_level += sums.d_level / time;
  } else {
    span->d_level += LevelSlopes(sums.rolled / time, sine, cosine, g);
  }

  double var = Square(setup.errors.accel_noise / g) / time +
               Square(sine / g) * VarAcceleration(history, *span, time) + kFloor;
  if (!span->still) {
    var += Square(setup.gyro.angle_random_walk) * time / 12;
    if (!last.along.known) var += Square(LevelNoise::kUnknownForce);
    var *= Square(1 + Square(sums.acceleration / kAccelerationDoubt));
    var += Square(sums.unseen) / 12;
  }
  if (span->curved) {
    span->second_level /= time;
    if (!span->still) span->second_level += span->second.lift / 2 - sums.second_path / time;
  }
  if (span->lifts) {
    span->d_azimuth /= time;
  } else if (span->axial) {
    // Knots that follow soon after each other share their error.
    const double alike = std::max(1.0, kAxialSeconds / span->seconds);
    var = std::max(var, Square(last.sigma_inclination_accel) * alike);
  } else if (span->vertical) {
    var += Square(kVerticalLevel);
  }
  span->var_level = var;
}

void Finish(const FilterHistory& history, const Sums& sums, AdjustSpan* span) {
  const FilterSetup& setup = history.setup;
  const Knot& last = history.epochs[span->epoch_end - 1].knot;
  const double walk2 = Square(setup.gyro.angle_random_walk);
  span->var_turn =
      walk2 * sums.white_turn + sums.jitter + sums.unseen_turn + sums.beyond.turn + kFloor;
  span->var_lift = walk2 * sums.sampled + sums.unseen_lift + sums.beyond.lift + kFloor;
  if (sums.sampled > 0) {
    const double noise = setup.errors.accel_noise / setup.site.gravity;
    span->var_lift += Square(noise * span->turn) / sums.sampled;
  }
  if (span->still && sums.sampled > 0) {  // of both ends; on the way it does not add up
    const double quantum = 2 * Square(setup.gyro.quantization);
    span->var_turn += quantum * sums.white_turn / sums.sampled;
    span->var_lift += quantum;
  }
  if (span->broken) {
    span->var_turn = kBrokenVariance;
    span->var_lift = kVerticalVariance;
  }
  FinishLevel(history, sums, span);
  if (!span->axial) return;
  // Where gravity shows more of the way than before, its noise gets no more.
  span->var_turn += Square(kAxialTurn);
  if (span->lifts && !span->broken) return;
  // Its lift is how much more the tool leans by then: the levels once more, which only keeps them
  // from going up and down in turn. Taken in earnest, a bias of the gyros that bends it passes for
  // one of the accelerometers.
  span->var_lift = Square(kAxialLifts * last.sigma_inclination) + kFloor;
  span->earth_lift = span->lift_by_latitude = 0;
  span->carried = 0;
}

// The largest of each knot and those near it: a change of speed is smeared over so long.
std::vector<double> AccelerationsAbout(const FilterHistory& history) {
  const auto& epochs = history.epochs;
  std::vector<double> largest(epochs.size(), 0);
  std::size_t begin = 0, end = 0;
  for (std::size_t i = 0; i < epochs.size(); ++i) {
    const ToolTime time = epochs[i].knot.time;
    const double length = epochs[i].knot.seconds;
    while ((time - epochs[begin].knot.time).seconds() > kSmear + length) ++begin;
    while (end < epochs.size() && (epochs[end].knot.time - time).seconds() <= kSmear) ++end;
    for (std::size_t j = begin; j < end; ++j) {
      largest[i] = std::max(largest[i], std::abs(epochs[j].knot.along.acceleration));
    }
  }
  return largest;
}

bool Used(const FilterFix& f) { return f.use == FixUse::kUsed || f.use == FixUse::kMirror; }

// The longest span of knots like this one.
double LongestWith(const Knot& knot, double latitude) {
  const double sampled = knot.seconds - knot.gap_seconds;
  if (!knot.axial || !(sampled > 0)) return HUGE_VAL;
  const double rate = kEarthRate * std::cos(latitude) * std::abs(knot.axial_cot) / sampled;
  return rate > 0 ? kFeedsItself / rate : HUGE_VAL;
}

bool Lone(const Knot& knot) {
  return knot.gap_seconds > 0 || Has(knot.quality, Quality::kSaturated);
}

}  // namespace

std::vector<AdjustPlace> PlacesAlong(const FilterHistory& history,
                                     const std::vector<double>& azimuth) {
  const Site& site = history.setup.site;
  std::vector<AdjustPlace> places;
  places.reserve(history.epochs.size());
  AdjustPlace place{site.latitude, site.height};
  for (std::size_t i = 0; i < history.epochs.size(); ++i) {
    const Step s = StepAt(history, i);
    // A span's share of the Earth turns with the azimuth, near vertical much by that share itself.
    place.grown = !azimuth.empty()
                      ? (i > 0 ? azimuth[i] - azimuth[i - 1] : s.knot.turn)
                      : s.knot.turn + s.sampled * kEarthRate * std::sin(place.latitude);
    places.push_back(place);
    if (azimuth.empty()) continue;
    const double way = s.speed * s.knot.seconds;
    place.latitude += way * std::sin(s.inclination) * std::cos(azimuth[i]) /
                      (site.radius_north + place.height - site.height);
    place.height -= way * std::cos(s.inclination);
  }
  return places;
}

std::vector<AdjustSpan> SpansOf(const FilterHistory& history,
                                const std::vector<AdjustPlace>& places,
                                const SpanOptions& options) {
  const auto& epochs = history.epochs;
  std::vector<bool> ends(epochs.size(), false);
  for (const FilterFix& f : history.fixes) {
    if (Used(f) && !f.rates && f.epoch_end > 0) ends[f.epoch_end - 1] = true;
  }
  const std::vector<double> accelerations = AccelerationsAbout(history);
  const auto lost = [&](std::size_t i) { return !options.lost.empty() && options.lost[i]; };
  std::vector<AdjustSpan> spans;
  Sums sums;
  bool open = false;
  for (std::size_t i = 0; i < epochs.size(); ++i) {
    const Knot& knot = epochs[i].knot;
    if (!(knot.seconds > 0)) continue;
    if (!open) {
      spans.emplace_back();
      spans.back().epoch_begin = i;
      spans.back().still = knot.still;
      sums = {};
    }
    AdjustSpan& span = spans.back();
    span.vertical = knot.vertical || knot.axial;
    span.axial = knot.axial && !knot.vertical;
    span.lifts = span.axial && knot.lifts;
    span.broken = (knot.vertical || lost(i)) && !knot.still;
    AddKnot(history, StepAt(history, i), places[i], accelerations[i], &span, &sums);
    span.epoch_end = i + 1;
    const bool last = i + 1 == epochs.size();
    const Knot* next = last ? nullptr : &epochs[i + 1].knot;
    open = !last && !ends[i] && !(epochs[i].station && options.at_stations) && !Lone(knot) &&
           !Lone(*next) && next->still == knot.still && next->vertical == knot.vertical &&
           next->axial == knot.axial && next->lifts == knot.lifts && lost(i + 1) == lost(i) &&
           span.seconds + next->seconds <=
               std::min(options.seconds, LongestWith(*next, places[i].latitude)) * (1 + 1e-9);
    if (!open) Finish(history, sums, &span);
  }
  return spans;
}

}  // namespace wellgyro
