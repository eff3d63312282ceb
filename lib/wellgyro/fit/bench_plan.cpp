#include "wellgyro/fit/bench_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <tuple>
#include <utility>

#include <Eigen/Dense>
#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/fit/bench_checks_internal.h"
#include "wellgyro/fit/bench_design_internal.h"
#include "wellgyro/math/linear_algebra.h"

namespace wellgyro {
namespace {

using PlanCriterion = BenchPlanSetup::Criterion;

std::vector<double> TausOf(int temperatures) {
  std::vector<double> taus;
  for (int k = 0; k < temperatures; ++k) {
    taus.push_back(temperatures == 1 ? 0 : -1 + 2.0 * k / (temperatures - 1));
  }
  return taus;
}

std::vector<BenchSetting> CandidateSettings(const BenchPlanSetup& setup) {
  std::vector<BenchSetting> all;
  for (const double tau : TausOf(setup.temperatures)) {
    for (int inc = 0; inc <= 180; inc += 15) {
      for (int az = 0; az < 360; az += 45) {
        for (int tf = 0; tf < 360; tf += 30) {
          // Where the tool is vertical azimuth and toolface are one.
          if ((inc == 0 || inc == 180) && tf > 0) continue;
          all.push_back({FromDegrees(inc), FromDegrees(az), FromDegrees(tf), tau});
        }
      }
    }
  }
  return all;
}

double LargestOrMean(const Eigen::VectorXd& variances, PlanCriterion criterion) {
  return criterion == PlanCriterion::kMean ? variances.mean() : variances.maxCoeff();
}

class Exchange {
 public:
  Exchange(const BenchDesign& design, PlanCriterion criterion, double variance)
      : design_(design), criterion_(criterion), variance_(variance) {}

  /// Settings that reach the variance and leave the readings' noise to be found, from `optimum`
  /// upwards; at most `most` of them.
  std::vector<Eigen::Index> Find(const DesignWeights& optimum, std::size_t most) {
    // What makes the first settings' information whole: a little of the optimum's. Of its 40 to 80
    // settings 1 % is less than one, so that what is chosen soon counts for more. With half or
    // twice of it the plans of four wells are the same or one setting longer.
    constexpr double kLittle = 0.01;
    constexpr int kDrifts = 4;  // of two gyros a line and a bend, which a fit of the bench has too
    const Eigen::VectorXd twice = optimum.weights.transpose().replicate(2, 1).reshaped();
    const Eigen::MatrixXd start =
        kLittle * design_.rows.transpose() * twice.asDiagonal() * design_.rows;
    information_ = design_.before + start;
    const auto least =
        std::max(static_cast<std::size_t>(std::ceil(optimum.fewest)),
                 static_cast<std::size_t>((design_.rows.cols() + kDrifts + kToFindNoise + 1) / 2));
    while (chosen_.size() < std::min(least, most)) Add(Best(Covariance(), Covariance()));
    // Of it stays what is below any digit that counts.
    information_ -= (1 - 1e-7) * start;
    while (true) {
      Improve();
      if (Enough() || chosen_.size() >= most) return chosen_;
      Add(Best(Covariance(), Covariance()));
    }
  }

 private:
  Eigen::MatrixXd Covariance() const { return InverseOfSymmetric(information_); }
  Eigen::MatrixXd RowsAt(Eigen::Index place) const { return design_.rows.middleRows<2>(2 * place); }
  void Add(Eigen::Index place) {
    chosen_.push_back(place);
    information_ += RowsAt(place).transpose() * RowsAt(place);
  }
  bool Enough() const {
    const Eigen::VectorXd s = AzimuthVariances(design_.hole, Covariance());
    return s.minCoeff() > 0 && LargestOrMean(s, criterion_) <= variance_ * (1 + 1e-9);
  }

