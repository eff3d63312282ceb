#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <utility>
#include <vector>

#include "wellgyro/base/angle.h"
#include "wellgyro/fit/adjust_cost_internal.h"

namespace wellgyro {
namespace {

constexpr double kHold = 1e-7;          // between nodes at rest [rad]
constexpr double kVerticalHold = 1e-5;  // the same where the azimuth may be quite unknown [rad]
constexpr double kDriftFloor = 1e-13;   // of a drift that does not walk over a span [rad/s]
constexpr double kNoFixSigma = 1e-7;    // of an azimuth that is given as exact [rad]

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Jacobian = Eigen::Map<RowMajor>;

// Two nodes and the common unknowns: residuals and rows of derivatives, filled one by one.
class Rows {
 public:
  Rows(const AdjustLayout& layout, int count, double* residuals, double** jacobians)
      : residuals_(residuals) {
    const int width[3] = {layout.node, layout.node, layout.common};
    for (int block = 0; block < 3; ++block) {
      width_[block] = width[block];
      data_[block] = jacobians != nullptr ? jacobians[block] : nullptr;
      if (data_[block] != nullptr) Jacobian(data_[block], count, width[block]).setZero();
    }
  }
  void Value(int row, double value) { residuals_[row] = value; }
  void Slope(int row, int block, int column, double slope) {
    if (column >= 0 && data_[block] != nullptr) data_[block][row * width_[block] + column] += slope;
  }

 private:
  double* residuals_;
  double* data_[3];
  int width_[3];
};

enum Block { kBegin, kEnd, kCommon };

class Three : public ceres::CostFunction {
 public:
  Three(const AdjustLayout& layout, const AdjustSpan& span, int residuals)
      : layout_(layout), span_(span) {
    set_num_residuals(residuals);
    *mutable_parameter_block_sizes() = {layout.node, layout.node, layout.common};
  }

 protected:
  // Adds `by` times the mean drift of `axis` over the span; returns what it adds.
  double AddDrift(double const* const* x, std::size_t axis, double by, double weight, int row,
                  Rows* rows) const {
    double sum = 0;
    const AdjustLayout::Axis& at = layout_.axis[axis];
    for (const int place : {at.level, at.markov}) {
      if (place < 0) continue;
      sum += by * (x[kBegin][place] + x[kEnd][place]) / 2;
      rows->Slope(row, kBegin, place, weight * by / 2);
      rows->Slope(row, kEnd, place, weight * by / 2);
    }
    if (at.level_common >= 0) {
      sum += by * x[kCommon][at.level_common];
      rows->Slope(row, kCommon, at.level_common, weight * by);
    }
    return sum;
  }

  // Adds the errors' share of a turn whose sensitivities are `d`.
  double AddErrors(double const* const* x, const Knot::SourceVector& d, double weight, int row,
                   Rows* rows) const {
    double sum = AddDrift(x, 0, d[Knot::kGyroBiasX], weight, row, rows) +
                 AddDrift(x, 1, d[Knot::kGyroBiasY], weight, row, rows);
    for (int source = 0; source < Knot::kSources; ++source) {
      const int place = layout_.source[static_cast<std::size_t>(source)];
      if (place < 0) continue;
      sum += d[source] * x[kCommon][place];
      rows->Slope(row, kCommon, place, weight * d[source]);
    }
    return sum;
  }

  // What the gyros and the Earth say the azimuth grows by, less the errors' share; with `weight`
  // times its slopes.
  double Turn(double const* const* x, Block at, double weight, int row, Rows* rows) const {
    const std::complex<double> to = std::polar(1.0, x[at][AdjustLayout::kAzimuth]);
    const std::complex<double> earth = to * span_.earth_turn;
    double value = span_.turn + earth.real() + span_.up;
    rows->Slope(row, at, AdjustLayout::kAzimuth, -weight * earth.imag());
    if (layout_.latitude >= 0) {
      const double slope = (to * span_.turn_by_latitude).real() + span_.up_by_latitude;
      value += slope * x[kCommon][layout_.latitude];
      rows->Slope(row, kCommon, layout_.latitude, weight * slope);
    }
    Knot::SourceVector d = span_.d_turn;
    d.segment<3>(static_cast<int>(Knot::kAccelBiasX)) +=
        (to * span_.by_inclination).real() * span_.d_inclination;
    value += AddSecond(x, span_.second.turn, &d);
    return value - AddErrors(x, d, -weight, row, rows);
  }

