#include "wellgyro/estimate/roll_window.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "wellgyro/earth/earth.h"
#include "wellgyro/math/square.h"

namespace wellgyro {
namespace {

using Complex = std::complex<double>;
using Eigen::Vector2cd;
using Eigen::Vector4cd;

// Grid of the roll rate: to 21 rpm, by an eighth of the width 2 pi / 40 s of a window's line.
constexpr int kRates = 221, kMiddle = kRates / 2;
constexpr double kStep = 0.02;  // [rad/s]
// Parts of a step, in which the likeliest rate is sought again: 1/32 of one is 0.025 rad over a
// window.
constexpr int kFiner = 16;
// A line of the Earth's rate stands out of gyros of 0.05 deg/sqrt(h) by twenty sigmas.
constexpr std::size_t kWindow = 40, kStride = 10;  // [knots]
constexpr std::size_t kLeastWindow = 10;           // twenty readings for six unknowns
// Prior of a rate's change x from window to window: Laplace's exp(-|x| / kChange) with 0.1 rad/s,
// or a start or stop by any amount, which has one chance in exp(kJump) = 3000.
constexpr double kChange = 0.1, kJump = 8;
// Where a tool states no noise: 3e-6 deg/sqrt(h) [rad/sqrt(s)], a thousandth of a navigation
// gyro's, and 0.1 ug/sqrt(Hz) [m/s^2/sqrt(Hz)].
constexpr double kLeastGyroNoise = 1e-9, kLeastAccelNoise = 1e-6;
using Costs = std::array<double, kRates>;

double RateOf(std::size_t i) { return (static_cast<int>(i) - kMiddle) * kStep; }

/// Whether a rate across the tool can be the Earth's, by its ratio to what that is there: of a bend
/// that turns as much, at an angle b to it, the sum is 2 cos b/2, within 1/sqrt(2) and sqrt(2) for
/// b from 90 to 139 deg alone, one in four.
bool MayBeEarths(double ratio) { return ratio > 0.7 && ratio < 1.4; }

/// A window's likelihood, and the rates of Earth and bend in it, in the frame of the tool at its
/// middle node, beside what is fixed in the tool.
struct Line {
  double cost = 0;  ///< -ln, but for constants
  Complex earth, bend, steady;
};

/// Some knots in which the tool turns evenly. With lean l0 + l1 t + l2 t^2 in P, which follows the
/// axis and does not turn about it, and z = exp(-i rate t),
///   force / g:  z (l0 + l1 t + l2 t^2) + d,      rate across:  z (E + i (l1 + 2 l2 t)) + c,
/// where c and d are what the sensors read wrongly and steadily: bias, and skewness of axes.
class Window {
 public:
  Window(std::span<const RunKnot> knots, const EstimateSetup& setup) : setup_(setup) {
    const double gravity = setup.site.gravity;
    double t = 0;
    for (std::size_t k = 0; k < knots.size() / 2; ++k) t -= knots[k].increment.seconds;
    for (const RunKnot& knot : knots) {
      const Increment& i = knot.increment;
      times_.push_back(t + 0.5 * i.seconds);
      forces_.emplace_back(i.force_M.x() / gravity, i.force_M.y() / gravity);
      rates_.emplace_back(i.turn_M.x() / i.seconds, i.turn_M.y() / i.seconds);
      t += i.seconds;
      seconds_ += i.seconds;
    }
    size_ = static_cast<double>(knots.size());
    const double root = std::sqrt(seconds_ / size_);
    gyro_noise_ = std::max(setup.gyro.angle_random_walk, kLeastGyroNoise) / root;
    accel_noise_ = std::max(setup.errors.accel_noise, kLeastAccelNoise) / gravity / root;
  }

  /// By a bend that is even, or by one that grows where that explains more than its unknown can by
  /// chance (Schwarz, Estimating the dimension of a model, 1978).
  Line At(double rate) const {
    std::array<Complex, kWindow> turned;
    for (std::size_t k = 0; k < times_.size(); ++k) turned[k] = std::polar(1.0, -rate * times_[k]);
    const ForceSums sums = SumsAt(turned);
    const Line even = LineOf<3>(rate, turned, sums);
    Line grows = LineOf<4>(rate, turned, sums);
    grows.cost += std::log(2 * size_);
    return grows.cost < even.cost ? grows : even;
  }

  /// The likeliest rate within half a step of one.
  double Finer(double rate) const {
    double best = rate, least = HUGE_VAL;
    for (int i = -kFiner / 2; i <= kFiner / 2; ++i) {
      const double tried = rate + kStep * i / kFiner, cost = At(tried).cost;
      if (!(cost < least)) continue;
      least = cost;
      best = tried;
    }
    return best;
  }

 private:
  /// Normal equations of l0, l1, d and l2.
  struct ForceSums {
    Eigen::Matrix4cd normal = Eigen::Matrix4cd::Zero();
    Vector4cd right = Vector4cd::Zero();
    double squares = 0;
  };

