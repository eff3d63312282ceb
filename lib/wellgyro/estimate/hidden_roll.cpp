#include "wellgyro/estimate/hidden_roll.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "wellgyro/base/angle.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/estimate/roll_start.h"
#include "wellgyro/estimate/roll_window.h"
#include "wellgyro/math/median.h"
#include "wellgyro/math/square.h"

namespace wellgyro {
namespace {

using Complex = std::complex<double>;

// The grid: headings 2.8 deg apart, and rates up to 21 rpm by which a knot of a second passes whole
// steps of heading. With steps twice as large two of seven runs at 6 rpm end in another solution.
constexpr std::size_t kSteps = 128, kSpins = 91;
constexpr int kAtRest = kSpins / 2;
constexpr double kHeadingStep = kTwoPi / kSteps;  // [rad], [rad/s]
// 1-sigma of what the grid's model leaves out, over the horizontal Earth rate: headings between two
// steps, and bends of a few deg/h. Halved, seven runs come to the same solutions, doubled six.
constexpr double kLoose = 0.15;
// -ln of the likelihood of an outlier, 3^2 / 2: a reading off by more than three sigmas costs no
// more.
constexpr double kStranger = 4.5;
// Scale b of the Laplace prior exp(-|x| / b) of the rate's change x from knot to knot [rad/s]:
// where the tool starts or stops, and elsewhere, so that the path does not turn with a bend.
// Halved, or the first doubled, seven runs come to the same solutions; with twice the second one of
// them does not.
constexpr double kChangeStarting = 0.1, kChange = 0.02;
// The same of a knot's rate about its window's, which knows a bend by the forces [rad/s]. A window
// that a start crosses may be wrong: the cost of a knot ends at 1. Without this prior five of seven
// runs of wells that kick off end in another solution; at four times this three, at twice it none.
constexpr double kOffWindow = 0.2;
// Knots that are decided at once, and those behind them that are looked at before: a minute later
// the best paths have joined. It bounds the memory to 660 kSteps kSpins bytes, 8 MB.
constexpr std::size_t kPiece = 600, kAgain = 60;
constexpr std::size_t kLeast = 10;  // knots, as a window has
// Neighbours of a knot, a minute to either side, and of them that tell: the median of five is right
// with two wrong. What is below 0.3 of the Earth's horizontal rate has no direction beside the
// gyros' bias.
constexpr std::size_t kMinute = 60, kTelling = 5;
constexpr double kEarthsLeast = 0.3;
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

/// Error of the gyros across, fixed in the tool: `bias` + roll rate * `skew`.
struct Fixed {
  Complex bias, skew;
};

/// Least squares over the windows that find north, with the priors of both.
Fixed FixedIn(std::span<const RollWindow> windows, const EstimateSetup& setup, double earth) {
  const double noise = std::hypot(setup.gyro.angle_random_walk, kLoose * earth);
  const ErrorPriors& errors = setup.errors;
  Eigen::Matrix2d of_fixed =
      Eigen::Vector2d(InformationOfSteady(noise, errors.gyro_bias_sigma),
                      InformationOfSteady(noise, errors.gyro_misalignment_sigma))
          .asDiagonal();
  Eigen::Vector2cd read = Eigen::Vector2cd::Zero();
  for (const RollWindow& w : windows) {
    if (!w.finds_north) continue;
    const Eigen::Vector2d row(1, w.rate);
    of_fixed += row * row.transpose();
    read += row * w.steady;
  }
  const Eigen::Vector2cd found = of_fixed.cast<Complex>().ldlt().solve(read);
  return {found[0], found[1]};
}

bool Reads(const RunKnot& knot) { return knot.increment.level; }

/// The nearest to a knot; null: there is none.
const RollWindow* WindowAt(std::span<const RollWindow> windows, std::size_t knot) {
  if (windows.empty()) return nullptr;
  auto next = std::ranges::lower_bound(windows, knot, {}, &RollWindow::node);
  if (next == windows.end()) return &windows.back();
  if (next != windows.begin() && knot - (next - 1)->node < next->node - knot) --next;
  return &*next;
}

std::vector<RollWindow> WindowsOf(std::span<const RunKnot> knots, const EstimateSetup& setup) {
  std::vector<RollWindow> windows;
  for (std::size_t begin = 0, end = 0; begin < knots.size(); begin = std::max(end, begin + 1)) {
    for (end = begin; end < knots.size() && RollIsHidden(knots[end]) && Reads(knots[end]);) ++end;
    for (RollWindow w : RollWindowsOf(knots.subspan(begin, end - begin), setup)) {
      w.node += begin;
      windows.push_back(w);
    }
  }
  return windows;
}

/// A stretch of knots in a row whose heading gravity does not show, rests among them.
class Stretch {
 public:
  /// `first`: of the run, whose `windows` these are. `starts`: SpeedStarts() of these knots.
  /// Everything must outlive this object.
  Stretch(std::span<const RunKnot> knots, std::size_t first, const EstimateSetup& setup,
          std::span<const double> starts, std::span<const RollWindow> windows)
      : knots_(knots),
        setup_(setup),
        starts_(starts),
        earth_(kEarthRate * std::cos(setup.site.latitude)),
        fixed_(FixedIn(windows, setup, earth_)) {
    for (RollWindow w : windows) {
      if (w.node < first || w.node >= first + knots.size()) continue;
      w.node -= first;
      windows_.push_back(w);
    }
  }