  // The same for the inclination.
  double Lift(double const* const* x, Block at, double weight, int row, Rows* rows) const {
    const std::complex<double> to = std::polar(1.0, x[at][AdjustLayout::kAzimuth]);
    const std::complex<double> earth = to * span_.earth_lift;
    double value = span_.lift + earth.imag() + span_.carried;
    rows->Slope(row, at, AdjustLayout::kAzimuth, weight * earth.real());
    if (layout_.latitude >= 0) {
      const double slope = (to * span_.lift_by_latitude).imag();
      value += slope * x[kCommon][layout_.latitude];
      rows->Slope(row, kCommon, layout_.latitude, weight * slope);
    }
    Knot::SourceVector d = span_.d_lift - earth.real() * span_.d_azimuth;
    value += AddSecond(x, span_.second.lift, &d);
    return value - AddErrors(x, d, -weight, row, rows);
  }

  // What `form` says beyond the first order, and into `d` its slopes: with them AddErrors() then
  // counts it twice, so that it comes off again.
  double AddSecond(double const* const* x, const SourceForm& form, Knot::SourceVector* d) const {
    if (!span_.curved) return 0;
    const Knot::SourceVector errors = Errors(x);
    *d += form * errors + form.transpose() * errors;
    return errors.dot(form * errors);
  }

  // As they stand, the drift in the mean of the span.
  Knot::SourceVector Errors(double const* const* x) const {
    Knot::SourceVector errors = Knot::SourceVector::Zero();
    Rows none(layout_, 0, nullptr, nullptr);
    errors[Knot::kGyroBiasX] = AddDrift(x, 0, 1, 0, 0, &none);
    errors[Knot::kGyroBiasY] = AddDrift(x, 1, 1, 0, 0, &none);
    for (int source = 0; source < Knot::kSources; ++source) {
      const int place = layout_.source[static_cast<std::size_t>(source)];
      if (place >= 0) errors[source] = x[kCommon][place];
    }
    return errors;
  }

  const AdjustLayout& layout_;
  const AdjustSpan& span_;
};

class SpanFunction : public Three {
 public:
  SpanFunction(const AdjustLayout& layout, const AdjustSpan& span)
      : Three(layout, span, layout.node) {
    // What a drift wanders within the span, about the mean of its ends.
    const double walk2 = layout.level_walk * layout.level_walk +
                         2 * layout.markov_sigma * layout.markov_sigma / layout.markov_seconds;
    const double within = walk2 * span.seconds / 12;
    const auto wander = [&](const Knot::SourceVector& d) {
      const double x = d[Knot::kGyroBiasX], y = d[Knot::kGyroBiasY];
      return within * (x * x + y * y);
    };
    const double hold = span.vertical ? kVerticalHold : kHold;
    weight_turn_ = 1 / (span.still ? hold : std::sqrt(span.var_turn + wander(span.d_turn)));
    weight_lift_ = 1 / (span.still ? hold : std::sqrt(span.var_lift + wander(span.d_lift)));
    weight_level_ = 1 / std::hypot(layout.level_walk * std::sqrt(span.seconds), kDriftFloor);
    decay_ = std::exp(-span.seconds / layout.markov_seconds);
    weight_markov_ =
        1 / std::hypot(layout.markov_sigma * std::sqrt(1 - decay_ * decay_), kDriftFloor);
  }

  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    Rows rows(layout_, layout_.node, residuals, jacobians);
    Grows(x, AdjustLayout::kAzimuth, weight_turn_, &rows);
    Grows(x, AdjustLayout::kInclination, weight_lift_, &rows);
    for (const AdjustLayout::Axis& at : layout_.axis) {
      if (at.level >= 0) {
        double gain = 0;
        if (at.ramp_common >= 0) {
          gain = span_.seconds * x[kCommon][at.ramp_common];
          rows.Slope(at.level, kCommon, at.ramp_common, -weight_level_ * span_.seconds);
        }
        Goes(x, at.level, 1, gain, weight_level_, &rows);
      }
      if (at.markov >= 0) Goes(x, at.markov, decay_, 0, weight_markov_, &rows);
    }
    return true;
  }

