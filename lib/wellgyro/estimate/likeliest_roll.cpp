#include "wellgyro/estimate/likeliest_roll.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "wellgyro/base/angle.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/estimate/hidden_roll.h"
#include "wellgyro/math/square.h"

namespace wellgyro {
namespace {

// Rates of up to 20 rpm beyond psi's, by steps that a phase of 0.04 rad tells in a second.
constexpr int kRates = 221, kMiddle = kRates / 2;
constexpr double kStep = 0.02;  // [rad/s]
// A change of the rate is Laplace's, of 0.1 rad/s in a knot (a swing of 25 deg in 12 s), or a start
// or stop, which has one chance in 3000.
constexpr double kChange = 0.1, kJump = 8;
constexpr double kStray = 0.05;  // phases that tell nothing, where a bend begins or ends
constexpr double kReadable = 3;  // sigmas of gravity across, from which its phase is read
constexpr double kNot = 1e6;     // cost of what cannot be
using Costs = std::array<double, kRates>;

double RateOf(int i) { return (i - kMiddle) * kStep; }

/// An angle that is told modulo a turn, with its variance where the rate is `rate`.
struct Phase {
  double angle = 0, var = 0, var_by_rate2 = 0;

  double Var(double rate) const { return var + var_by_rate2 * rate * rate; }
  /// -ln of its density about `expected`, von Mises', less that of no knowledge.
  double Cost(double expected, double rate) const {
    const double kappa = 1 / Var(rate);
    // I0(kappa) e^-kappa within a fifth.
    const double density =
        std::sqrt(1 + kTwoPi * kappa) * std::exp(kappa * (std::cos(angle - expected) - 1));
    return -std::log((1 - kStray) * density + kStray);
  }
};

/// What a run's hidden knots say of the roll.
class Reader {
 public:
  explicit Reader(const EstimateSetup& setup)
      : gravity_(setup.site.gravity),
        earth_(kEarthRate),
        accel_noise_(setup.errors.accel_noise),
        accel_bias_(setup.errors.accel_bias_sigma),
        gyro_noise_(setup.gyro.angle_random_walk),
        gyro_bias_(setup.errors.gyro_bias_sigma),
        gyro_misalignment_(setup.errors.gyro_misalignment_sigma) {}

  /// From the middle of `a` to that of `b`, beyond psi: by gravity's phase, psi' = T' + A' cos I,
  /// A' sin I = -Re(W e^{iT}).
  std::optional<Phase> ByGravity(const Increment& a, const Increment& b) const {
    if (!a.level || !b.level) return std::nullopt;
    const double sine_a = Sine(a), sine_b = Sine(b), sine = std::min(sine_a, sine_b);
    const double noise = accel_noise_ / gravity_ / std::sqrt(std::min(a.seconds, b.seconds));
    const double sigma = std::hypot(noise, accel_bias_ / gravity_);
    if (!(sine > kReadable * sigma)) return std::nullopt;
    const double swept = 0.5 * (Swept(a) + Swept(b));
    const double turned = ToolfaceOf(b) - ToolfaceOf(a) + swept;
    const double of_earth = earth_ * 0.5 * (a.seconds + b.seconds);
    return Phase{turned - Psi(a, b), 2 * Square(sigma / sine) + Square(of_earth / sine), 0};
  }

  /// The same by the rate across.
  std::optional<Phase> ByRate(const Increment& a, const Increment& b) const {
    const Eigen::Vector2d &u = a.turn_M, &v = b.turn_M;
    const double turned = -std::atan2(v.y() * u.x() - v.x() * u.y(), v.dot(u));
    const double seconds = 0.5 * (a.seconds + b.seconds);
    const double size2 = Square(std::min(u.norm(), v.norm()));
    if (!(size2 > 0)) return std::nullopt;
    const double var = 2 * Square(gyro_noise_) * seconds + Square(gyro_bias_ * seconds);
    return Phase{turned - Psi(a, b), var / size2, Square(gyro_misalignment_ * seconds) / size2};
  }

 private:
  double Sine(const Increment& i) const { return i.force_M.head<2>().norm() / gravity_; }
  static double Psi(const Increment& a, const Increment& b) { return a.roll_after + b.roll_before; }
  static double ToolfaceOf(const Increment& i) { return std::atan2(-i.force_M.y(), i.force_M.x()); }
  /// What turning of the axis adds to the toolface's change over a knot.
  double Swept(const Increment& i) const {
    const Eigen::Vector2d across = i.force_M.head<2>() / gravity_;
    // Re(W conj(F)) with W e^{iT} = W conj(F)/|F|.
    return (i.turn_M.x() * across.x() + i.turn_M.y() * across.y()) / across.squaredNorm() *
           i.force_M.z() / gravity_;
  }