  // A norm of the variances stands for the largest, which has no slope: of 670 attitudes this one
  // is within 1.5 of it. Powers of 4, 8, 16 and 40 end at 80, 77, 76 and 77 settings where the
  // plain bench has 96.
  double Power() const { return criterion_ == PlanCriterion::kMean ? 1 : 16; }
  double Value() const {
    if (criterion_ == PlanCriterion::kDeterminant) {
      const Cholesky root(information_);
      return root.positive() ? -root.LogDeterminant() : std::numeric_limits<double>::infinity();
    }
    const Eigen::VectorXd s = AzimuthVariances(design_.hole, Covariance());
    const double most = s.maxCoeff();
    return most * std::pow((s / most).array().pow(Power()).mean(), 1 / Power());
  }

  // The candidate that is worth most beside what has the covariance `C`; `now` weighs the hole's
  // attitudes by the slope of the norm.
  Eigen::Index Best(const Eigen::MatrixXd& C, const Eigen::MatrixXd& now) const {
    const Eigen::MatrixXd XC = design_.rows * C;
    Eigen::MatrixXd XQ = XC;
    if (criterion_ != PlanCriterion::kDeterminant) {
      const Eigen::VectorXd s = AzimuthVariances(design_.hole, now);
      const Eigen::VectorXd r = (s / s.maxCoeff()).array().pow(Power() - 1);
      XQ = XC * (design_.hole.transpose() * r.asDiagonal() * design_.hole) * C;
    }
    std::pair<Eigen::Index, double> best{0, -1};
    for (Eigen::Index place = 0; place < design_.rows.rows() / 2; ++place) {
      const auto X = design_.rows.middleRows<2>(2 * place);
      const Eigen::Matrix2d inner =
          Eigen::Matrix2d::Identity() + XC.middleRows<2>(2 * place) * X.transpose();
      const Eigen::Matrix2d gain = XQ.middleRows<2>(2 * place) * X.transpose();
      const double worth = criterion_ == PlanCriterion::kDeterminant
                               ? inner.determinant()
                               : (inner.inverse() * gain).trace();
      if (worth > best.second) best = {place, worth};
    }
    return best.first;
  }

  // One setting after the other for a better one, until none is.
  void Improve() {
    // Bound of the time alone: five turns were the most that the plans of four wells took.
    constexpr int kTurns = 8;
    for (int turn = 0; turn < kTurns; ++turn) {
      const double before = Value();
      for (std::size_t k = 0; k < chosen_.size(); ++k) ReplaceFirst();
      if (!(Value() < before - 1e-5 * std::abs(before))) return;
    }
  }

  // The first goes; the best, or itself, comes behind the last.
  void ReplaceFirst() {
    const double before = Value();
    const Eigen::MatrixXd whole = information_, now = Covariance();
    const Eigen::Index first = chosen_.front();
    chosen_.erase(chosen_.begin());
    information_ -= RowsAt(first).transpose() * RowsAt(first);
    Add(Best(Covariance(), now));
    if (Value() < before) return;
    chosen_.back() = first;
    information_ = whole;
  }