 private:
  void Goes(double const* const* x, int place, double by, double gain, double weight,
            Rows* rows) const {
    rows->Value(place, weight * (x[kEnd][place] - by * x[kBegin][place] - gain));
    rows->Slope(place, kEnd, place, weight);
    rows->Slope(place, kBegin, place, -weight * by);
  }

  void Grows(double const* const* x, int place, double weight, Rows* rows) const {
    double growth = place == AdjustLayout::kAzimuth ? span_.still_turn : 0;
    if (!span_.still) {
      growth = place == AdjustLayout::kAzimuth ? Turn(x, kBegin, -weight, place, rows)
                                               : Lift(x, kBegin, -weight, place, rows);
    }
    Goes(x, place, 1, growth, weight, rows);
  }

  double weight_turn_, weight_lift_, weight_level_, weight_markov_, decay_;
};

class StillFunction : public Three {
 public:
  StillFunction(const AdjustLayout& layout, const AdjustSpan& span)
      : Three(layout, span, 2),
        weight_turn_(1 / std::sqrt(span.var_turn)),
        weight_lift_(1 / std::sqrt(span.var_lift)) {}

  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    Rows rows(layout_, 2, residuals, jacobians);
    rows.Value(0, weight_turn_ * Turn(x, kEnd, weight_turn_, 0, &rows));
    rows.Value(1, weight_lift_ * Lift(x, kEnd, weight_lift_, 1, &rows));
    return true;
  }

 private:
  double weight_turn_, weight_lift_;
};

class LevelFunction : public Three {
 public:
  LevelFunction(const AdjustLayout& layout, const AdjustSpan& span)
      : Three(layout, span, 1), weight_(1 / std::sqrt(span.var_level)) {}

  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    Rows rows(layout_, 1, residuals, jacobians);
    constexpr int kI = AdjustLayout::kInclination;
    double predicted = (x[kBegin][kI] + x[kEnd][kI]) / 2 + span_.bow;
    rows.Slope(0, kBegin, kI, weight_ / 2);
    rows.Slope(0, kEnd, kI, weight_ / 2);
    Knot::SourceVector d = span_.d_level;
    predicted -= AddSecond(x, span_.second_level, &d);
    predicted += AddErrors(x, d, weight_, 0, &rows);
    rows.Value(0, weight_ * (predicted - span_.level));
    return true;
  }

 private:
  double weight_;
};

class AzimuthFunction : public ceres::CostFunction {
 public:
  AzimuthFunction(const AdjustLayout& layout, double azimuth, double sigma)
      : node_(layout.node), azimuth_(azimuth), weight_(1 / std::max(sigma, kNoFixSigma)) {
    set_num_residuals(1);
    *mutable_parameter_block_sizes() = {layout.node};
  }

  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    residuals[0] = weight_ * WrapPi(x[0][AdjustLayout::kAzimuth] - azimuth_);
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Jacobian(jacobians[0], 1, node_).setZero();
      jacobians[0][AdjustLayout::kAzimuth] = weight_;
    }
    return true;
  }

 private:
  int node_;
  double azimuth_, weight_;
};

