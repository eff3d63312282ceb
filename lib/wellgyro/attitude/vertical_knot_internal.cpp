#include "wellgyro/attitude/vertical_knot_internal.h"

#include <algorithm>
#include <cmath>

#include "wellgyro/base/angle.h"
#include "wellgyro/earth/earth.h"

namespace wellgyro::vertical {
namespace {

constexpr double kLeastKept = 1;    // of an error of azimuth, by the Earth's rate
constexpr double kBack = 0.5;       // so much left of what a gap cost, the rest is given back,
constexpr double kWorthBack = 0.1;  // where it was so much of what is held
constexpr double kGivenBack = 0.8;  // of what was counted: less is held, the rest is given back
constexpr double kMemory = 10;      // of a rate in what the filter holds [s]

// With north unknown, what the filter counts from turns by all that the Earth's rate does to the
// azimuth: by so much its direction is off over what the filter remembers, [rad^2] over the knot.
double VarOfTurning(const Reference& reference, const Knot& knot) {
  const double sampled = knot.seconds - knot.gap_seconds;
  if (reference.azimuth || !(sampled > 0)) return 0;
  const double rate = reference.rate_across() * std::abs(knot.axial_cot) / sampled;
  const double off = std::min(rate * kMemory, 1.0);
  // Alike for as long as it takes to turn by a radian.
  return 2 * rate * sampled * off * off;
}

// What the azimuth grew by since the cut before, parted into what the Earth's rate did and the
// rest. An azimuth that is off turns that rate, all along the stretch as it was off at its begin:
// so far that has made the error grow by `kept`. Returns what an error grows by over this knot.
double FillTurn(const Leg& leg, const Uncertain& held, Knot* knot) {
  const std::complex<double> to_north = leg.reference.to_north();
  const std::complex<double> before = leg.before.in_sum.by_earth();
  const double across = leg.reference.rate_across();
  const double kept = std::max(1 - across * (to_north * before).imag(), kLeastKept);
  const std::complex<double> earth = (held.by_earth() - before) / kept;
  knot->axial_cot = std::polar(1.0, -leg.before.azimuth) * earth;
  knot->turn = WrapPi(leg.now.azimuth - leg.before.azimuth) -
               leg.reference.rate_up() * (knot->seconds - knot->gap_seconds) -
               across * (to_north * earth).real();
  return leg.heading_feeds_back ? -across * (to_north * earth).imag() : 0;
}

// What the sum's variance grew by is the knot's. What turns out not to have been lost is given
// back: as gravity shows behind a gap how the tool rolled in it, as more is learned of how it
// rolls, and where the stretch ends.
void Count(double held, double kept, bool axial, Counted* counted, Knot* knot) {
  Counted& c = *counted;
  c.var *= kept * kept;
  c.before_gap *= kept * kept;
  const bool gap = knot->gap_seconds > 0;
  if (gap && !c.in_gap) c.before_gap = c.var, c.since_gap = 0;
  c.in_gap = gap;
  knot->toolface_noise_turn = std::max(0.0, held - c.var);
  c.var += knot->toolface_noise_turn;
  const double of_gap = c.var - c.before_gap, left = std::max(held - c.before_gap, 0.0);
  const bool gap_counts = axial && c.since_gap > 0 && of_gap > kWorthBack * held;
  if (gap_counts && left < kBack * of_gap) {
    knot->axial_noise_share = left / of_gap;
    knot->axial_noise_knots = c.since_gap;
    c.var = c.before_gap + left;
  } else if (!gap_counts && held < (axial ? kGivenBack : 1) * c.var) {
    knot->axial_noise_share = held / c.var;
    knot->axial_noise_knots = c.knots;
    c.before_gap *= knot->axial_noise_share;
    c.var = held;
  }
  ++c.knots;
  if (c.since_gap >= 0) ++c.since_gap;
}

void FillLift(const Leg& leg, Knot* knot) {
  knot->lifts = leg.lift != nullptr;
  if (leg.lift) {
    knot->lift = leg.lift->lift;
    knot->d_lift = leg.lift->d_lift;
    knot->inclination_accel = leg.lift->inclination_accel;
    knot->level = leg.lift->level;
    knot->rolled = leg.lift->rolled;
    knot->rolled_toolface = leg.lift->rolled_toolface;
    return;
  }
  knot->inclination_accel = (leg.now.inclination + leg.before.inclination) / 2;
  knot->sigma_inclination_accel = knot->sigma_inclination;
  knot->lift = leg.now.inclination - leg.before.inclination;
  knot->d_lift = leg.now.in_inclination.by_sources() - leg.before.in_inclination.by_sources();
}

// What an axial knot says of the tool where it ends.
void FillEnd(const Leg& leg, double counted, Knot* knot) {
  const Cut& now = leg.now;
  knot->inclination = now.inclination;
  knot->d_inclination = now.in_inclination.by_sources();
  knot->sigma_inclination = std::sqrt(VarOf(now.in_inclination, leg.reference));
  knot->var_sum = now.in_sum.var;
  FillLift(leg, knot);
  knot->toolface = now.toolface;
  knot->d_toolface = now.in_toolface.by_sources();
  knot->var_toolface = VarOf(now.in_toolface, leg.reference);
  knot->var_azimuth_beyond =
      now.in_azimuth.var - counted + knot->var_toolface - now.in_toolface.var;
}

}  // namespace

Cut CutOf(const Core& core, const Eigen::Matrix3d& R_LT) {
  const Eigen::Matrix3d& R = R_LT;
  Cut c;
  c.azimuth = std::atan2(R(1, 2), R(0, 2));
  c.inclination = std::atan2(std::hypot(R(0, 2), R(1, 2)), R(2, 2));
  c.toolface = std::atan2(R(2, 1), -R(2, 0));
  const Eigen::Matrix3d slopes = EulerSlopes(R);
  const auto take = [&](const Eigen::RowVector3d& slope) {
    return Uncertain{slope * core.sources().topRows<3>(),
                     slope * core.cov_noise().topLeftCorner<3, 3>() * slope.transpose()};
  };
  c.in_inclination = take(slopes.row(0));
  c.in_azimuth = take(slopes.row(1));
  c.in_toolface = take(slopes.row(2));
  c.in_sum = take(SumSlope(R));
  return c;
}

Heading Reference::heading() const {
  if (!azimuth) return {};
  return {{std::cos(*azimuth), -std::sin(*azimuth)}, std::min(sigma, 1.0)};
}

double Reference::var_north() const { return azimuth ? std::min(sigma * sigma, 0.5) : 0.5; }

std::complex<double> Reference::to_north() const { return azimuth ? std::polar(1.0, *azimuth) : 0; }
double Reference::rate_across() const { return kEarthRate * std::cos(latitude); }
double Reference::rate_up() const { return kEarthRate * std::sin(latitude); }

double VarOf(const Uncertain& angle, const Reference& reference) {
  const double across = reference.rate_across();
  return angle.var + across * across * reference.var_north() * std::norm(angle.by_earth());
}

void FillKnot(const Leg& leg, Counted* counted, Knot* knot) {
  const Uncertain& held = leg.axial ? leg.now.in_sum : leg.now.in_azimuth;
  const double kept = 1 + FillTurn(leg, held, knot);
  knot->d_turn = held.by_sources() - kept * leg.before.in_sum.by_sources();
  knot->white_turn = 0;
  Count(held.var, kept, leg.axial, counted, knot);
  knot->toolface_noise_turn += VarOfTurning(leg.reference, *knot);
  knot->roll = WrapPi(leg.now.toolface - leg.before.toolface);
  knot->cot = 0;
  knot->axial = leg.axial;
  if (leg.axial) FillEnd(leg, counted->var, knot);
}

}  // namespace wellgyro::vertical
