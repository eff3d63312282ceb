#include "wellgyro/estimate/swing.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <vector>

#include "wellgyro/base/angle.h"

namespace wellgyro {
namespace {

using Complex = std::complex<double>;

constexpr double kSegment = 600;        // [s], within which a line keeps its phase
constexpr std::size_t kLeastSeen = 60;  // knots of a segment, to tell a line from a trend
constexpr double kLongest = 60;         // [s], period
constexpr double kNyquist = 0.9;        // of half a turn a knot
constexpr double kShare = 0.3;          // of the variance that a line must explain
constexpr double kLeastRate = 3e-3;     // [rad/s]: what less does to the roll, a walk holds as well
constexpr int kOversampled = 4;
constexpr std::size_t kSegmentsMost = 24;

struct Point {
  double time, rate;
};

/// Stretches of the run with the roll in sight, the mean rate of each taken out.
std::vector<std::vector<Point>> Segments(std::span<const RunKnot> knots) {
  std::vector<std::vector<Point>> segments(1);
  double time = 0;
  for (const RunKnot& knot : knots) {
    const Increment& i = knot.increment;
    time += i.seconds;
    const bool whole = !segments.back().empty() && time - segments.back().front().time > kSegment;
    if (whole) segments.emplace_back();
    if (i.roll_seen && !knot.still) {
      segments.back().push_back({time, (i.roll_before + i.roll_after) / i.seconds});
    }
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

/// Of the sums of squares of all segments, what a line of this frequency explains.
double Explained(const std::vector<std::vector<Point>>& segments, double omega) {
  double sum = 0;
  for (const auto& segment : segments) {
    Complex line = 0;
    for (const Point& p : segment) line += std::polar(p.rate, omega * p.time);
    sum += 2 * std::norm(line) / static_cast<double>(segment.size());
  }
  return sum;
}

}  // namespace

std::optional<double> SwingOf(std::span<const RunKnot> knots) {
  const std::vector<std::vector<Point>> segments = Segments(knots);
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
  double best = 0, omega = 0;
  for (double w = kTwoPi / kLongest; w < kNyquist * kPi / knot; w += step) {
    const double explained = Explained(segments, w);
    if (explained > best) {
      best = explained;
      omega = w;
    }
  }
  if (best < kShare * squares) return std::nullopt;
  // The top of the parabola through the peak and its neighbours.
  const double before = Explained(segments, omega - step),
               after = Explained(segments, omega + step);
  const double bend = before - 2 * best + after;
  return bend < 0 ? omega + 0.5 * step * (before - after) / bend : omega;
}

}  // namespace wellgyro