  /// The rate of every knot.
  std::vector<std::size_t> Spins() {
    std::vector<std::size_t> spins(knots_.size());
    for (std::size_t begin = 0; begin < knots_.size(); begin += kPiece) {
      SolvePiece(begin, std::span(spins));
    }
    return spins;
  }

 private:
  /// Residual of a knot's reading less `bias`, for each half step of the heading in its middle,
  /// over sigma sqrt(2): its square is -ln of the likelihood. Twice around, so that no index wraps.
  struct Left {
    std::array<float, 4 * kSteps> x, y;
  };

  Left LeftOf(const RunKnot& knot, Complex bend_L, double per_sigma) const {
    const Increment& i = knot.increment;
    const Complex read = Complex(i.turn_M.x(), i.turn_M.y()) / i.seconds - fixed_.bias;
    Left left;
    for (std::size_t m = 0; m < 2 * kSteps; ++m) {
      const Complex seen =
          (earth_ + bend_L) * std::polar(1.0, -0.5 * kHeadingStep * static_cast<double>(m));
      const Complex off = (read - seen) * per_sigma;
      left.x[m] = left.x[m + 2 * kSteps] = static_cast<float>(off.real());
      left.y[m] = left.y[m + 2 * kSteps] = static_cast<float>(off.imag());
    }
    return left;
  }

