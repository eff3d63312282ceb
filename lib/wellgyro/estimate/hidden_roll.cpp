#include "wellgyro/estimate/hidden_roll.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "wellgyro/base/angle.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/estimate/knot_terms.h"
#include "wellgyro/estimate/places.h"
#include "wellgyro/estimate/roll_path.h"
#include "wellgyro/estimate/roll_start.h"
#include "wellgyro/estimate/roll_window.h"
#include "wellgyro/math/median.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/math/square.h"

namespace wellgyro {
namespace {

using Complex = std::complex<double>;
using Eigen::Matrix3d;
using Eigen::Vector3d;

// 1-sigma of what the model of HiddenRoll() leaves out, over the horizontal Earth rate: headings
// between two steps of the grid, and bends of a few deg/h. Halved, seven runs come to the same
// solutions, doubled six.
constexpr double kLoose = 0.15;
// Its scales of the rate's change from knot to knot [rad/s]: elsewhere, so that the path does not
// turn with a bend, and where the tool starts or stops. Halved, or the second doubled, seven runs
// come to the same solutions; with twice the first one of them does not.
constexpr double kRateChange = 0.02, kRateChangeStarting = 0.1;
// The same of RollAbout(), whose bends are known: uniform within a step of 2.8 deg a heading has a
// sigma of 0.014, and a bend of 1 deg/30 m at 1 m/s that is known to 1 % is off by as much.
constexpr double kLooseAbout = 0.04;
// A swing by 20 deg in 10 s changes its rate by up to 0.14 rad/s in a second.
constexpr double kRateChangeAbout = 0.2, kRateChangeStartingAbout = 0.5;
constexpr std::size_t kLeast = 10;  // knots, as a window has
// Neighbours of a knot, a minute to either side, and of them that tell: the median of five is right
// with two wrong. What is below 0.3 of the Earth's horizontal rate has no direction beside the
// gyros' bias.
constexpr std::size_t kMinute = 60, kTelling = 5;
constexpr double kEarthsLeast = 0.3;

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

/// Windows within knots [begin, end), counted from there.
std::vector<RollWindow> Within(std::span<const RollWindow> windows, std::size_t begin,
                               std::size_t end) {
  std::vector<RollWindow> within;
  for (RollWindow w : windows) {
    if (w.node < begin || w.node >= end) continue;
    w.node -= begin;
    within.push_back(w);
  }
  return within;
}

/// Calls `take(begin, end)` for every stretch of knots in a row whose heading gravity does not
/// show, rests among them.
template <typename Take>
void ForEachStretch(std::span<const RunKnot> knots, const Take& take) {
  const auto unseen = [&](std::size_t k) {
    return !knots[k].increment.roll_seen && knots[k].increment.seconds > 0;
  };
  for (std::size_t begin = 0, end = 0; begin < knots.size(); begin = std::max(end, begin + 1)) {
    for (end = begin; end < knots.size() && unseen(end);) ++end;
    if (end - begin >= kLeast) take(begin, end);
  }
}

/// The reading of knot k, without what is read.
RollReading ReadingOf(const RunKnot& knot, double speed_start) {
  RollReading reading;
  reading.seconds = knot.increment.seconds;
  reading.tells = Reads(knot);
  reading.still = knot.still;
  reading.may_start = speed_start > 0;
  return reading;
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

/// A solution as the grid reads it.
class Solved {
 public:
  Solved(const EstimateSetup& setup, std::span<const RunKnot> knots, const RunState* before,
         std::span<const Node> nodes, const BorderVector& border)
      : setup_(setup),
        layout_(LayoutOf(setup)),
        known_(KnownErrors(setup)),
        knots_(knots),
        nodes_(nodes),
        border_(border) {
    PlaceKnots(setup.site, before, knots, nodes, places_);
  }

  /// Heading of node k, a turn about the vertical [rad].
  double HeadingAt(std::size_t k) const { return AngleAboutZ(nodes_[k].R_LT); }

  /// Sets what knot k reads and what it would at heading zero. Returns the skew of the gyros.
  Complex Read(std::size_t k, RollReading& reading) const {
    const KnotTerms t = TermsOf({setup_, layout_, known_}, knots_[k], places_[k], border_,
                                nodes_[k], nodes_[k + 1]);
    const Vector3d bend_L = nodes_[k].tangent_L().cross(nodes_[k + 1].tangent_L()) / t.dt;
    const Vector3d rate_M = t.R_LM.transpose() * (t.w_IL_L + bend_L);
    const Complex skew(t.error[kMisalignmentX], t.error[kMisalignmentY]);
    const double rate = (t.inc.roll() + t.delta) / t.dt;
    reading.read = Complex(t.turn.x(), t.turn.y()) / t.dt + rate * skew;
    reading.at_zero = Complex(rate_M.x(), rate_M.y()) * std::polar(1.0, AngleAboutZ(t.R_LM));
    return skew;
  }

 private:
  const EstimateSetup& setup_;
  Layout layout_;
  ErrorVector known_;
  std::span<const RunKnot> knots_;
  std::span<const Node> nodes_;
  const BorderVector& border_;
  std::vector<KnotPlace> places_;
};

}  // namespace

bool RollIsHidden(const RunKnot& knot) { return !knot.increment.roll_seen && !knot.still; }

bool AnyRollIsHidden(std::span<const RunKnot> knots) {
  return std::any_of(knots.begin(), knots.end(), RollIsHidden);
}

std::vector<double> HiddenRoll(std::span<const RunKnot> knots, const EstimateSetup& setup) {
  std::vector<double> hidden(knots.size(), 0);
  if (!AnyRollIsHidden(knots)) return hidden;
  const std::vector<double> starts = SpeedStarts(knots);
  const std::vector<RollWindow> all = WindowsOf(knots, setup);
  const double earth = kEarthRate * std::cos(setup.site.latitude);
  const Fixed fixed = FixedIn(all, setup, earth);
  const RollModel model{.skew = fixed.skew,
                        .gyro_noise = setup.gyro.angle_random_walk,
                        .model_sigma = kLoose * earth,
                        .rate_change = kRateChange,
                        .rate_change_started = kRateChangeStarting};
  ForEachStretch(knots, [&](std::size_t begin, std::size_t end) {
    const std::vector<RollWindow> windows = Within(all, begin, end);
    std::vector<RollReading> readings;
    for (std::size_t k = begin; k < end; ++k) {
      const Increment& i = knots[k].increment;
      const RollWindow* window = WindowAt(windows, k - begin);
      RollReading& reading = readings.emplace_back(ReadingOf(knots[k], starts[k]));
      reading.read = Complex(i.turn_M.x(), i.turn_M.y()) / i.seconds - fixed.bias;
      reading.at_zero = earth + (window != nullptr ? window->bend_L : Complex());
      if (window != nullptr) reading.expected_rate = window->rate;
    }
    const RollPath path = LikeliestRoll(readings, model);
    for (std::size_t k = begin; k < end; ++k) {
      const Increment& i = knots[k].increment;
      if (!knots[k].still) hidden[k] = (path.turns[k - begin] - i.roll()) / i.seconds;
    }
  });
  return hidden;
}

std::vector<std::vector<double>> HiddenRolls(std::span<const RunKnot> knots,
                                             const EstimateSetup& setup) {
  std::vector<std::vector<double>> rolls = {HiddenRoll(knots, setup)};
  if (AnyRollIsHidden(knots)) rolls.push_back(OfNeighbours(knots, setup));
  return rolls;
}

NodeGuess RollAbout(const EstimateSetup& setup, std::span<const RunKnot> knots,
                    const RunState* before, std::span<const Node> nodes,
                    const BorderVector& border) {
  const Solved solved(setup, knots, before, nodes, border);
  NodeGuess guess;
  for (const Node& node : nodes) guess.push_back({node.R_LT, node.roll_rate, node.md, node.speed});
  const std::vector<double> starts = SpeedStarts(knots);
  RollModel model{.gyro_noise = setup.gyro.angle_random_walk,
                  .model_sigma = kLooseAbout * kEarthRate * std::cos(setup.site.latitude),
                  .rate_change = kRateChangeAbout,
                  .rate_change_started = kRateChangeStartingAbout};
  ForEachStretch(knots, [&](std::size_t begin, std::size_t end) {
    std::vector<RollReading> readings;
    for (std::size_t k = begin; k < end; ++k) {
      readings.push_back(ReadingOf(knots[k], starts[k]));
      model.skew = solved.Read(k, readings.back());
    }
    const RollPath path = LikeliestRoll(readings, model);
    for (std::size_t k = begin; k < end; ++k) {
      Node& node = guess[k];
      node.R_LT = node.R_LT * RotationZ(path.headings[k - begin] - solved.HeadingAt(k));
      node.roll_rate = path.turns[k - begin] / knots[k].increment.seconds;
    }
  });
  return guess;
}

}  // namespace wellgyro
