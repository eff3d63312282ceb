#include <cmath>

#include "wellgyro/base/angle.h"
#include "wellgyro/fit/nonlinear_internal.h"
#include "wellgyro/fit/trigonometric_fit_internal.h"
#include "wellgyro/math/statistics.h"

namespace wellgyro {
namespace {

struct WaveResidual {
  double angle, error;
  template <class T>
  bool operator()(const T* const* p, T* r) const {
    const T* x = p[0];
    using std::sin;
    r[0] = x[0] * sin(x[1] * angle + x[2]) + x[3] - error;
    return true;
  }
};

Eigen::VectorXd Normalised(Eigen::VectorXd x) {
  if (x[0] < 0) {
    x[0] = -x[0];
    x[2] += kPi;
  }
  x[2] = WrapPi(x[2]);
  return x;
}

Wave WaveOf(const FitReport& report, bool free) {
  Wave wave;
  for (int j = 0; j < 4; ++j) {
    wave.x[static_cast<std::size_t>(j)] = report.values[j];
    if (report.cov.size() > 0) wave.sigma[j] = std::sqrt(std::max(0.0, report.cov(j, j)));
  }
  wave.scatter = report.scatter;
  wave.free = free;
  return wave;
}

// The wave of frequency 1 with what another frequency would change in its sigmas: their own and, as
// an error, what the free fit makes of it.
Wave Held(Wave fixed, const Wave& free) {
  for (int j = 0; j < 4; ++j) {
    const auto at = static_cast<std::size_t>(j);
    double off = free.x[at] - fixed.x[at];
    if (j == 2) off = WrapPi(off);
    fixed.sigma[j] = std::hypot(free.sigma[j], off);
  }
  return fixed;
}

// Frequency 1: sine and cosine, linear.
FitReport FitFixed(const Eigen::VectorXd& angles, const Eigen::VectorXd& errors,
                   const std::vector<int>& lines) {
  LinearProblem problem({"S", "C", "x4"}, static_cast<int>(angles.size()));
  problem.robust = false;
  for (int i = 0; i < angles.size(); ++i) {
    problem.A.row(i) << std::sin(angles[i]), std::cos(angles[i]), 1;
    problem.y[i] = errors[i];
    problem.rows[static_cast<std::size_t>(i)] = {lines[static_cast<std::size_t>(i)], "wave", 1};
  }
  FitReport report = ReportOf(problem, Solve(problem));
  Reparametrise(report, VectorNames("x", 4), [](const Eigen::VectorXd& p) {
    return Eigen::VectorXd(
        Eigen::Vector4d(std::hypot(p[0], p[1]), 1, std::atan2(p[1], p[0]), p[2]));
  });
  return report;
}

std::optional<FitReport> FitFree(const Eigen::VectorXd& angles, const Eigen::VectorXd& errors,
                                 const std::vector<int>& lines) {
  std::optional<NonlinearProblem::Solution> best;
  for (const double frequency : {0.5, 1.0, 1.5, 2.0}) {
    // Amplitude and phase at this frequency by a linear fit.
    Eigen::VectorXd scaled = frequency * angles;
    const FitReport linear = FitFixed(scaled, errors, lines);
    Eigen::VectorXd start = linear.values;
    start[1] = frequency;
    NonlinearProblem problem(VectorNames("x", 4), start);
    problem.robust = false;
    problem.Bound(1, 0.3, 3);
    for (int i = 0; i < angles.size(); ++i) {
      problem.Add({{lines[static_cast<std::size_t>(i)], "wave", 1}},
                  WaveResidual{angles[i], errors[i]});
    }
    auto solution = problem.Solve();
    if (solution && (!best || solution->cost < best->cost)) best = *std::move(solution);
  }
  if (!best) return std::nullopt;
  const LinearSolution linear = Solve(best->linear);
  if (!linear.unseen.empty()) return std::nullopt;
  FitReport report = ReportOf(best->linear, linear);
  Reparametrise(report, report.parameters, Normalised);
  return report;
}

}  // namespace

Result<Wave> FitWave(const Eigen::VectorXd& angles, const Eigen::VectorXd& errors,
                     const std::vector<int>& lines, bool free_frequency) {
  if (angles.size() < 4) {
    return Fault{.code = FaultCode::kRange,
                 .text = "fewer than four readings in a sequence: measure every 30 deg"};
  }
  const FitReport fixed = FitFixed(angles, errors, lines);
  if (angles.size() < 6) return WaveOf(fixed, false);
  const auto free = FitFree(angles, errors, lines);
  if (!free || free->dof < 1) return WaveOf(fixed, false);
  // One parameter more: F is the square of Student's t. What the last digits carry counts as noise.
  const double digits = std::pow(1e-11 * (1 + errors.cwiseAbs().maxCoeff()), 2);
  const double limit = StudentLimit(0.005, free->dof);
  const double gain = fixed.chi_square - free->chi_square;
  const bool told = gain >= limit * limit * (free->chi_square / free->dof + digits);
  if (told == free_frequency) {
    Wave wave = free_frequency ? WaveOf(*free, true) : WaveOf(fixed, false);
    wave.told = told;
    return wave;
  }
  Wave held = Held(WaveOf(fixed, false), WaveOf(*free, true));
  held.told = told;
  return held;
}

}  // namespace wellgyro
