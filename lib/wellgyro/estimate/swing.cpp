#include "wellgyro/estimate/swing.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <vector>

#include "wellgyro/base/angle.h"
#include "wellgyro/estimate/roll_start.h"

namespace wellgyro {
namespace {

using Complex = std::complex<double>;

// [s], within which a line keeps its phase. Halved or doubled, this and kOversampled move the end
// of the demonstration, whose roll swings, by 0.002 sigma.
constexpr double kSegment = 600;
// Half or twice the least of knots and of rates: the same swing is found in three clean runs.
constexpr std::size_t kLeastSeen = 60;  // knots of a segment, to tell a line from a trend
constexpr double kLongest = 60;         // [s], longest period: ten of them in kSegment
constexpr double kNyquist = 0.9;        // of half a turn a knot, beyond which a line is aliased
// Share of the variance that a line must explain. At 0.6 the demonstration's swing, in a sixth of
// its way, is missed, and its azimuth errors are 1.4 % larger; at 0.15 no other line is found in
// clean runs.
constexpr double kShare = 0.3;
constexpr double kLeastRate = 3e-3;  // [rad/s]: what less does to the roll, a walk holds as well
// Lines per width 1 / kSegment: of one between two of them sinc(1/8)^2 = 95 % is seen.
constexpr int kOversampled = 4;
constexpr std::size_t kSegmentsMost = 24;  // four hours: the cost of the search is bounded

struct Point {
  double time, rate;
};

/// Stretches of the run between stops, the mean rate of each taken out. What the tool swings by
/// before a stop has not the phase of what it swings by behind it; where it starts and stops its
/// mean rate changes by more than a swing may have. `rate_of`: of a knot, where known.
template <typename RateOf>
std::vector<std::vector<Point>> Segments(std::span<const RunKnot> knots, const RateOf& rate_of) {
  std::vector<std::vector<Point>> segments(1);
  const std::vector<double> starts = SpeedStarts(knots);
  double time = 0;
  for (std::size_t k = 0; k < knots.size(); ++k) {
    time += knots[k].increment.seconds;
    const bool whole = !segments.back().empty() &&
                       (knots[k].still || time - segments.back().front().time > kSegment);
    if (whole) segments.emplace_back();
    if (knots[k].still || starts[k] > 0) continue;
    if (const std::optional<double> rate = rate_of(k)) segments.back().push_back({time, *rate});
  }
  std::erase_if(segments, [](const auto& s) { return s.size() < kLeastSeen; });
  if (segments.size() > kSegmentsMost) segments.resize(kSegmentsMost);
  for (auto& segment : segments) {
    double mean = 0;
    for (const Point& p : segment) mean += p.rate;
    mean /= static_cast<double>(segment.size());
    for (Point& p : segment) p.rate -= mean;
  }
  return segments;
}

/// Periodogram of the segments at frequencies `first`, `first` + `step` and so on: each point's
/// e^{i w time} is turned on by `step`.
class Lines {
 public:
  Lines(const std::vector<std::vector<Point>>& segments, double first, double step) {
    for (const auto& segment : segments) {
      sizes_.push_back(segment.size());
      for (const Point& p : segment) {
        lines_.push_back(p.rate * std::polar(1.0, first * p.time));
        steps_.push_back(std::polar(1.0, step * p.time));
      }
    }
  }

  /// Of the sums of squares of all segments, what the next line explains.
  double Next() {
    double sum = 0;
    std::size_t at = 0;
    for (const std::size_t size : sizes_) {
      double re = 0, im = 0;
      for (const std::size_t end = at + size; at < end; ++at) {
        const double x = lines_[at].real(), y = lines_[at].imag();
        const double c = steps_[at].real(), s = steps_[at].imag();
        re += x;
        im += y;
        lines_[at] = {x * c - y * s, x * s + y * c};
      }
      sum += 2 * (re * re + im * im) / static_cast<double>(size);
    }
    return sum;
  }

 private:
  std::vector<std::size_t> sizes_;
  std::vector<Complex> lines_, steps_;
};

std::optional<double> SwingIn(std::span<const RunKnot> knots,
                              const std::vector<std::vector<Point>>& segments) {
  double squares = 0, count = 0;
  for (const auto& segment : segments) {
    for (const Point& p : segment) squares += p.rate * p.rate;
    count += static_cast<double>(segment.size());
  }
  if (count == 0 || squares < kLeastRate * kLeastRate * count) return std::nullopt;
  double seconds = 0;
  for (const RunKnot& knot : knots) seconds += knot.increment.seconds;
  const double knot = seconds / static_cast<double>(knots.size());
  const double step = kTwoPi / (kOversampled * kSegment);
  // With a neighbour before the first and behind the last.
  const double first = kTwoPi / kLongest - step;
  Lines lines(segments, first, step);
  std::vector<double> explained{lines.Next(), lines.Next(), lines.Next()};
  for (double w = first + 2 * step; w < kNyquist * kPi / knot; w += step) {
    explained.push_back(lines.Next());
  }
  const auto top = std::max_element(explained.begin() + 1, explained.end() - 1);
  if (*top < kShare * squares) return std::nullopt;
  // The top of the parabola through the peak and its neighbours.
  const double omega = first + step * static_cast<double>(top - explained.begin());
  const double before = *(top - 1), after = *(top + 1), bend = before - 2 * *top + after;
  return bend < 0 ? omega + 0.5 * step * (before - after) / bend : omega;
}

}  // namespace

std::optional<double> SwingOf(std::span<const RunKnot> knots) {
  const auto seen = [&](std::size_t k) -> std::optional<double> {
    const Increment& i = knots[k].increment;
    if (!i.roll_seen) return std::nullopt;
    return i.roll() / i.seconds;
  };
  return SwingIn(knots, Segments(knots, seen));
}

std::optional<double> SwingOf(std::span<const RunKnot> knots, std::span<const Node> nodes) {
  const auto solved = [&](std::size_t k) { return std::optional(nodes[k].roll_rate); };
  return SwingIn(knots, Segments(knots, solved));
}

}  // namespace wellgyro
