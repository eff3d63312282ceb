#include "wellgyro/uncertainty/allan_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/drift.h"
#include "wellgyro/uncertainty/gyro_mode.h"
#include "wellgyro/uncertainty/hole_arc_internal.h"
#include "wellgyro/uncertainty/survey_check_internal.h"

namespace wellgyro {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Matrix24 = Eigen::Matrix<double, 2, 4>;

double TurnFactor(GyroAxes axes, const Vector3d& t) {
  switch (axes) {
    case GyroAxes::kXy:
      return t.head<2>().norm();
    case GyroAxes::kZ:
      return t.z();
    case GyroAxes::kXyz:
      break;
  }
  return 1;
}

/// One point of the hole as the gyro feels it.
struct Feel {
  double gain = 0;             ///< a
  Vector2d lever, lever_rate;  ///< d r / (A ds) [1] and its change per metre
};

Feel FeelAt(GyroAxes axes, const HoleArc& arc, double s) {
  const Vector3d t = arc.Tangent(s), bend = arc.Bend(s);
  return {1 / TurnFactor(axes, t), {-t.y(), t.x()}, {-bend.y(), bend.x()}};
}

/// One coefficient: its drift's state (azimuth error and rate) with the position error it has made.
struct Process {
  std::string name;
  DriftCoefficients drift;
  double sigma_azimuth = 0;  ///< a fix's own [rad]
  double quantization = 0;   ///< [rad]
  Matrix4d cov_x = Matrix4d::Zero();
  Matrix24 cov_rx = Matrix24::Zero();
  Matrix2d cov_r = Matrix2d::Zero();
  double gain = 0;  ///< where it is
};

void Forget(Process& p, int state) {
  p.cov_x.row(state).setZero();
  p.cov_x.col(state).setZero();
  p.cov_rx.col(state).setZero();
}

void Fix(Process& p, double gain) {
  Forget(p, kDriftIntegral);
  const bool from_here = p.drift.rate_random_walk > 0 || p.drift.rate_ramp > 0;
  if (from_here) Forget(p, kDriftLevel);
  p.cov_x(kDriftIntegral, kDriftIntegral) =
      p.sigma_azimuth * p.sigma_azimuth + gain * gain * p.quantization * p.quantization;
}

void Leave(Process& p) {
  Forget(p, kDriftIntegral);
  p.gain = 0;
}

/// No turn is felt: the rate goes on.
void Rest(Process& p, double seconds) {
  const DriftStep step = DriftOver(p.drift, 0, seconds);
  p.cov_rx = p.cov_rx * step.transition.transpose();
  p.cov_x = step.transition * p.cov_x * step.transition.transpose() + step.noise;
}

/// Variance of an integral of the azimuth error, given azimuth error and rate at its ends, per
/// square of the speed: of a walk (a Brownian bridge), and of a walk of the rate. A Gauss-Markov
/// rate is such a walk over steps that are short against its correlation time.
double Untold(const DriftCoefficients& drift, double square_gain, double seconds) {
  const double white = drift.angle_random_walk * drift.angle_random_walk;
  double walk = drift.rate_random_walk * drift.rate_random_walk;
  if (drift.correlation_time) {
    const double sigma = kMarkovSigmaPerInstability * drift.bias_instability;
    walk += 2 * sigma * sigma / *drift.correlation_time;
  }
  const double cube = seconds * seconds * seconds;
  return square_gain * (white * cube / 12 + walk * cube * seconds * seconds / 720);
}

/// Over `length` from `begin` to `end`, with gains that are means along the step. The lever arm's
/// integral is the trapezoid with its end correction, exact for cubics; white noise adds the part
/// of its integral that its ends do not tell.
void Run(Process& p, const Feel& begin, const Feel& end, double mean_gain, double mean_square_gain,
         double length, double speed) {
  const bool white = p.drift.angle_random_walk > 0;
  const double seconds = length / speed;
  const DriftStep step =
      DriftOver(p.drift, white ? std::sqrt(mean_square_gain) : mean_gain, seconds);
  const double half = length / 2, twelfth = length * length / 12;
  Matrix24 from_begin = Matrix24::Zero(), from_end = Matrix24::Zero();
  from_begin.col(kDriftIntegral) = half * begin.lever + twelfth * begin.lever_rate;
  from_end.col(kDriftIntegral) = half * end.lever - twelfth * end.lever_rate;
  for (const int rate : {kDriftLevel, kDriftMarkov}) {
    from_begin.col(rate) = twelfth * begin.gain / speed * begin.lever;
    from_end.col(rate) = -twelfth * end.gain / speed * end.lever;
  }
  const Matrix24 b = from_begin + from_end * step.transition;
  const Matrix24 noise_b = from_end * step.noise;
  const Matrix2d cross = p.cov_rx * b.transpose();
  p.cov_r +=
      cross + cross.transpose() + b * p.cov_x * b.transpose() + noise_b * from_end.transpose();
  const Vector2d lever = (begin.lever + end.lever) / 2;
  p.cov_r += Untold(p.drift, mean_square_gain, seconds) * speed * speed * lever * lever.transpose();
  p.cov_rx = ((p.cov_rx + b * p.cov_x) * step.transition.transpose() + noise_b).eval();
  p.cov_x = (step.transition * p.cov_x * step.transition.transpose() + step.noise).eval();
  p.gain = end.gain;
}

std::vector<Process> ProcessesOf(const AllanRun& run) {
  const NoiseCoefficients& n = run.noise;
  std::vector<Process> all;
  const auto add = [&](const char* name, double coefficient, auto set) {
    if (!(coefficient > 0)) return;
    Process p;
    p.name = name;
    set(p);
    p.cov_x = DriftPrior(p.drift);
    all.push_back(std::move(p));
  };
  add("ALLAN-Q", n.quantization, [&](Process& p) { p.quantization = n.quantization; });
  add("ALLAN-N", n.angle_random_walk,
      [&](Process& p) { p.drift.angle_random_walk = n.angle_random_walk; });
  add("ALLAN-B", n.bias_instability, [&](Process& p) {
    p.drift.bias_instability = n.bias_instability;
    p.drift.correlation_time = n.bias_instability_correlation_time;
  });
  add("ALLAN-K", n.rate_random_walk,
      [&](Process& p) { p.drift.rate_random_walk = n.rate_random_walk; });
  add("ALLAN-R", n.rate_ramp, [&](Process& p) { p.drift.rate_ramp = n.rate_ramp; });
  add("FIX", run.sigma_azimuth, [&](Process& p) { p.sigma_azimuth = run.sigma_azimuth; });
  return all;
}

class AllanPropagator {
 public:
  AllanPropagator(std::span<const SurveyPoint> survey, const AllanRun& run)
      : survey_(survey), run_(run), processes_(ProcessesOf(run)) {
    for (const Process& p : processes_) result_.terms.push_back({p.name, {}, {}});
  }

