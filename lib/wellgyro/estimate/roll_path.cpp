#include "wellgyro/estimate/roll_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/square.h"

namespace wellgyro {
namespace {

using Complex = std::complex<double>;

// The grid: headings 2.8 deg apart, and rates up to 21 rpm by which a knot of a second passes whole
// steps of heading. With steps twice as large two of seven runs at 6 rpm end in another solution.
constexpr std::size_t kSteps = 128, kSpins = 91;
constexpr int kAtRest = kSpins / 2;
constexpr double kHeadingStep = kTwoPi / kSteps;  // [rad], [rad/s]
// -ln of the likelihood of an outlier, 3^2 / 2: a reading off by more than three sigmas costs no
// more.
constexpr float kStranger = 4.5F;
// Scale of the prior of a knot's rate about the expected one [rad/s]. That one may be wrong, of a
// window that a start crosses: the cost of a knot ends at 1. Without this prior five of seven runs
// of wells that kick off end in another solution; at four times this three, at twice it none.
constexpr double kOffExpected = 0.2;
// Knots that are decided at once, and those behind them that are looked at before: a minute later
// the best paths have joined. It bounds the memory to 660 kSteps kSpins bytes, 8 MB.
constexpr std::size_t kPiece = 600, kAgain = 60;
constexpr float kBarred = 1e9F;  // cost of what is not, as a tool at rest that turns

/// A value for every rate (rows) and heading at the begin of a knot (columns).
template <typename T>
using Grid = std::array<std::array<T, kSteps>, kSpins>;

double SpinRate(std::size_t spin) { return (static_cast<int>(spin) - kAtRest) * kHeadingStep; }

/// Steps of heading in a knot.
long StepsIn(std::size_t spin, double seconds) {
  return std::lround(SpinRate(spin) * seconds / kHeadingStep);
}

/// `steps` modulo `circle`, not negative.
std::size_t Around(long steps, std::size_t circle) {
  const auto turn = static_cast<long>(circle);
  return static_cast<std::size_t>((steps % turn + turn) % turn);
}

/// Residual of a reading for each half step of the heading in the knot's middle, over sigma
/// sqrt(2): its square is -ln of the likelihood. Twice around, so that no index wraps.
struct Residuals {
  std::array<float, 4 * kSteps> x, y;
};

Residuals ResidualsOf(const RollReading& reading, double per_sigma) {
  Residuals left;
  for (std::size_t m = 0; m < 2 * kSteps; ++m) {
    const Complex seen =
        reading.at_zero * std::polar(1.0, -0.5 * kHeadingStep * static_cast<double>(m));
    const Complex off = (reading.read - seen) * per_sigma;
    left.x[m] = left.x[m + 2 * kSteps] = static_cast<float>(off.real());
    left.y[m] = left.y[m + 2 * kSteps] = static_cast<float>(off.imag());
  }
  return left;
}

class PathSearch {
 public:
  /// Both must outlive this object.
  PathSearch(std::span<const RollReading> readings, const RollModel& model)
      : readings_(readings), model_(model) {}

  RollPath Run() {
    RollPath path;
    path.headings.resize(readings_.size());
    path.turns.resize(readings_.size());
    for (std::size_t begin = 0; begin < readings_.size(); begin += kPiece) SolvePiece(begin, path);
    return path;
  }

 private:
  /// The rate may change before a knot: cost(i) <- min over j of cost(j) + |i - j| step / scale,
  /// and the j (the distance transform of Felzenszwalb and Huttenlocher, 2012).
  void ChangeRates(double scale, Grid<std::uint8_t>& from) {
    for (std::size_t spin = 0; spin < kSpins; ++spin) {
      from[spin].fill(static_cast<std::uint8_t>(spin));
    }
    const auto cost = static_cast<float>(kHeadingStep / scale);
    const auto pass = [&](std::size_t to, std::size_t next) {
      for (std::size_t h = 0; h < kSteps; ++h) {
        const float moved = costs_[next][h] + cost;
        const bool less = moved < costs_[to][h];
        costs_[to][h] = less ? moved : costs_[to][h];
        from[to][h] = less ? from[next][h] : from[to][h];
      }
    };
    for (std::size_t spin = 1; spin < kSpins; ++spin) pass(spin, spin - 1);
    for (std::size_t spin = kSpins - 1; spin-- > 0;) pass(spin, spin + 1);
  }

