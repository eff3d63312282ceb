#include "wellgyro/math/spline.h"

#include <cstddef>

namespace wellgyro {
namespace {

using Eigen::Vector3d;

/// What the spline is made of: courses and chords of its intervals.
struct Chords {
  std::vector<double> h;
  std::vector<Vector3d> slope;
};

/// At the first of three points, of the parabola through them.
Vector3d EndSlope(double h0, double h1, const Vector3d& c0, const Vector3d& c1) {
  return c0 + (c0 - c1) * (h0 / (h0 + h1));
}

/// The right side of the row of an end: of the interval there and the next one.
Vector3d EndRight(double h0, double h1, const Vector3d& c0, const Vector3d& c1) {
  return (h1 * (3 * h0 + 2 * h1) * c0 + h0 * h0 * c1) / (h0 + h1);
}

/// Rows lower s(k-1) + middle s(k) + upper s(k+1) = right, by elimination downwards and back.
std::vector<Vector3d> Solve(const Chords& c) {
  const auto& [h, chord] = c;
  const std::size_t n = h.size() + 1, last = n - 1;
  std::vector<double> middle(n), upper(n);
  std::vector<Vector3d> slope(n);
  middle[0] = h[1];
  upper[0] = h[0] + h[1];
  slope[0] = EndRight(h[0], h[1], chord[0], chord[1]);
  const auto eliminate = [&](std::size_t k, double lower, double own, const Vector3d& right) {
    const double factor = lower / middle[k - 1];
    middle[k] = own - factor * upper[k - 1];
    slope[k] = right - factor * slope[k - 1];
  };
  for (std::size_t k = 1; k < last; ++k) {
    upper[k] = h[k - 1];
    eliminate(k, h[k], 2 * (h[k - 1] + h[k]), 3 * (h[k] * chord[k - 1] + h[k - 1] * chord[k]));
  }
  eliminate(last, h[last - 1] + h[last - 2], h[last - 2],
            EndRight(h[last - 1], h[last - 2], chord[last - 1], chord[last - 2]));
  slope[last] /= middle[last];
  for (std::size_t k = last; k-- > 0;) slope[k] = (slope[k] - upper[k] * slope[k + 1]) / middle[k];
  return slope;
}

}  // namespace

std::vector<Vector3d> SplineSlopes(std::span<const double> x, std::span<const Vector3d> y) {
  Chords c;
  for (std::size_t k = 0; k + 1 < x.size(); ++k) {
    c.h.push_back(x[k + 1] - x[k]);
    c.slope.emplace_back((y[k + 1] - y[k]) / c.h[k]);
  }
  const auto& [h, chord] = c;
  if (h.size() == 1) return {chord[0], chord[0]};
  if (h.size() > 2) return Solve(c);
  return {EndSlope(h[0], h[1], chord[0], chord[1]),
          (h[1] * chord[0] + h[0] * chord[1]) / (h[0] + h[1]),
          EndSlope(h[1], h[0], chord[1], chord[0])};
}

}  // namespace wellgyro