  AllanUncertainty Run() {
    const bool opens = run_.initialise < 0 || survey_[0].inclination > run_.initialise;
    if (opens && !Open(HoleArc(survey_[0], survey_[1]), 0, 0)) return std::move(result_);
    Give();
    for (std::size_t k = 1; k < survey_.size(); ++k) {
      if (!Leg(k)) break;
      Give();
    }
    return std::move(result_);
  }

 private:
  bool Leg(std::size_t k) {
    const HoleArc arc(survey_[k - 1], survey_[k]);
    std::vector<double>& cuts = cuts_;
    cuts.assign(1, 0);
    if (run_.initialise >= 0) arc.Crossings(run_.initialise, cuts);
    cuts.push_back(arc.length());
    for (std::size_t i = 1; i < cuts.size(); ++i) {
      const double from = cuts[i - 1], to = cuts[i];
      if (to <= from) continue;
      const bool above =
          run_.initialise < 0 || arc.Tangent((from + to) / 2).z() < std::cos(run_.initialise);
      if (!Piece(arc, from, to, above, k)) return false;
    }
    return true;
  }

  bool Piece(const HoleArc& arc, double from, double to, bool above, std::size_t k) {
    if (!above) {
      if (open_) {
        for (Process& p : processes_) Leave(p);
      }
      open_ = false;
      for (Process& p : processes_) Rest(p, (to - from) / run_.speed);
      return true;
    }
    if (!open_ && !Open(arc, from, k)) return false;
    const int steps = StepsOn(arc, from, to);
    if (steps == 0) return Refuse(k);
    const double length = (to - from) / steps;
    Feel begin = FeelAt(run_.axes, arc, from);
    for (int i = 0; i < steps; ++i) {
      const double s = from + i * length;
      const Feel middle = FeelAt(run_.axes, arc, s + length / 2);
      const Feel end = FeelAt(run_.axes, arc, s + length);
      const auto mean = [&](auto f) {  // Simpson
        return (f(begin.gain) + 4 * f(middle.gain) + f(end.gain)) / 6;
      };
      const double gain = mean([](double a) { return a; });
      const double square = mean([](double a) { return a * a; });
      for (Process& p : processes_) {
        ::wellgyro::Run(p, begin, end, gain, square, length, run_.speed);
      }
      begin = end;
    }
    return true;
  }

  bool Open(const HoleArc& arc, double at, std::size_t k) {
    const double factor = TurnFactor(run_.axes, arc.Tangent(at));
    if (factor < kSmallestTurnFactor) return Refuse(k);
    for (Process& p : processes_) {
      Fix(p, 1 / factor);
      p.gain = 1 / factor;
    }
    open_ = true;
    return true;
  }