  double gravity_, earth_, accel_noise_, accel_bias_, gyro_noise_, gyro_bias_, gyro_misalignment_;
};

double SecondsBetween(const RunKnot& a, const RunKnot& b) {
  return 0.5 * (a.increment.seconds + b.increment.seconds);
}

/// The rate between the middles of two neighbours, of which `rate` is near enough to tell turns:
/// the weighted mean of what the phases say.
double ByPhases(const Reader& reader, const RunKnot& a, const RunKnot& b, double rate) {
  const double seconds = SecondsBetween(a, b), expected = rate * seconds;
  double sum = 0, weights = 0;
  for (const auto& phase :
       {reader.ByGravity(a.increment, b.increment), reader.ByRate(a.increment, b.increment)}) {
    if (!phase) continue;
    const double off = WrapPi(phase->angle - expected), var = phase->Var(rate);
    if (off * off > kReadable * kReadable * var) continue;
    sum += off / var;
    weights += 1 / var;
  }
  return weights > 0 ? rate + sum / weights / seconds : rate;
}

/// What two neighbours say of every rate between their middles.
Costs CostsOf(const Reader& reader, const RunKnot& a, const RunKnot& b) {
  Costs costs{};
  if (!RollIsHidden(a) && !RollIsHidden(b)) {
    costs.fill(kNot);
    costs[kMiddle] = 0;
    return costs;
  }
  const double seconds = SecondsBetween(a, b);
  for (const auto& phase :
       {reader.ByGravity(a.increment, b.increment), reader.ByRate(a.increment, b.increment)}) {
    if (!phase) continue;
    for (int i = 0; i < kRates; ++i) {
      costs[static_cast<std::size_t>(i)] += phase->Cost(RateOf(i) * seconds, RateOf(i));
    }
  }
  return costs;
}

/// The least of `costs` and a change from there, of every rate (the distance transform of
/// Felzenszwalb and Huttenlocher, 2012), and where it is.
void LeastChange(Costs& costs, std::array<std::int16_t, kRates>& from) {
  for (int i = 0; i < kRates; ++i) from[static_cast<std::size_t>(i)] = static_cast<std::int16_t>(i);
  const auto best = std::min_element(costs.begin(), costs.end());
  const double jump = *best + kJump;
  const auto jumped = static_cast<std::int16_t>(best - costs.begin());
  const auto pass = [&](std::size_t to, std::size_t next) {
    const double moved = costs[next] + kStep / kChange;
    if (!(moved < costs[to])) return;
    costs[to] = moved;
    from[to] = from[next];
  };
  for (std::size_t i = 1; i < kRates; ++i) pass(i, i - 1);
  for (std::size_t i = kRates - 1; i-- > 0;) pass(i, i + 1);
  for (std::size_t i = 0; i < kRates; ++i) {
    if (!(jump < costs[i])) continue;
    costs[i] = jump;
    from[i] = jumped;
  }
}

}  // namespace

std::vector<double> LikeliestRoll(std::span<const RunKnot> knots, const EstimateSetup& setup,
                                  bool by_phases) {
  std::vector<double> hidden(knots.size(), 0);
  if (!AnyRollIsHidden(knots) || knots.size() < 2) return hidden;
  const Reader reader(setup);
  std::vector<std::array<std::int16_t, kRates>> from(knots.size() - 1);
  Costs least{};
  for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
    LeastChange(least, from[k]);
    const Costs costs = CostsOf(reader, knots[k], knots[k + 1]);
    for (std::size_t i = 0; i < kRates; ++i) least[i] += costs[i];
  }
  auto at = static_cast<std::size_t>(std::min_element(least.begin(), least.end()) - least.begin());
  for (std::size_t k = knots.size() - 1; k-- > 0;) {
    // Between the middles of k and k + 1: half of it is in either.
    double rate = RateOf(static_cast<int>(at));
    if (by_phases) rate = ByPhases(reader, knots[k], knots[k + 1], rate);
    const double half = 0.5 * rate;
    if (RollIsHidden(knots[k])) hidden[k] += half;
    if (RollIsHidden(knots[k + 1])) hidden[k + 1] += half;
    at = static_cast<std::size_t>(from[k][at]);
  }
  if (RollIsHidden(knots.front())) hidden.front() *= 2;
  if (RollIsHidden(knots.back())) hidden.back() *= 2;
  return hidden;
}

}  // namespace wellgyro
