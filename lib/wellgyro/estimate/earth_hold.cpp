#include "wellgyro/estimate/earth_hold.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <optional>

#include <Eigen/Cholesky>

#include "wellgyro/base/angle.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/estimate/hidden_roll.h"

namespace wellgyro {
namespace {

using Complex = std::complex<double>;
using Eigen::Matrix3cd;
using Eigen::Vector3cd;

// Knots that together tell the Earth's direction to 0.1 rad by gyros of 0.05 deg/sqrt(h).
constexpr std::size_t kWindow = 30;
// Within a window a drift of two radians leaves a third of the Earth's rate.
constexpr double kOfEarthLeft = 3;
// A drift that is taken out lets windows see the next one: by the third it is below 0.1 rad.
constexpr int kRounds = 3;
// Where a tool states no noise: a hundredth of a navigation gyro's, of a microgal's.
constexpr double kLeastGyroNoise = 1e-9, kLeastAccelNoise = 1e-6;

/// Weights of what the sensors read wrongly and steadily, per knot: noise over prior, squared.
struct SteadyErrors {
  double gyro = 0, accel = 0;
};

SteadyErrors SteadyErrorsOf(const EstimateSetup& setup, double most_rate) {
  const double gyro =
      std::hypot(setup.errors.gyro_bias_sigma, most_rate * setup.errors.gyro_misalignment_sigma);
  const double of_gyro = std::max(setup.gyro.angle_random_walk, kLeastGyroNoise) / gyro;
  const double of_accel =
      std::max(setup.errors.accel_noise, kLeastAccelNoise) / setup.errors.accel_bias_sigma;
  return {of_gyro * of_gyro, of_accel * of_accel};
}

/// The Earth's rate across, seen from P, which follows the axis and does not turn about it, by the
/// knots of a window with the angles of roll in their middles.
///
/// With the lean l = l0 + l1 t in P, a complex number, the axis turns at i l1 against L. Sensors
/// that roll in P by e^{i roll} read, turned back to it,
///   rate:  E + i l1 + c e^{i roll},      force / g:  l0 + l1 t + d e^{i roll},
/// c and d what they read wrongly and steadily: bias, and the skewness of axes times the roll rate.
std::optional<Complex> EarthAcross(std::span<const RunKnot> knots, std::span<const double> rolls,
                                   double gravity, const SteadyErrors& steady) {
  Matrix3cd normal = Matrix3cd::Zero();
  Vector3cd rate = Vector3cd::Zero(), force = Vector3cd::Zero();
  const double middle = 0.5 * static_cast<double>(knots.size() - 1);
  double seconds = 0;
  for (std::size_t k = 0; k < knots.size(); ++k) {
    const Increment& i = knots[k].increment;
    if (!i.level) return std::nullopt;
    const Complex turned = std::polar(1.0, rolls[k]);
    const Vector3cd row(1, static_cast<double>(k) / middle - 1, turned);
    normal += row.conjugate() * row.transpose();
    rate += row.conjugate() * turned * Complex(i.turn_M.x(), i.turn_M.y()) / i.seconds;
    force += row.conjugate() * turned * Complex(i.force_M.x(), i.force_M.y()) / gravity;
    seconds += i.seconds;
  }
  Matrix3cd of_force = normal;
  of_force(2, 2) += steady.accel;
  const double half = seconds * middle / static_cast<double>(knots.size());
  const Complex bend = Vector3cd(of_force.ldlt().solve(force))[1] / half;
  // The rate is steady: its slope is none of the unknowns.
  Eigen::Matrix2cd of_rate;
  of_rate << normal(0, 0), normal(0, 2), normal(2, 0), normal(2, 2) + steady.gyro;
  const Eigen::Vector2cd found = of_rate.ldlt().solve(Eigen::Vector2cd(rate[0], rate[2]));
  return found[0] - Complex(0, 1) * bend;
}

/// The roll, psi and what is hidden, in the middle of every knot [rad].
std::vector<double> RollsOf(std::span<const RunKnot> knots, const std::vector<double>& hidden) {
  std::vector<double> rolls;
  double roll = 0;
  for (std::size_t k = 0; k < knots.size(); ++k) {
    const Increment& i = knots[k].increment;
    const double half = 0.5 * hidden[k] * i.seconds;
    rolls.push_back(roll + i.roll_before + half);
    roll += i.roll_before + i.roll_after + 2 * half;
  }
  return rolls;
}

/// Spreads `angle` over the hidden knots from one to another.
void SpreadOver(double angle, std::span<const RunKnot> knots, std::size_t begin, std::size_t end,
                std::vector<double>& hidden) {
  double seconds = 0;
  for (std::size_t k = begin; k < end; ++k) {
    if (RollIsHidden(knots[k])) seconds += knots[k].increment.seconds;
  }
  for (std::size_t k = begin; k < end && seconds > 0; ++k) {
    if (RollIsHidden(knots[k])) hidden[k] += angle / seconds;
  }
}

/// The direction of the Earth's rate across that the window of knots from `begin` on tells.
std::optional<double> DirectionIn(std::size_t begin, std::span<const RunKnot> knots,
                                  const EstimateSetup& setup, const std::vector<double>& rolls,
                                  const std::vector<double>& hidden) {
  const auto window = knots.subspan(begin, kWindow);
  double most_rate = 0;
  for (std::size_t k = 0; k < kWindow; ++k) {
    most_rate = std::max(most_rate, std::abs(hidden[begin + k]));
  }
  const auto earth = EarthAcross(window, std::span(rolls).subspan(begin, kWindow),
                                 setup.site.gravity, SteadyErrorsOf(setup, most_rate));
  if (!earth) return std::nullopt;
  const double ratio = std::abs(*earth) / (kEarthRate * std::cos(setup.site.latitude));
  if (!(std::max(ratio, 1 / ratio) < kOfEarthLeft)) return std::nullopt;
  return std::arg(*earth);
}

/// psi follows gravity there: at larger inclinations, where P comes back turned.
bool FollowsGravity(const RunKnot& knot) { return !knot.still && !RollIsHidden(knot); }

}  // namespace

void HoldToEarth(std::span<const RunKnot> knots, const EstimateSetup& setup,
                 std::vector<double>& hidden) {
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<double> rolls = RollsOf(knots, hidden);
    bool told = false;
    double last = 0;
    std::size_t since = 0;  // middle of the window that told it
    for (std::size_t begin = 0; begin + kWindow <= knots.size(); begin += kWindow) {
      const auto window = knots.subspan(begin, kWindow);
      if (std::any_of(window.begin(), window.end(), FollowsGravity)) {
        told = false;
        continue;
      }
      const auto now = DirectionIn(begin, knots, setup, rolls, hidden);
      if (!now) continue;
      const std::size_t middle = begin + kWindow / 2;
      // A roll that is behind by an angle shows the Earth ahead by it.
      if (told) SpreadOver(WrapPi(last - *now), knots, since, middle, hidden);
      told = true;
      last = *now;
      since = middle;
    }
  }
}

}  // namespace wellgyro
