#include "wellgyro/plan/stop_stand.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "wellgyro/estimate/bayes_factor.h"
#include "wellgyro/estimate/cause.h"
#include "wellgyro/math/square.h"
#include "wellgyro/plan/synthetic_run.h"
#include "wellgyro/uncertainty/ellipse.h"

namespace wellgyro {
namespace {

using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::Vector2d;

// Of the mean of order 16 that stands for the largest, what a fault must have to count: 500 left
// out change its 16th root by 500e-12 / 16 = 3e-11.
constexpr double kCounts = 1e-12;
constexpr double kLeastSeconds = 0.5;  // a stop that has less is none: times are of kStopGrain

double Power16(double x) { return Square(Square(Square(Square(x)))); }
double Root16(double x) { return std::sqrt(std::sqrt(std::sqrt(std::sqrt(x)))); }

double Axis(const Matrix2d& cov) {
  static const double factor = ConfidenceFactor(kConfidence, 2);
  const double mean = 0.5 * cov.trace();
  const double apart = std::hypot(0.5 * (cov(0, 0) - cov(1, 1)), cov(0, 1));
  return factor * std::sqrt(std::max(0.0, mean + apart));
}

}  // namespace

StopStand::StopStand(const StopInformation& info, double ellipse_limit, double hidden_limit)
    : info_(&info),
      ellipse_limit_(ellipse_limit),
      hidden_limit_(hidden_limit),
      places_(info.places()),
      row_(info.places()),
      covariance_(info.covariance()) {
  std::iota(places_.begin(), places_.end(), std::size_t{0});
  for (std::size_t i = 0; i < row_.size(); ++i) row_[i] = info.place_row(i);
  if (std::isfinite(hidden_limit)) faults_.resize(info.faults().size());
  std::iota(faults_.begin(), faults_.end(), std::size_t{0});
  Order();
}

/// Where what counts the most comes first, a value above a given one is soon known to be.
void StopStand::Order() {
  std::vector<double> hidden(info_->faults().size());
  for (const std::size_t i : faults_) {
    const Index row = info_->fault_row(i);
    hidden[i] = Hidden(info_->faults()[i], covariance_(row, row), covariance_.col(row).head<2>());
  }
  std::sort(faults_.begin(), faults_.end(), [&hidden](std::size_t a, std::size_t b) {
    return hidden[a] > hidden[b] || (hidden[a] == hidden[b] && a < b);
  });
}

StopStand::Rows StopStand::RowsOf(const Rest& rest) const {
  Rows rows{StopInformation::Mix(rest.turn), row_[rest.place], {}, {}};
  const Matrix2d S = rows.mix * Own(rows.place) * rows.mix.transpose() +
                     SyntheticRun::kRestKnot / rest.seconds * Matrix2d::Identity();
  rows.weight = S.inverse();
  rows.with_end << With(rows, 0).transpose(), With(rows, 1).transpose();
  return rows;
}

StopStand::Basis StopStand::Own(Index place) const {
  constexpr int n = StopInformation::kBasis;
  return covariance_.block<n, n>(place, place).selfadjointView<Eigen::Upper>();
}

Vector2d StopStand::With(const Rows& rest, Index i) const {
  return rest.mix * covariance_.block<1, StopInformation::kBasis>(i, rest.place).transpose();
}

StopStand::Pair StopStand::WithAll(const Rows& rest) const {
  constexpr int n = StopInformation::kBasis;
  const Index above = rest.place, below = covariance_.rows() - above - n;
  const Eigen::Matrix<double, n, 2> mix = rest.mix.transpose();
  Pair columns(covariance_.rows(), 2);
  columns.topRows(above) = covariance_.block(0, above, above, n).lazyProduct(mix);
  columns.middleRows<n>(above) = Own(above) * mix;
  columns.bottomRows(below) =
      covariance_.block(above, above + n, n, below).transpose().lazyProduct(mix);
  return columns;
}

Matrix2d StopStand::End() const {
  return covariance_.topLeftCorner<2, 2>().selfadjointView<Eigen::Upper>();
}

double StopStand::Largest(const HiddenFault& f, const Vector2d& with_end) {
  return kLargestFault * f.size * with_end.norm() / f.unit;
}

double StopStand::Hidden(const HiddenFault& f, double variance, const Vector2d& with_end) const {
  const double information = std::max(1e-12, 1 - variance) / (f.unit * f.unit);
  const double smallest = SmallestNoticed(information, f.size, info_->ln_limit() + f.ln_onsets);
  return std::min(smallest, kLargestFault * f.size) * with_end.norm() / f.unit;
}

PlanValue StopStand::ValueOf(const Matrix2d& end, const Rows* rest, double soft_most) const {
  PlanValue value{.soft = HUGE_VAL};
  value.ellipse = Axis(end);
  const double most = Power16(soft_most);
  double sum = Power16(value.ellipse / ellipse_limit_);
  for (const std::size_t i : faults_) {
    const Index row = info_->fault_row(i);
    double variance = covariance_(row, row);
    Vector2d with_end = covariance_.col(row).head<2>();
    if (rest != nullptr) {
      const Vector2d with = With(*rest, row), u = rest->weight * with;
      variance -= with.dot(u);
      with_end -= rest->with_end * u;
    }
    const HiddenFault& fault = info_->faults()[i];
    const double largest = Largest(fault, with_end);
    if (largest < value.hidden && Power16(largest / hidden_limit_) < kCounts * sum) continue;
    const double hidden = Hidden(fault, variance, with_end);
    value.hidden = std::max(value.hidden, hidden);
    sum += Power16(hidden / hidden_limit_);
    if (sum > most) return value;
  }
  value.soft = Root16(sum);
  return value;
}

PlanValue StopStand::Value() const { return ValueOf(End(), nullptr, HUGE_VAL); }

PlanValue StopStand::ValueWith(const Rest& rest, double soft_most) const {
  const Rows rows = RowsOf(rest);
  const Matrix2d end = End() - rows.with_end * rows.weight * rows.with_end.transpose();
  // The ellipse alone may say it all.
  if (Axis(end) > soft_most * ellipse_limit_) return {.ellipse = Axis(end), .soft = HUGE_VAL};
  return ValueOf(end, &rows, soft_most);
}

void StopStand::Add(const Rest& rest) {
  const Rows rows = RowsOf(rest);
  const Pair with = WithAll(rows), weighted = with * rows.weight;
  for (Index j = 0; j < covariance_.cols(); ++j) {
    covariance_.col(j).head(j + 1) -=
        with(j, 0) * weighted.col(0).head(j + 1) + with(j, 1) * weighted.col(1).head(j + 1);
  }
  Order();
  const auto same = std::find_if(stops_.begin(), stops_.end(), [&](const Rest& r) {
    return r.place == rest.place && r.turn == rest.turn;
  });
  if (same == stops_.end()) {
    stops_.push_back(rest);
    return;
  }
  same->seconds += rest.seconds;
  if (same->seconds < kLeastSeconds) stops_.erase(same);
}

void StopStand::Keep(std::span<const std::size_t> places) {
  std::vector<std::size_t> kept(places.begin(), places.end());
  for (const Rest& rest : stops_) kept.push_back(rest.place);
  std::sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  std::vector<Index> rows;
  for (Index i = 0; i < info_->place_row(0); ++i) rows.push_back(i);
  std::vector<Index> place_row(row_.size(), -1);
  for (const std::size_t place : kept) {
    place_row[place] = static_cast<Index>(rows.size());
    for (Index i = 0; i < StopInformation::kBasis; ++i) rows.push_back(row_[place] + i);
  }
  covariance_ = Eigen::MatrixXd(covariance_(rows, rows));
  row_ = std::move(place_row);
  places_ = std::move(kept);
}

double StopStand::at_rest() const {
  double sum = 0;
  for (const Rest& rest : stops_) sum += rest.seconds;
  return sum;
}

}  // namespace wellgyro