  /// What a rate costs by itself in a knot.
  float CostOf(double rate, const RollReading& reading) const {
    if (reading.still && rate != 0) return kBarred;
    if (!reading.expected_rate) return 0;
    return static_cast<float>(
        std::min(std::abs(rate - *reading.expected_rate) / kOffExpected, 1.0));
  }

  /// A step of Viterbi's algorithm: the rate may change, each pair of rate and heading costs what
  /// the knot's reading says of it, and the headings turn by their rates.
  void Pass(const RollReading& reading, Grid<std::uint8_t>& from) {
    const double var = Square(model_.gyro_noise) / reading.seconds + Square(model_.model_sigma);
    const double per_sigma = 1 / std::sqrt(2 * var);
    const Residuals left = ResidualsOf(reading, per_sigma);
    const float stranger = reading.tells ? kStranger : 0.0F;
    ChangeRates(reading.may_start ? model_.rate_change_started : model_.rate_change, from);
    float least = kBarred;
    for (std::size_t spin = 0; spin < kSpins; ++spin) {
      const double rate = SpinRate(spin);
      const float by_rate = CostOf(rate, reading);
      const Complex skewed = model_.skew * rate * per_sigma;
      const auto skew_x = static_cast<float>(skewed.real());
      const auto skew_y = static_cast<float>(skewed.imag());
      const long turned = StepsIn(spin, reading.seconds);
      const std::size_t steps = Around(turned, kSteps), half_steps = Around(turned, 2 * kSteps);
      std::array<float, kSteps>& costs = costs_[spin];
      for (std::size_t h = 0; h < kSteps; ++h) {
        // The heading in the middle, in half steps: the begin's and half of the knot's turn.
        const std::size_t middle = 2 * h + half_steps;
        const float x = left.x[middle] - skew_x, y = left.y[middle] - skew_y;
        costs[h] += std::min(x * x + y * y, stranger) + by_rate;
      }
      least = std::min(least, *std::min_element(costs.begin(), costs.end()));
      std::rotate(costs.begin(), costs.end() - static_cast<std::ptrdiff_t>(steps), costs.end());
    }
    for (std::array<float, kSteps>& row : costs_) {
      for (float& cost : row) cost -= least;
    }
  }

  /// Knots from `begin` on, by what those before them and kAgain after them tell.
  void SolvePiece(std::size_t begin, RollPath& path) {
    const std::size_t end = std::min(begin + kPiece, readings_.size());
    const std::size_t seen = std::min(end + kAgain, readings_.size());
    std::vector<Grid<std::uint8_t>> from(seen - begin);
    for (std::size_t k = begin; k < end; ++k) Pass(readings_[k], from[k - begin]);
    const Grid<float> costs = costs_;
    for (std::size_t k = end; k < seen; ++k) Pass(readings_[k], from[k - begin]);
    std::size_t spin = 0, heading = 0;
    for (std::size_t s = 0; s < kSpins; ++s) {
      const auto best = std::min_element(costs_[s].begin(), costs_[s].end());
      if (!(*best < costs_[spin][heading]) && s > 0) continue;
      spin = s;
      heading = static_cast<std::size_t>(best - costs_[s].begin());
    }
    for (std::size_t k = seen; k-- > begin;) {
      const long steps = StepsIn(spin, readings_[k].seconds);
      heading = Around(static_cast<long>(heading) - steps, kSteps);
      path.headings[k] = static_cast<double>(heading) * kHeadingStep;
      path.turns[k] = static_cast<double>(steps) * kHeadingStep;
      spin = from[k - begin][spin][heading];
    }
    costs_ = costs;
  }

  std::span<const RollReading> readings_;
  const RollModel& model_;
  Grid<float> costs_{};
};

}  // namespace

RollPath LikeliestRoll(std::span<const RollReading> readings, const RollModel& model) {
  return PathSearch(readings, model).Run();
}

}  // namespace wellgyro