  ForceSums SumsAt(std::span<const Complex> turned) const {
    ForceSums sums;
    for (std::size_t k = 0; k < times_.size(); ++k) {
      const Complex z = turned[k];
      const double t = times_[k];
      const Vector4cd row(z, z * t, 1, z * t * t);
      sums.normal += row.conjugate() * row.transpose();
      sums.right += row.conjugate() * forces_[k];
      sums.squares += std::norm(forces_[k]);
    }
    sums.normal(2, 2) +=
        InformationOfSteady(accel_noise_, setup_.errors.accel_bias_sigma / setup_.site.gravity);
    return sums;
  }

  /// Least squares of the lean, by so many unknowns, then of the Earth's rate with the bend that
  /// the lean has, each with its noise unknown but not below what is stated: -ln L = n ln(squares /
  /// n).
  template <int kUnknowns>
  Line LineOf(double rate, std::span<const Complex> turned, const ForceSums& sums) const {
    using Unknowns = Eigen::Matrix<Complex, kUnknowns, 1>;
    const Unknowns right = sums.right.template head<kUnknowns>();
    const Eigen::Matrix<Complex, kUnknowns, kUnknowns> normal =
        sums.normal.template topLeftCorner<kUnknowns, kUnknowns>();
    const Unknowns lean = normal.ldlt().solve(right);
    const double force_left = std::max(sums.squares - lean.dot(right).real(), 0.0);
    const Complex bend = Complex(0, 1) * lean[1];
    const Complex growth = kUnknowns > 3 ? Complex(0, 2) * lean[kUnknowns - 1] : Complex();
    Eigen::Matrix2cd of_rate = Eigen::Matrix2cd::Zero();
    Vector2cd turn = Vector2cd::Zero();
    double turn_left = 0;
    for (std::size_t k = 0; k < times_.size(); ++k) {
      const Complex left = rates_[k] - turned[k] * (bend + times_[k] * growth);
      const Vector2cd row(turned[k], 1);
      of_rate += row.conjugate() * row.transpose();
      turn += row.conjugate() * left;
      turn_left += std::norm(left);
    }
    const double steady =
        std::hypot(setup_.errors.gyro_bias_sigma, rate * setup_.errors.gyro_misalignment_sigma);
    of_rate(1, 1) += InformationOfSteady(gyro_noise_, steady);
    const Vector2cd found = of_rate.ldlt().solve(turn);
    turn_left = std::max(turn_left - found.dot(turn).real(), 0.0);
    return {size_ * (std::log(force_left / size_ + 2 * Square(accel_noise_)) +
                     std::log(turn_left / size_ + 2 * Square(gyro_noise_))),
            found[0], bend, found[1]};
  }

  const EstimateSetup& setup_;
  std::vector<double> times_;  ///< of the middles of knots, from the middle node on [s]
  std::vector<Complex> forces_, rates_;
  double size_ = 0, seconds_ = 0, gyro_noise_ = 0, accel_noise_ = 0;
};

/// cost(i) <- min of cost(j) + |i - j| kStep / kChange and cost(j) + kJump over j, and the j (the
/// distance transform of Felzenszwalb and Huttenlocher, 2012).
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

/// The rate of every window by the least cost of their whole sequence (Viterbi). Windows overlap:
/// each counts with the share that is new.
std::vector<double> RatesOf(std::span<const Window> windows, double share) {
  std::vector<std::array<std::int16_t, kRates>> from(windows.size());
  Costs least{};
  for (std::size_t w = 0; w < windows.size(); ++w) {
    LeastChange(least, from[w]);
    for (std::size_t i = 0; i < kRates; ++i) least[i] += share * windows[w].At(RateOf(i)).cost;
  }
  auto at = static_cast<std::size_t>(std::min_element(least.begin(), least.end()) - least.begin());
  std::vector<double> rates(windows.size());
  for (std::size_t w = windows.size(); w-- > 0;) {
    rates[w] = windows[w].Finer(RateOf(at));
    at = static_cast<std::size_t>(from[w][at]);
  }
  return rates;
}

}  // namespace

std::vector<RollWindow> RollWindowsOf(std::span<const RunKnot> knots, const EstimateSetup& setup) {
  if (knots.size() < kLeastWindow) return {};
  const std::size_t width = std::min(kWindow, knots.size());
  std::vector<std::size_t> begins;
  for (std::size_t b = 0; b + width < knots.size(); b += kStride) begins.push_back(b);
  begins.push_back(knots.size() - width);
  std::vector<Window> windows;
  for (const std::size_t b : begins) windows.emplace_back(knots.subspan(b, width), setup);
  const double share = static_cast<double>(kStride) / kWindow;
  const std::vector<double> rates = RatesOf(windows, share);
  const double earth = kEarthRate * std::cos(setup.site.latitude);
  std::vector<RollWindow> found;
  for (std::size_t w = 0; w < begins.size(); ++w) {
    const Line line = windows[w].At(rates[w]);
    const bool north = MayBeEarths(std::abs(line.earth) / earth);
    // A tool that has turned to the right sees north turned to the left.
    const Complex to_L = std::polar(1.0, -std::arg(line.earth));
    found.push_back({begins[w] + width / 2, rates[w], line.steady, north,
                     north ? line.bend * to_L : Complex()});
  }
  return found;
}

}  // namespace wellgyro
