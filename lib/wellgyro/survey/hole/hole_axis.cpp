#include "wellgyro/survey/hole/hole_axis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>

#include <Eigen/Core>

#include "wellgyro/estimate/turn_columns.h"
#include "wellgyro/math/linear_algebra.h"
#include "wellgyro/math/plane.h"
#include "wellgyro/math/so3.h"

namespace wellgyro {
namespace {

using Complex = std::complex<double>;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// A way below which depth tells of no motion: marks leave as much unknown, and a hole that turns by
// 10 deg/30 m turns by 3e-4 deg on it.
constexpr double kRests = 1e-3;  // [m]
// Bound of a correction: twice the median size of those from kAbout knots before to kAbout behind.
// A whirl goes on, and so do its corrections. Where the hole kinks within the four knots, .04 deg/m
// within a metre, the parabola's truncation error is some .002 deg at two or three ends alone: the
// median leaves that out. Of a tool that rocks to and fro a correction is up to 1.4 times the
// median.
constexpr std::size_t kAbout = 10;
constexpr double kOfMedian = 2;

/// The tool's axis at `node` turned by a rotation vector across it, in T.
Vector3d Turned(const Node& node, Complex across) {
  return node.R_LT * Exp(Vector3d(across.real(), across.imag(), 0)).col(2);
}

/// Mean over the knot. With theta(t) the turn across since its begin, as M sees it,
///   mean theta = turn - (integral of t d theta) / T = turn / 2 + i turn_per_roll,
/// to which both ends of the knot are witnesses: what the gyros' errors turn by cancels, but for
/// skew, whose turn goes round with the tool.
Vector3d MeanAxis(const Increment& inc, const Node& begin, const Node& end,
                  const Vector2d& skew_T) {
  const Complex turn = ComplexOf(inc.turn_M);
  const Complex mean = 0.5 * turn + Complex(0, 1) * ComplexOf(inc.turn_per_roll) -
                       ComplexOf(SkewBeforeHalf(inc) * skew_T);
  return (Turned(begin, std::polar(1., inc.roll_before) * mean) +
          Turned(end, std::polar(1., -inc.roll_after) * (mean - turn))) /
         2;
}

bool Seen(const RunKnot& knot) {
  return knot.along.known && knot.increment.gap_seconds == 0 && knot.unseen == 0;
}

/// Means over a knot of 1, s and s^2, s the depth from `md` on: by Simpson's rule and a cubic
/// through the depths and speeds of its ends.
Vector3d Moments(double md, const Node& begin, const Node& end, double seconds) {
  const double a = begin.md - md, b = end.md - md;
  const double middle = (a + b) / 2 + seconds * (begin.speed - end.speed) / 8;
  return {1, (a + 4 * middle + b) / 6, (a * a + 4 * middle * middle + b * b) / 6};
}

/// Weights of means over four knots: of all by which a parabola's value at s = 0 comes out, those
/// that weigh each instant least, so that a short knot counts for little. Where less than kRests is
/// travelled the parabola is a constant, and they go by the lengths.
Eigen::Vector4d WeightsOfMeans(Eigen::Matrix<double, 3, 4> moments,
                               const Eigen::Vector4d& seconds) {
  const double scale = std::max(1.0, moments.row(1).cwiseAbs().maxCoeff());
  moments.row(1) /= scale;
  moments.row(2) /= scale * scale;
  const Eigen::Vector4d root = seconds.cwiseSqrt();
  const Eigen::Matrix<double, 3, 4> weighed = moments * root.asDiagonal();
  return root.cwiseProduct(Eigen::Vector4d(SolveLeastNorm(weighed, Vector3d::UnitX(), kRests)));
}

/// From the tool's axis at the end of each knot to the parabola's: phi of R_LT Exp(phi) [rad]; zero
/// where there is none.
std::vector<Vector3d> Beside(std::span<const RunKnot> knots, std::span<const Node> nodes,
                             const Vector2d& skew_T) {
  std::vector<Vector3d> means, beside(knots.size(), Vector3d::Zero());
  for (std::size_t k = 0; k < knots.size(); ++k) {
    means.push_back(MeanAxis(knots[k].increment, nodes[k], nodes[k + 1], skew_T));
  }
  for (std::size_t k = 1; k + 2 < knots.size(); ++k) {
    const std::span<const RunKnot> four = knots.subspan(k - 1, 4);
    if (!std::all_of(four.begin(), four.end(), Seen)) continue;
    Eigen::Matrix<double, 3, 4> moments;
    Eigen::Matrix<double, 3, 4> axes;
    Eigen::Vector4d seconds;
    for (int i = 0; i < 4; ++i) {
      const std::size_t j = k - 1 + static_cast<std::size_t>(i);
      seconds[i] = knots[j].increment.seconds;
      moments.col(i) = Moments(nodes[k + 1].md, nodes[j], nodes[j + 1], seconds[i]);
      axes.col(i) = means[j];
    }
    const Vector3d axis_T =
        nodes[k + 1].R_LT.transpose() * (axes * WeightsOfMeans(moments, seconds));
    beside[k] = Vector3d(-axis_T.y(), axis_T.x(), 0) / axis_T.z();
  }
  return beside;
}

/// Of the sizes from kAbout before this one to kAbout behind it.
double MedianAbout(std::span<const double> sizes, std::size_t k) {
  const std::size_t begin = k - std::min(k, kAbout), end = std::min(k + kAbout + 1, sizes.size());
  std::array<double, 2 * kAbout + 1> about;
  const auto last = std::copy(sizes.begin() + static_cast<std::ptrdiff_t>(begin),
                              sizes.begin() + static_cast<std::ptrdiff_t>(end), about.begin());
  const auto middle = about.begin() + (last - about.begin()) / 2;
  std::nth_element(about.begin(), middle, last);
  return *middle;
}

}  // namespace

std::vector<Matrix3d> OnHoleAxis(std::span<const RunKnot> knots, std::span<const Node> nodes,
                                 const Vector2d& skew_T) {
  const std::vector<Vector3d> beside = Beside(knots, nodes, skew_T);
  std::vector<double> sizes;
  for (const Vector3d& phi : beside) sizes.push_back(phi.norm());
  std::vector<Matrix3d> along;
  for (std::size_t k = 0; k < knots.size(); ++k) {
    const double most = kOfMedian * MedianAbout(sizes, k);
    const double share = sizes[k] > most ? most / sizes[k] : 1;
    along.push_back(nodes[k + 1].R_LT * Exp(share * beside[k]));
  }
  return along;
}

}  // namespace wellgyro