class RepeatFunction : public ceres::CostFunction {
 public:
  RepeatFunction(const AdjustLayout& layout, const RepeatSigmas& sigmas)
      : layout_(layout), sigmas_(sigmas) {
    set_num_residuals(2);
    *mutable_parameter_block_sizes() = {layout.node, layout.node, layout.common};
  }

  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    Rows rows(layout_, 2, residuals, jacobians);
    Compare(x, 0, AdjustLayout::kAzimuth, sigmas_.azimuth, layout_.lie_azimuth, 1 / sigmas_.sine,
            &rows);
    Compare(x, 1, AdjustLayout::kInclination, sigmas_.inclination, layout_.lie_inclination, 1,
            &rows);
    return true;
  }

 private:
  void Compare(double const* const* x, int row, int place, double sigma, int lie, double by,
               Rows* rows) const {
    const double weight = 1 / sigma;
    double apart = x[1][place] - x[0][place];
    if (place == AdjustLayout::kAzimuth) apart = WrapPi(apart);
    rows->Slope(row, kBegin, place, -weight);
    rows->Slope(row, kEnd, place, weight);
    if (lie >= 0) {
      apart -= by * x[2][lie];
      rows->Slope(row, kCommon, lie, -weight * by);
    }
    rows->Value(row, weight * apart);
  }

  const AdjustLayout& layout_;
  RepeatSigmas sigmas_;
};

// x_i / sigma_i for some of one block.
class PriorFunction : public ceres::CostFunction {
 public:
  PriorFunction(int width, std::vector<std::pair<int, double>> terms)
      : width_(width), terms_(std::move(terms)) {
    set_num_residuals(static_cast<int>(terms_.size()));
    *mutable_parameter_block_sizes() = {width};
  }

  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    const bool slopes = jacobians != nullptr && jacobians[0] != nullptr;
    if (slopes) Jacobian(jacobians[0], num_residuals(), width_).setZero();
    for (std::size_t row = 0; row < terms_.size(); ++row) {
      const auto [place, sigma] = terms_[row];
      residuals[row] = x[0][place] / sigma;
      if (slopes) {
        jacobians[0][row * static_cast<std::size_t>(width_) + static_cast<std::size_t>(place)] =
            1 / sigma;
      }
    }
    return true;
  }

 private:
  int width_;
  std::vector<std::pair<int, double>> terms_;
};

}  // namespace

std::unique_ptr<ceres::CostFunction> SpanCost(const AdjustLayout& layout, const AdjustSpan& span) {
  return std::make_unique<SpanFunction>(layout, span);
}

std::unique_ptr<ceres::CostFunction> StillCost(const AdjustLayout& layout, const AdjustSpan& span) {
  return std::make_unique<StillFunction>(layout, span);
}

std::unique_ptr<ceres::CostFunction> LevelCost(const AdjustLayout& layout, const AdjustSpan& span) {
  return std::make_unique<LevelFunction>(layout, span);
}

std::unique_ptr<ceres::CostFunction> AzimuthCost(const AdjustLayout& layout, double azimuth,
                                                 double sigma) {
  return std::make_unique<AzimuthFunction>(layout, azimuth, sigma);
}

std::unique_ptr<ceres::CostFunction> RepeatCost(const AdjustLayout& layout,
                                                const RepeatSigmas& sigmas) {
  return std::make_unique<RepeatFunction>(layout, sigmas);
}

std::unique_ptr<ceres::CostFunction> DriftPriorCost(const AdjustLayout& layout) {
  std::vector<std::pair<int, double>> terms;
  for (const AdjustLayout::Axis& at : layout.axis) {
    if (at.level >= 0) terms.emplace_back(at.level, std::max(layout.level_sigma, kDriftFloor));
    if (at.markov >= 0) terms.emplace_back(at.markov, layout.markov_sigma);
  }
  return std::make_unique<PriorFunction>(layout.node, std::move(terms));
}

std::unique_ptr<ceres::CostFunction> CommonPriorCost(const AdjustLayout& layout) {
  std::vector<std::pair<int, double>> terms;
  terms.reserve(static_cast<std::size_t>(layout.common));
  for (int i = 0; i < layout.common; ++i) terms.emplace_back(i, layout.sigma_common[i]);
  return std::make_unique<PriorFunction>(layout.common, std::move(terms));
}

}  // namespace wellgyro
