#include "wellgyro/estimate/roll_start.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/median.h"

namespace wellgyro {
namespace {

// Sigmas of the usual change, P(|x| > 3.5) = 4.7e-4: of an even roll five places in an hour are
// taken for starts. At 1.75 the sigmas of a well that kicks off grow by 5 %; at 7 they stay.
constexpr double kBeyond = 3.5;
constexpr std::size_t kSpans[] = {1, 4, 12};  // knots: a jerk, a start, a slow start of a slow roll

// A winch or a pipe comes to its speed within some seconds: at 2.5 s the end of a well that kicks
// off moves by 0.02 sigma, at 10 s by 0.18. Half or twice the least change moves it by 0.002.
constexpr double kSpeedReach = 5;      // [s]
constexpr double kLeastChange = 0.05;  // [m/s]

// Of a tool whose roll is nowhere seen, where the search by decades begins [rad/s/sqrt(s)]: a tenth
// of kRollWalkMost, so that it may go up too.
constexpr double kWalkUnseen = 1e-2;

/// Running sums of the roll, its variance, time, and knots that do not show it.
struct Sums {
  std::vector<double> roll{0}, var{0}, seconds{0};
  std::vector<std::size_t> unseen{0};

  explicit Sums(std::span<const RunKnot> knots, std::span<const double> swung = {}) {
    for (std::vector<double>* sums : {&roll, &var, &seconds}) sums->reserve(knots.size() + 1);
    unseen.reserve(knots.size() + 1);
    for (std::size_t k = 0; k < knots.size(); ++k) {
      const Increment& i = knots[k].increment;
      roll.push_back(roll.back() + i.roll_before + i.roll_after - (swung.empty() ? 0 : swung[k]));
      var.push_back(var.back() + (i.roll_seen ? i.sigma_roll * i.sigma_roll : 0));
      seconds.push_back(seconds.back() + i.seconds);
      unseen.push_back(unseen.back() + (i.roll_seen ? 0 : 1));
    }
  }
};

struct Change {
  std::size_t knot;
  double rate, sigma;
};

std::vector<Change> ChangesOver(const Sums& s, std::size_t span) {
  std::vector<Change> changes;
  changes.reserve(s.roll.size());
  for (std::size_t k = span; k + span < s.roll.size(); ++k) {
    const std::size_t a = k - span, b = k + span;
    if (s.unseen[b] != s.unseen[a]) continue;
    const double before = s.seconds[k] - s.seconds[a], after = s.seconds[b] - s.seconds[k];
    const double rate = (s.roll[b] - s.roll[k]) / after - (s.roll[k] - s.roll[a]) / before;
    changes.push_back({k - 1, std::abs(rate), std::sqrt(s.var[b] - s.var[a]) / before});
  }
  return changes;
}

/// 1-sigma of the changes, by the median of the half whose own sigmas are least.
double UsualOf(const std::vector<Change>& changes) {
  std::vector<double> sigmas, plain;
  sigmas.reserve(changes.size());
  plain.reserve(changes.size());
  for (const Change& c : changes) sigmas.push_back(c.sigma);
  const double median = Median(std::move(sigmas));
  for (const Change& c : changes) {
    if (c.sigma <= median) plain.push_back(c.rate);
  }
  return RobustSigma(std::move(plain));
}

double SpeedStart(const AlongHole& before, const AlongHole& after) {
  if (!before.known || !after.known) return 0;
  const double change = std::abs(after.speed - before.speed);
  const double sigma = std::hypot(before.sigma_speed, after.sigma_speed);
  return change > std::max(kLeastChange, 4 * sigma) ? kRollPerSpeed * change : 0;
}

}  // namespace

std::optional<double> UsualRollChange(std::span<const RunKnot> knots) {
  const std::vector<Change> changes = ChangesOver(Sums(knots), 1);
  if (changes.empty()) return std::nullopt;
  return UsualOf(changes);
}

std::vector<double> RollStarts(std::span<const RunKnot> knots, std::span<const double> swung) {
  const Sums sums(knots, swung);
  std::vector<double> starts(knots.size(), 0);
  for (const std::size_t span : kSpans) {
    const std::vector<Change> changes = ChangesOver(sums, span);
    if (changes.empty()) continue;
    const double usual = UsualOf(changes);
    for (const Change& c : changes) {
      if (c.rate <= kBeyond * std::max(usual, c.sigma)) continue;
      starts[c.knot] = std::max(starts[c.knot], c.rate / static_cast<double>(span));
    }
  }
  return starts;
}

double CostOfStarts(std::span<const double> starts) {
  const auto all = static_cast<double>(starts.size());
  const auto m = static_cast<double>(std::ranges::count_if(starts, [](double s) { return s > 0; }));
  const auto cost = [all](double of) { return of > 0 ? -2 * of * std::log(of / all) : 0; };
  const double width = std::log(kRollWalkMost / kRollWalkLeast);
  const double own = std::exp(-0.5) / std::sqrt(kTwoPi);  // N(x; 0, |x|) |x|
  return cost(m) + cost(all - m) + 2 * m * std::log(2 * width * own);
}

std::vector<double> SpeedStarts(std::span<const RunKnot> knots) {
  std::vector<double> starts(knots.size(), 0), times{0};
  for (const RunKnot& knot : knots) times.push_back(times.back() + knot.increment.seconds);
  std::size_t begin = 0, end = 0;
  for (std::size_t k = 0; k < knots.size(); ++k) {
    while (times[begin + 1] < times[k + 1] - kSpeedReach) ++begin;
    while (end + 1 < knots.size() && times[end + 1] < times[k + 1] + kSpeedReach) ++end;
    starts[k] = SpeedStart(knots[begin].along, knots[end].along);
  }
  return starts;
}

double LastSpeedStart(std::span<const RunKnot> knots) {
  std::size_t begin = knots.size() - 1;
  double seconds = 0;  // from the end of knot `begin`
  while (begin > 0 && (seconds += knots[begin].increment.seconds) <= kSpeedReach) --begin;
  return SpeedStart(knots[begin].along, knots.back().along);
}

bool HidesAStart(std::span<const RunKnot> knots, std::span<const double> speed_starts) {
  for (std::size_t k = 0; k < knots.size(); ++k) {
    if (speed_starts[k] > 0 && !knots[k].increment.roll_seen) return true;
  }
  return false;
}

double RollWalkBy(std::span<const RunKnot> knots) {
  const double usual = UsualRollChange(knots).value_or(kWalkUnseen);
  return std::pow(10, std::ceil(std::log10(std::clamp(usual, kRollWalkLeast, kRollWalkMost))));
}

}  // namespace wellgyro
