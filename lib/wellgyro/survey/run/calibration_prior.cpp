#include "wellgyro/survey/run/calibration_prior.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "wellgyro/calibration/error_sources.h"
#include "wellgyro/calibration/errors_in_use.h"

namespace wellgyro {
namespace {

/// One number of a job's [errors], and the errors of the estimator that it speaks of: `count` of
/// `sources`, and those behind them from `from` on.
struct ErrorKind {
  double ErrorPriors::*sigma;
  std::size_t count;
  std::array<ErrorSource, 6> sources;
  int from = kErrorSources;
};

constexpr std::array kKinds{
    ErrorKind{&ErrorPriors::gyro_bias_sigma, 3, {{kGyroBiasX, kGyroBiasY, kGyroBiasZ}}},
    ErrorKind{&ErrorPriors::mass_unbalance_sigma, 2, {{kMassUnbalance, kUnbalanceDifference}}},
    ErrorKind{&ErrorPriors::quadrature_sigma, 2, {{kQuadrature, kQuadratureSum}}},
    ErrorKind{&ErrorPriors::gyro_scale_sigma, 3, {{kGyroScaleX, kGyroScaleY, kGyroScaleZ}}},
    ErrorKind{
        &ErrorPriors::gyro_misalignment_sigma,
        5,
        {{kMisalignmentX, kMisalignmentY, kGyroMisalignmentZX, kGyroMisalignmentZY, kGyroShear}}},
    // ErrorsLeft counts the second order with the biases.
    ErrorKind{&ErrorPriors::accel_bias_sigma,
              3,
              {{kAccelBiasX, kAccelBiasY, kAccelBiasZ}},
              kAccelSecondOrder},
    ErrorKind{&ErrorPriors::accel_scale_sigma, 3, {{kAccelScaleX, kAccelScaleY, kAccelScaleZ}}},
    ErrorKind{&ErrorPriors::accel_misalignment_sigma,
              6,
              {{kToolfaceOffset, kAccelMisalignmentX, kAccelMisalignmentY, kAccelShear,
                kAccelMisalignmentZX, kAccelMisalignmentZY}}}};

/// Splits what the job states of a kind: `left` of it is the calibration's.
void Split(const ErrorKind& kind, double left, ErrorCovariance& cov, double& stated) {
  // As files round it: a job repeats what a calibration says to six digits and more.
  constexpr double kSame = 1e-6;
  if (!(left > 0)) return;
  if (stated < left * (1 - kSame)) {
    const auto shrink = [&](int source) {
      for (ErrorMatrix* matrix : {&cov.constant, &cov.change, &cov.constant_with_change}) {
        matrix->row(source) *= stated / left;
        matrix->col(source) *= stated / left;
      }
    };
    for (const ErrorSource source : std::span(kind.sources).first(kind.count)) shrink(source);
    for (int source = kind.from; source < kErrorSources; ++source) shrink(source);
  }
  const double beyond = stated * stated - left * left;
  stated = beyond > kSame * left * left * 2 ? std::sqrt(beyond) : 0;
}

}  // namespace

std::vector<ToolUse> UsesOf(const RunHistory& history) {
  // Within a sixteenth of the run a temperature that rises evenly stays within 1 / (16 sqrt(12)) =
  // 1.8 % (1 sigma) of its whole rise about the value used.
  constexpr std::size_t kParts = 16;
  const std::vector<RunKnot>& knots = history.knots;
  std::vector<ToolUse> uses;
  for (std::size_t part = 0; part < kParts && !knots.empty(); ++part) {
    const std::size_t first = part * knots.size() / kParts;
    const std::size_t last = (part + 1) * knots.size() / kParts;
    const std::size_t end = std::min(last, knots.size() - 1), k = (first + end) / 2;
    if (last == first) continue;
    const double seconds = (knots[end].utc - knots[first].utc).seconds();
    const double warmer = static_cast<double>(knots[end].temperature - knots[first].temperature);
    const double I = k < history.attitude.size() ? history.attitude[k].inclination : 0;
    uses.push_back({.share = 1,
                    .temperature = static_cast<double>(knots[k].temperature),
                    .heating = seconds > 0 ? warmer / seconds : 0,
                    .axial_force = -history.site.gravity * std::cos(I)});
  }
  for (ToolUse& use : uses) use.share /= static_cast<double>(uses.size());
  return uses;
}

void TakeCalibration(const Job& job, const RunHistory& history, EstimateSetup& setup) {
  if (!job.tool) return;
  setup.cov_errors = ErrorsInUse(*job.tool, UsesOf(history));
  if (!setup.cov_errors) return;
  const ErrorPriors left = ErrorsLeft(*job.tool, ErrorPriors{});
  for (const ErrorKind& kind : kKinds) {
    Split(kind, left.*kind.sigma, *setup.cov_errors, setup.errors.*kind.sigma);
  }
}

}  // namespace wellgyro