  /// 0 where the gyro does not feel the turn somewhere on the way.
  int StepsOn(const HoleArc& arc, double from, double to) const {
    // Truncation in a step of relative change x: means for gains x^2 / 12 = 1.3e-6 of a variance,
    // the lever's trapezoid with end corrections x^4 / 720 = 1.3e-10. From kSmallestTurnFactor to
    // 1, the most, ln(100) / kMost = 1.2 % a step, 1.1e-5.
    constexpr double kGainChange = 0.004, kDogleg = 1.0 * kPi / 180;
    constexpr int kProbes = 8, kMost = 400;
    double change = 0, last = 0;
    for (int i = 0; i <= kProbes; ++i) {
      const double factor = TurnFactor(run_.axes, arc.Tangent(from + (to - from) * i / kProbes));
      if (factor < kSmallestTurnFactor) return 0;
      if (i > 0) change = std::max(change, kProbes * std::abs(std::log(factor / last)));
      last = factor;
    }
    double steps = std::max(change / kGainChange, arc.Dogleg(to - from) / kDogleg);
    if (const auto tc = run_.noise.bias_instability_correlation_time) {
      steps = std::max(steps, 4 * (to - from) / run_.speed / *tc);
    }
    return static_cast<int>(std::clamp(std::ceil(steps), 1.0, double{kMost}));
  }

  bool Refuse(std::size_t k) {
    result_.refusal = Refusal{k,
                              {},
                              "MD " + std::to_string(survey_[k].md) +
                                  " m: the gyro's axes do not feel the turn of the hole on "
                                  "the way to this station"};
    return false;
  }

  void Give() {
    Matrix3d total = Matrix3d::Zero();
    double azimuth = 0;
    for (std::size_t i = 0; i < processes_.size(); ++i) {
      const Process& p = processes_[i];
      Matrix3d cov = Matrix3d::Zero();
      cov.topLeftCorner<2, 2>() = p.cov_r;
      const double step = open_ ? p.gain * p.quantization : 0;
      const double var = p.cov_x(kDriftIntegral, kDriftIntegral) + step * step;
      result_.terms[i].cov_p_W.push_back(cov);
      result_.terms[i].var_azimuth.push_back(var);
      total += cov;
      azimuth += var;
    }
    result_.cov_p_W.push_back(total);
    result_.var_azimuth.push_back(azimuth);
  }

  std::span<const SurveyPoint> survey_;
  const AllanRun& run_;
  std::vector<Process> processes_;
  std::vector<double> cuts_;
  bool open_ = false;
  AllanUncertainty result_;
};

void CheckRun(const AllanRun& run) {
  const auto check = [](const char* name, double value, bool good) {
    if (!std::isfinite(value) || !good) {
      throw std::invalid_argument(std::string(name) + ": " + std::to_string(value));
    }
  };
  const NoiseCoefficients& n = run.noise;
  check("speed", run.speed, run.speed > 0);
  check("initialise", run.initialise, run.initialise <= kPi);
  check("sigma_azimuth", run.sigma_azimuth, run.sigma_azimuth >= 0);
  check("quantization", n.quantization, n.quantization >= 0);
  check("angle_random_walk", n.angle_random_walk, n.angle_random_walk >= 0);
  check("bias_instability", n.bias_instability, n.bias_instability >= 0);
  check("rate_random_walk", n.rate_random_walk, n.rate_random_walk >= 0);
  check("rate_ramp", n.rate_ramp, n.rate_ramp >= 0);
  if (const auto tc = n.bias_instability_correlation_time) check("correlation time", *tc, *tc > 0);
}

}  // namespace

AllanUncertainty AllanErrors(std::span<const SurveyPoint> survey, const AllanRun& run) {
  CheckSurvey(survey);
  CheckRun(run);
  return AllanPropagator(survey, run).Run();
}

PrintedAllan PrintedAllanModel(const AllanRun& run) {
  CheckRun(run);
  const NoiseCoefficients& n = run.noise;
  const std::string gyro = run.axes == GyroAxes::kXy  ? "GXY"
                           : run.axes == GyroAxes::kZ ? "GZ"
                                                      : "GXYZ";
  PrintedAllan printed;
  ErrorModel& model = printed.model;
  model.name = "Allan, printed form";
  model.max_inclination = kPi;
  model.vertical_limit = FromDegrees(1e-4);
  model.continuous.push_back({run.axes, std::max(0.0, run.initialise), kPi, run.speed});
  StationaryMode rest;
  rest.axes = run.axes;
  rest.end = std::max(0.0, run.initialise);
  rest.initialise = run.initialise;
  model.stationary = rest;
  const auto add = [&](const char* name, const std::string& code, double magnitude) {
    model.terms.push_back({name, FindWeight(code), magnitude, Propagation::kSystematic});
  };
  add("ALLAN-N", gyro + "-GRW", n.angle_random_walk);
  add("ALLAN-B", gyro + "-GD", n.bias_instability);
  if (n.rate_random_walk > 0) add("ALLAN-K", gyro + "-GRR", n.rate_random_walk);
  if (n.rate_ramp > 0) add("ALLAN-R", gyro + "-GR", n.rate_ramp);
  if (run.sigma_azimuth > 0) add("FIX", "AZ", run.sigma_azimuth);
  if (n.quantization > 0) printed.left_out.emplace_back("ALLAN-Q");
  return printed;
}

}  // namespace wellgyro
