#include "wellgyro/survey/intake/truncation_watch.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace wellgyro {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;
using Eigen::Vector4d;

// Of a step, by which a whole number of them may be off: decimals of a table, three behind a step's
// own.
constexpr double kWholeStep = 1e-3;
// Samples of one passage, at the most: ten seconds at 10 Hz, in which a signal that rolls is
// through.
constexpr double kMostSamples = 100;
// Passages from which their mean counts are normal enough for a sigma, which they tell to
// 1 / sqrt(2 * 30) = 13 %.
constexpr double kLeastPassages = 30;

}  // namespace

void TruncationWatch::Push(double value, double step) {
  if (!(step > 0)) return;
  if (step != step_) *this = TruncationWatch();
  step_ = step;
  const double level = std::round(value / step);
  const bool whole = std::abs(value / step - level) < kWholeStep;
  ++(whole ? whole_ : broken_);
  if (std::abs(level) <= 2) {
    ++levels_[static_cast<std::size_t>(std::abs(level))];
    return;
  }
  const int side = level > 0 ? 1 : -1;
  if (side_ == -side) Pass();
  side_ = side;
  levels_.fill(0);
}

/// Of a passage that stops on its way no more than kMostSamples count.
void TruncationWatch::Pass() {
  using Counts = Eigen::Matrix<std::int64_t, 3, 1>;
  const Vector3d levels = Counts(levels_.data()).cast<double>();
  if (levels.isZero(0)) return;
  const Vector4d counts = (levels * std::min(1.0, kMostSamples / levels.sum())).homogeneous();
  Matrix4d::Map(sums_.data()) += counts * counts.transpose();
}

TruncationWatch::Found TruncationWatch::Of(const TruncationWatch& a, const TruncationWatch& b) {
  Found found;
  Matrix4d sums = Matrix4d::Zero();
  for (const TruncationWatch* w : {&a, &b}) {
    if (w->broken_ > w->whole_) continue;
    found.step = std::max(found.step, w->step_);
    sums += Matrix4d(w->sums_.data());
  }
  const double passages = sums(3, 3);
  if (passages < kLeastPassages || !(sums.col(3).minCoeff() > 0)) return found;
  const Vector3d mean = sums.topRightCorner<3, 1>() / passages;
  // d ln R by the mean counts: 1 / D0, -4/3 / D1, 1/3 / D2; halves of +-1 and +-2 are constants,
  // and so is how many samples there are.
  const Vector3d slope(1 / mean[0], -4 / (3 * mean[1]), 1 / (3 * mean[2]));
  const Matrix3d cov = sums.topLeftCorner<3, 3>() / passages - mean * mean.transpose();
  found.ln_ratio = std::log(mean[0]) - 4.0 / 3 * std::log(mean[1] / 2) + std::log(mean[2] / 2) / 3;
  found.sigma = std::sqrt(slope.dot(cov * slope) / passages);
  return found;
}

}  // namespace wellgyro