  const BenchDesign& design_;
  PlanCriterion criterion_;
  double variance_;
  Eigen::MatrixXd information_;
  std::vector<Eigen::Index> chosen_;
};

// The candidates that the optimum of continuous weights uses; all of them for another criterion.
std::vector<Eigen::Index> Support(const DesignWeights& optimum, PlanCriterion criterion) {
  const double least =
      criterion == PlanCriterion::kDeterminant ? 0 : 1e-3 * optimum.weights.maxCoeff();
  std::vector<Eigen::Index> support;
  for (Eigen::Index k = 0; k < optimum.weights.size(); ++k) {
    if (optimum.weights[k] >= least) support.push_back(k);
  }
  return support;
}

BenchDesign DesignAt(const BenchDesign& design, const std::vector<Eigen::Index>& places) {
  BenchDesign reduced{
      Eigen::MatrixXd(2 * static_cast<Eigen::Index>(places.size()), design.rows.cols()),
      design.hole, design.before};
  for (std::size_t k = 0; k < places.size(); ++k) {
    reduced.rows.middleRows<2>(2 * static_cast<Eigen::Index>(k)) =
        design.rows.middleRows<2>(2 * places[k]);
  }
  return reduced;
}

void Require(const BenchPlanSetup& setup) {
  if (setup.temperatures < 1 || setup.temperatures > 5) {
    throw std::invalid_argument(
        fmt::format("{} temperatures: 1 to 5 can be planned", setup.temperatures));
  }
  const double inc = setup.inclination_to - setup.inclination_from;
  const double az = setup.azimuth_to - setup.azimuth_from;
  if (!(inc >= 0) || !(az >= 0) || az > kTwoPi + 1e-3) {
    throw std::invalid_argument("inclinations and azimuths of the hole go from less to more");
  }
  if (!(setup.sigma_gyro > 0) || !(setup.sigma_azimuth >= 0) || !(setup.sigma_sensitivity >= 0)) {
    throw std::invalid_argument("a plan needs the sigma of a reading, and none below zero");
  }
}

}  // namespace

double AzimuthSigmaOf(const std::vector<BenchSetting>& settings, const BenchPlanSetup& setup) {
  const BenchDesign design = DesignOf(settings, setup);
  const Eigen::MatrixXd information = design.before + design.rows.transpose() * design.rows;
  const Eigen::VectorXd scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  if (!(EigenOfSymmetric(scaled).values[0] > 1e-10)) return std::numeric_limits<double>::infinity();
  const Eigen::MatrixXd cov = scale.asDiagonal() * InverseOfSymmetric(scaled) * scale.asDiagonal();
  return std::sqrt(LargestOrMean(AzimuthVariances(design.hole, cov), setup.criterion));
}

std::vector<BenchSetting> PlainSettings(int temperatures) {
  std::vector<BenchSetting> all;
  for (const double tau : TausOf(temperatures)) {
    for (int inc = 0; inc <= 135; inc += 45) {
      for (int az = 0; az < 360; az += 90) {
        for (int tf = 0; tf < 360; tf += 60) {
          all.push_back({FromDegrees(inc), FromDegrees(az), FromDegrees(tf), tau});
        }
      }
    }
  }
  return all;
}

BenchPlan PlanBench(const BenchPlanSetup& setup) {
  Require(setup);
  const std::vector<BenchSetting> candidates = CandidateSettings(setup);
  const BenchDesign design = DesignOf(candidates, setup);
  BenchPlan plan;
  plan.wanted = setup.sigma_azimuth > 0 ? setup.sigma_azimuth
                                        : AzimuthSigmaOf(PlainSettings(setup.temperatures), setup);
  const double variance = plan.wanted * plan.wanted;
  DesignWeights optimum = OptimalWeights(design, variance, setup.criterion != PlanCriterion::kMean);
  plan.fewest = optimum.fewest;
  const auto most = static_cast<std::size_t>(setup.most * setup.temperatures);
  const std::vector<Eigen::Index> support = Support(optimum, setup.criterion);
  const BenchDesign reduced = DesignAt(design, support);
  optimum.weights = Eigen::VectorXd(optimum.weights(support));
  for (const Eigen::Index at : Exchange(reduced, setup.criterion, variance).Find(optimum, most)) {
    plan.settings.push_back(
        candidates[static_cast<std::size_t>(support[static_cast<std::size_t>(at)])]);
  }
  std::sort(plan.settings.begin(), plan.settings.end(),
            [](const BenchSetting& a, const BenchSetting& b) {
              return std::tie(a.tau, a.inclination, a.azimuth, a.toolface) <
                     std::tie(b.tau, b.inclination, b.azimuth, b.toolface);
            });
  plan.sigma_azimuth = AzimuthSigmaOf(plan.settings, setup);
  plan.reached = plan.sigma_azimuth <= plan.wanted * (1 + 1e-6);
  return plan;
}

}  // namespace wellgyro