  /// The rate may change before a knot: cost(i) <- min over j of cost(j) + |i - j| step / change,
  /// and the j (the distance transform of Felzenszwalb and Huttenlocher, 2012).
  void ChangeRates(double change, Grid<std::uint8_t>& from) {
    for (std::size_t spin = 0; spin < kSpins; ++spin) {
      from[spin].fill(static_cast<std::uint8_t>(spin));
    }
    const auto cost = static_cast<float>(kHeadingStep / change);
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

  /// A step of Viterbi's algorithm: the rate may change, each pair of rate and heading costs what
  /// the knot's reading says of it, and the headings turn by their rates.
  void Pass(std::size_t k, Grid<std::uint8_t>& from) {
    const RunKnot& knot = knots_[k];
    const double seconds = knot.increment.seconds;
    const RollWindow* window = WindowAt(windows_, k);
    const double var = Square(setup_.gyro.angle_random_walk) / seconds + Square(kLoose * earth_);
    const double per_sigma = 1 / std::sqrt(2 * var);
    const Left left = LeftOf(knot, window != nullptr ? window->bend_L : Complex(), per_sigma);
    ChangeRates(starts_[k] > 0 ? kChangeStarting : kChange, from);
    float least = kBarred;
    for (std::size_t spin = 0; spin < kSpins; ++spin) {
      const double rate = SpinRate(spin);
      double apart = 0;
      if (window != nullptr) apart = std::min(std::abs(rate - window->rate) / kOffWindow, 1.0);
      float by_rate = static_cast<float>(apart);
      if (knot.still && rate != 0) by_rate = kBarred;
      const Complex skewed = fixed_.skew * rate * per_sigma;
      const auto skew_x = static_cast<float>(skewed.real());
      const auto skew_y = static_cast<float>(skewed.imag());
      const float stranger = Reads(knot) ? static_cast<float>(kStranger) : 0.0F;
      const long turned = StepsIn(spin, seconds);
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
  void SolvePiece(std::size_t begin, std::span<std::size_t> spins) {
    const std::size_t end = std::min(begin + kPiece, knots_.size());
    const std::size_t seen = std::min(end + kAgain, knots_.size());
    std::vector<Grid<std::uint8_t>> from(seen - begin);
    for (std::size_t k = begin; k < end; ++k) Pass(k, from[k - begin]);
    const Grid<float> costs = costs_;
    for (std::size_t k = end; k < seen; ++k) Pass(k, from[k - begin]);
    std::size_t spin = 0, heading = 0;
    for (std::size_t s = 0; s < kSpins; ++s) {
      const auto best = std::min_element(costs_[s].begin(), costs_[s].end());
      if (!(*best < costs_[spin][heading]) && s > 0) continue;
      spin = s;
      heading = static_cast<std::size_t>(best - costs_[s].begin());
    }
    for (std::size_t k = seen; k-- > begin;) {
      spins[k] = spin;
      const long steps = StepsIn(spin, knots_[k].increment.seconds);
      heading = Around(static_cast<long>(heading) - steps, kSteps);
      spin = from[k - begin][spin][heading];
    }
    costs_ = costs;
  }

  std::span<const RunKnot> knots_;
  const EstimateSetup& setup_;
  std::span<const double> starts_;
  double earth_;
  Fixed fixed_;
  std::vector<RollWindow> windows_;
  Grid<float> costs_{};
};

/// By the likeliest path.
std::vector<double> AlongPath(std::span<const RunKnot> knots, const EstimateSetup& setup,
                              std::span<const RollWindow> windows) {
  std::vector<double> hidden(knots.size(), 0);
  if (!AnyRollIsHidden(knots)) return hidden;
  const std::vector<double> starts = SpeedStarts(knots);
  const auto unseen = [&](std::size_t k) {
    return !knots[k].increment.roll_seen && knots[k].increment.seconds > 0;
  };
  for (std::size_t begin = 0, end = 0; begin < knots.size(); begin = std::max(end, begin + 1)) {
    for (end = begin; end < knots.size() && unseen(end);) ++end;
    const std::size_t size = end - begin;
    if (size < kLeast) continue;
    const std::vector<std::size_t> spins = Stretch(knots.subspan(begin, size), begin, setup,
                                                   std::span(starts).subspan(begin, size), windows)
                                               .Spins();
    for (std::size_t k = begin; k < end; ++k) {
      const Increment& i = knots[k].increment;
      if (knots[k].still) continue;
      const auto steps = static_cast<double>(StepsIn(spins[k - begin], i.seconds));
      hidden[k] = (steps * kHeadingStep - i.roll()) / i.seconds;
    }
  }
  return hidden;
}

/// By the rate of the nearest window.
std::vector<double> OfWindows(std::span<const RunKnot> knots, std::span<const RollWindow> windows) {
  std::vector<double> hidden(knots.size(), 0);
  for (std::size_t k = 0; k < knots.size() && !windows.empty(); ++k) {
    const Increment& i = knots[k].increment;
    if (!RollIsHidden(knots[k]) || !(i.seconds > 0)) continue;
    hidden[k] = WindowAt(windows, k)->rate - i.roll() / i.seconds;
  }
  return hidden;
}

/// Roll rate by how the gyros' reading turns from one knot's middle to the next one's [rad/s].
double RateBetween(const Increment& a, const Increment& b) {
  const Eigen::Vector2d &u = a.turn_M, &v = b.turn_M;
  const double turned = -std::atan2(v.y() * u.x() - v.x() * u.y(), v.dot(u));
  const double psi = a.roll_after + b.roll_before;
  return (psi + WrapPi(turned - psi)) / (0.5 * (a.seconds + b.seconds));
}

/// By the median rate between neighbours, from rest to rest or for a minute to either side.
std::vector<double> OfNeighbours(std::span<const RunKnot> knots, const EstimateSetup& setup) {
  const double least = kEarthsLeast * kEarthRate * std::cos(setup.site.latitude);
  const auto reads = [&](std::size_t k) {
    const Increment& i = knots[k].increment;
    return RollIsHidden(knots[k]) && i.turn_M.norm() > least * i.seconds;
  };
  std::vector<double> hidden(knots.size(), 0), near;
  for (std::size_t k = 0; k < knots.size(); ++k) {
    if (!RollIsHidden(knots[k])) continue;
    near.clear();
    std::size_t begin = k, end = k;
    while (begin > 0 && begin + kMinute > k && !knots[begin - 1].still) --begin;
    while (end + 1 < knots.size() && end < k + kMinute && !knots[end + 1].still) ++end;
    for (std::size_t j = begin; j < end; ++j) {
      if (!reads(j) || !reads(j + 1)) continue;
      near.push_back(RateBetween(knots[j].increment, knots[j + 1].increment));
    }
    if (near.size() < kTelling) continue;
    const Increment& i = knots[k].increment;
    hidden[k] = Median(near) - i.roll() / i.seconds;
  }
  return hidden;
}

}  // namespace

bool RollIsHidden(const RunKnot& knot) { return !knot.increment.roll_seen && !knot.still; }

bool AnyRollIsHidden(std::span<const RunKnot> knots) {
  return std::any_of(knots.begin(), knots.end(), RollIsHidden);
}

std::vector<double> HiddenRoll(std::span<const RunKnot> knots, const EstimateSetup& setup) {
  return AlongPath(knots, setup, WindowsOf(knots, setup));
}

std::vector<std::vector<double>> HiddenRolls(std::span<const RunKnot> knots,
                                             const EstimateSetup& setup) {
  const std::vector<RollWindow> windows = WindowsOf(knots, setup);
  std::vector<std::vector<double>> rolls = {AlongPath(knots, setup, windows)};
  if (!AnyRollIsHidden(knots)) return rolls;
  rolls.push_back(OfWindows(knots, windows));
  rolls.push_back(OfNeighbours(knots, setup));
  return rolls;
}

}  // namespace wellgyro
