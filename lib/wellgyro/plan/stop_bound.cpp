#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/linear_algebra.h"
#include "wellgyro/plan/stop_search.h"
#include "wellgyro/plan/synthetic_run.h"
#include "wellgyro/uncertainty/ellipse.h"

namespace wellgyro {
namespace {

using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

// Twice or half as many leave the plan of the demonstration's well the same.
constexpr int kIterations = 400;
// Places with time at once: a step's cost goes by their square. With all of them in use no further
// one is tried; the bound holds all the same, only less closely.
constexpr std::size_t kActive = 48;
constexpr double kCloseEnough = 0.998;  // bound over time: known to 0.2 %
constexpr double kTooLong = 1e8;        // [s], three years

/// Times at rest at a growing choice of places, and the slope of the end's largest eigenvalue with
/// the time at any place.
class Relaxation {
 public:
  Relaxation(const StopInformation& info, bool turns)
      : info_(info), turns_(turns ? kToolfaces : 1) {
    const Index first = info_.place_row(0), count = info_.covariance().cols() - first;
    C0_ = info_.covariance().block(0, first, 2, count);
    P0_ = info_.covariance().topLeftCorner<2, 2>();
    S_.resize(0, count);
  }

  /// The largest time that the last point proves necessary, and that it takes.
  struct Bound {
    double least = 0, takes = 0;
    bool met = false;
  };

  Bound Step(double limit) {
    Evaluate();
    FindSteepest();
    Bound bound;
    const double excess = lambda_ - limit, most = steepest_.slope;
    const VectorXd g = ActiveSlopes();
    bound.takes = seconds_.sum();
    bound.met = excess <= 1e-9 * limit;
    if (most > 0) bound.least = (excess + g.dot(seconds_)) / most;
    if (active_.size() < kActive && !IsActive(steepest_)) {
      Activate(steepest_, std::max(1.0, 0.1 * bound.takes));
      return bound;
    }
    for (Index i = 0; i < seconds_.size(); ++i) {
      seconds_[i] = std::max(1e-6, seconds_[i] * std::sqrt(g[i] / most));
    }
    Scale(limit);
    return bound;
  }

  std::vector<StopStand::Rest> Rests() const {
    std::vector<StopStand::Rest> rests;
    for (std::size_t i = 0; i < active_.size(); ++i) {
      rests.push_back({active_[i].place, kTwoPi * active_[i].turn / kToolfaces,
                       seconds_[static_cast<Index>(i)]});
    }
    return rests;
  }

 private:
  struct Place {
    std::size_t place = 0;
    int turn = 0;
    double slope = 0;
  };

  bool IsActive(const Place& p) const {
    return std::any_of(active_.begin(), active_.end(),
                       [&p](const Place& a) { return a.place == p.place && a.turn == p.turn; });
  }

  Eigen::Matrix<double, 2, StopInformation::kBasis> MixOf(const Place& p) const {
    return StopInformation::Mix(kTwoPi * p.turn / kToolfaces);
  }

  void Activate(const Place& p, double seconds) {
    constexpr int n = StopInformation::kBasis;
    const Index first = info_.place_row(0);
    const Index rows = S_.rows();
    S_.conservativeResize(rows + 2, Eigen::NoChange);
    S_.bottomRows(2) =
        MixOf(p) * info_.covariance().block(info_.place_row(p.place), first, n, S_.cols());
    active_.push_back(p);
    seconds_.conservativeResize(seconds_.size() + 1);
    seconds_[seconds_.size() - 1] = seconds;
  }

  /// Columns of the active places out of rows over all of them.
  MatrixXd OfActive(const MatrixXd& all) const {
    constexpr int n = StopInformation::kBasis;
    MatrixXd some(all.rows(), 2 * seconds_.size());
    for (std::size_t i = 0; i < active_.size(); ++i) {
      const Index at = n * static_cast<Index>(active_[i].place);
      some.middleCols(2 * static_cast<Index>(i), 2) =
          all.middleCols(at, n) * MixOf(active_[i]).transpose();
    }
    return some;
  }

  void Evaluate() {
    const MatrixXd S = OfActive(S_), C = OfActive(C0_);
    VectorXd root(S.rows());
    for (Index i = 0; i < root.size(); ++i) {
      root[i] = std::sqrt(seconds_[i / 2] / SyntheticRun::kRestKnot);
    }
    const MatrixXd inner = root.asDiagonal() * S * root.asDiagonal();
    const MatrixXd A = MatrixXd::Identity(S.rows(), S.rows()) + inner;
    const MatrixXd W = root.asDiagonal() * Cholesky(A).Solve(root.asDiagonal() * C.transpose());
    const Matrix2d P = P0_ - C * W;
    const SymmetricEigen eigen = EigenOfSymmetric(0.5 * (P + P.transpose()));
    lambda_ = eigen.values[1];
    const Vector2d v = eigen.vectors.col(1);
    along_ = C0_.transpose() * v - S_.transpose() * (W * v);
  }

  double Slope(const Place& p) const {
    constexpr int n = StopInformation::kBasis;
    const Vector2d seen = MixOf(p) * along_.segment<n>(n * static_cast<Index>(p.place));
    return seen.squaredNorm() / SyntheticRun::kRestKnot;
  }

  void FindSteepest() {
    steepest_ = {};
    for (std::size_t place = 0; place < info_.places(); ++place) {
      for (int turn = 0; turn < turns_; ++turn) {
        Place p{place, turn, 0};
        p.slope = Slope(p);
        if (p.slope > steepest_.slope) steepest_ = p;
      }
    }
  }

  VectorXd ActiveSlopes() const {
    VectorXd g(seconds_.size());
    for (std::size_t i = 0; i < active_.size(); ++i) g[static_cast<Index>(i)] = Slope(active_[i]);
    return g;
  }

  /// All times by one factor, towards the limit.
  void Scale(double limit) {
    for (int i = 0; i < 4; ++i) {
      Evaluate();
      const double falls = ActiveSlopes().dot(seconds_);
      if (!(falls > 0)) return;
      seconds_ *= std::clamp(1 + (lambda_ - limit) / falls, 0.5, 2.0);
    }
  }

  const StopInformation& info_;
  int turns_;
  MatrixXd C0_, S_;
  Matrix2d P0_;
  std::vector<Place> active_;
  VectorXd seconds_;
  double lambda_ = 0;
  VectorXd along_;
  Place steepest_;
};

}  // namespace

std::optional<RelaxedPlan> LeastAtRest(const StopInformation& info, const PlanLimits& limits) {
  const double axis = limits.ellipse / ConfidenceFactor(kConfidence, 2);
  Relaxation relaxation(info, limits.turns);
  RelaxedPlan plan;
  for (int i = 0; i < kIterations; ++i) {
    const auto bound = relaxation.Step(axis * axis);
    if (i == 0 && bound.met) return RelaxedPlan{};
    plan.least = std::max(plan.least, bound.least);
    if (bound.takes > kTooLong || plan.least > kTooLong) return std::nullopt;
    if (bound.met && plan.least > kCloseEnough * bound.takes) break;
  }
  plan.rests = relaxation.Rests();
  return plan;
}

}  // namespace wellgyro
