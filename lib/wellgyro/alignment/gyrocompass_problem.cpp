#include <algorithm>
#include <cmath>
#include <complex>

#include "wellgyro/alignment/gyrocompass_internal.h"
#include "wellgyro/base/units.h"
#include "wellgyro/earth/earth_rate.h"
#include "wellgyro/math/drift.h"
#include "wellgyro/math/linear_algebra.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/math/so3.h"
#include "wellgyro/record/force_errors.h"
#include "wellgyro/record/unknown_angle.h"

namespace wellgyro::gyrocompass {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

// Keep exact data regular: 4e-5 deg of azimuth at the equator, 1e-7 rad of tilt.
constexpr double kSigmaLeastRate = 1e-5 * units::kDegPerHour;
constexpr double kSigmaLeastForce = 1e-6;  // [m/s^2]
// Where toolfaces separate it: seven times the Earth's rate is no information beside theirs.
constexpr double kSigmaFreeBias = 100 * units::kDegPerHour;
// [m/s^2], a tenth of gravity: |f| says nothing of direction.
constexpr double kSigmaFreeGravity = 1;

double Toolface(const Vector3d& f) { return std::atan2(-f.y(), f.x()); }
double Inclination(const Vector3d& f) { return std::atan2(std::hypot(f.x(), f.y()), -f.z()); }

/// What each error of unit size does to the rates of a tool that feels the Earth's rate e and the
/// specific force f, but for the latitude.
std::array<Vector3d, kErrors> Effects(const Vector3d& e, const Vector3d& f) {
  std::array<Vector3d, kErrors> effect;
  effect.fill(Vector3d::Zero());
  effect[kBiasX] = Vector3d::UnitX();
  effect[kBiasY] = Vector3d::UnitY();
  effect[kBiasZ] = Vector3d::UnitZ();
  effect[kMass] = Vector3d(f.x(), f.y(), 0);
  effect[kQuadrature] = Vector3d(f.y(), -f.x(), 0);
  effect[kRoll] = Vector3d(e.y(), -e.x(), 0);
  effect[kScaleX] = Vector3d(e.x(), 0, 0);
  effect[kScaleY] = Vector3d(0, e.y(), 0);
  effect[kMisX] = Vector3d(e.z(), 0, 0);
  effect[kMisY] = Vector3d(0, e.z(), 0);
  return effect;
}

}  // namespace

Problem::Problem(std::span<const StillWindow> windows, const Site& site,
                 const GyrocompassSetup& setup)
    : windows_(windows),
      latitude_(site.latitude),
      gravity_(0),
      axes_(std::ranges::all_of(windows, &StillWindow::has_gz) ? 3 : 2),
      count_(static_cast<Index>(windows.size())),
      errors_at_(count_ + 2) {
  for (const StillWindow& window : windows) {
    gravity_ += window.f_T.norm() / static_cast<double>(count_);
  }
  whiten_force_ = Cholesky(ForceCovariance(setup.errors));
  for (int i = 0; i < axes_; ++i) {
    whiten_rate_[static_cast<std::size_t>(i)] = Cholesky(RateCovariance(i, setup.gyro));
  }
  ChooseErrors(setup);
}

/// Noise of the windows' means, with what the bias does from one window to the next.
MatrixXd Problem::RateCovariance(int axis, const NoiseCoefficients& gyro) const {
  MatrixXd cov(count_, count_);
  const auto middle = [&](Index k) {
    const StillWindow& w = windows_[static_cast<std::size_t>(k)];
    const StillWindow& first = windows_[0];
    const double since = w.samples > 0 ? (w.begin - first.begin).seconds()
                                       : (w.utc_begin - first.utc_begin).seconds();
    return since + w.seconds() / 2;
  };
  const double walk = gyro.rate_random_walk * gyro.rate_random_walk;
  for (Index i = 0; i < count_; ++i) {
    for (Index j = 0; j < count_; ++j) {
      const double apart = std::abs(middle(i) - middle(j));
      // A rate random walk from the first window on.
      const double walked = std::max(0.0, std::min(middle(i), middle(j)) - middle(0));
      double bias = gyro.bias_instability * gyro.bias_instability;
      if (const auto& tc = gyro.bias_instability_correlation_time; tc && *tc > 0) {
        bias *= kMarkovSigmaPerInstability * kMarkovSigmaPerInstability * std::exp(-apart / *tc);
      }
      cov(i, j) = bias + walk * walked;
    }
    const StillWindow& w = windows_[static_cast<std::size_t>(i)];
    const double seconds = std::max(w.seconds(), 1e-3);
    const double given = w.sigma_w_IT_T[axis];
    const double model = std::hypot(gyro.angle_random_walk / std::sqrt(seconds),
                                    std::sqrt(2.0) * gyro.quantization / seconds);
    const double sigma = std::max(given > 0 ? given : model, kSigmaLeastRate);
    cov(i, i) += sigma * sigma + walk * seconds / 3;
  }
  return cov;
}

/// What the accelerometers read wrongly all the time goes round with the tool, and is common to the
/// windows: integrated out, its share in each by the force that was read there.
MatrixXd Problem::ForceCovariance(const ErrorPriors& errors) const {
  MatrixXd by(3 * count_, kForceErrors);
  VectorXd noise(3 * count_);
  for (Index k = 0; k < count_; ++k) {
    const StillWindow& window = windows_[static_cast<std::size_t>(k)];
    const double model = errors.accel_noise / std::sqrt(std::max(window.seconds(), 1e-3));
    for (int i = 0; i < 3; ++i) {
      const double given = window.sigma_f_T[i];
      noise[3 * k + i] = std::max(given > 0 ? given : model, kSigmaLeastForce);
    }
    by.middleRows<3>(3 * k) = ForceErrors(errors, window.f_T);
  }
  MatrixXd cov = by * by.transpose();
  cov.diagonal() += noise.cwiseAbs2();
  return cov;
}

/// Whether the windows' toolfaces differ enough to tell a gyro's bias from the Earth's rate: two of
/// them by 52 deg, cos 26 deg = 0.9.
bool Problem::Separated() const {
  std::complex<double> mean = 0;
  for (const StillWindow& window : windows_) mean += std::polar(1.0, Toolface(window.f_T));
  return std::abs(mean) < 0.9 * static_cast<double>(count_);
}

void Problem::ChooseErrors(const GyrocompassSetup& setup) {
  const ErrorPriors& e = setup.errors;
  double bias = e.gyro_bias_sigma;
  if (bias == 0 && Separated()) bias = kSigmaFreeBias;
  sigma_[kBiasX] = sigma_[kBiasY] = bias;
  sigma_[kBiasZ] = axes_ == 3 ? e.gyro_bias_sigma : 0;
  sigma_[kMass] = e.mass_unbalance_sigma;
  sigma_[kQuadrature] = e.quadrature_sigma;
  sigma_[kGravity] = kSigmaFreeGravity;
  sigma_[kLatitude] = e.latitude_sigma;
  sigma_[kRoll] = ToolfaceOffsetSigma(e);
  sigma_[kScaleX] = sigma_[kScaleY] = e.gyro_scale_sigma;
  sigma_[kMisX] = sigma_[kMisY] = e.gyro_misalignment_sigma;
  if (axes_ == 2) {
    known_[kMisX] = e.gyro_misalignment_x;
    known_[kMisY] = e.gyro_misalignment_y;
  }
  column_.fill(-1);
  for (int i = 0; i < kErrors; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (!(sigma_[at] > 0)) continue;
    column_[at] = errors_at_ + static_cast<Index>(free_.size());
    free_.push_back(static_cast<Error>(i));
  }
}

State Problem::Start(double azimuth) const {
  State state;
  const double toolface = Toolface(windows_[0].f_T);
  state.R_LT = AttitudeMatrix(azimuth, Inclination(windows_[0].f_T), toolface);
  for (const StillWindow& window : windows_) {
    state.roll.push_back(WrapPi(Toolface(window.f_T) - toolface));
  }
  return state;
}

State Problem::Moved(const State& state, const VectorXd& step) const {
  State moved = state;
  moved.R_LT = Exp(step.head<3>()) * state.R_LT;
  for (Index k = 1; k < count_; ++k) moved.roll[static_cast<std::size_t>(k)] += step[k + 2];
  for (const Error e : free_) moved.error[e] += step[column_[e]] * sigma_[e];
  return moved;
}

void Problem::Forces(const State& state, System& system) const {
  MatrixXd raw = MatrixXd::Zero(3 * count_, unknowns());  // by window, then axis
  VectorXd r(3 * count_);
  for (Index k = 0; k < count_; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const Matrix3d R_TL = state.R_LT_at(at).transpose();
    const double g = gravity_ + state.error[kGravity];
    const Vector3d up(0, 0, -g);
    const Vector3d f = R_TL * up;
    r.segment<3>(3 * k) = windows_[at].f_T - f;
    auto J = raw.middleRows<3>(3 * k);
    J.leftCols<3>() = R_TL * Skew(up);
    if (k > 0) J.col(k + 2) = Vector3d(f.y(), -f.x(), 0);
    J.col(column_[kGravity]) = f / g * sigma_[kGravity];
  }
  const Index row = axes_ * count_;
  system.r.segment(row, 3 * count_) = whiten_force_.Whitened(r);
  system.J.middleRows(row, 3 * count_) = whiten_force_.Whitened(raw);
}

void Problem::Rates(const State& state, System& system) const {
  MatrixXd raw = MatrixXd::Zero(axes_ * count_, unknowns());  // by axis, then window
  VectorXd r(axes_ * count_);
  const auto& x = state.error;
  const double latitude = latitude_ + x[kLatitude];
  const Vector3d earth = EarthRateAt(latitude);
  const Vector3d d_latitude = -kEarthRate * Vector3d(std::sin(latitude), 0, std::cos(latitude));
  for (Index k = 0; k < count_; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const Matrix3d R_TL = state.R_LT_at(at).transpose();
    const Vector3d e = R_TL * earth;
    const Vector3d f = R_TL * Vector3d(0, 0, -gravity_ - x[kGravity]);
    std::array<Vector3d, kErrors> effect = Effects(e, f);
    Vector3d model = e;
    for (std::size_t i = 0; i < kErrors; ++i) model += (known_[i] + x[i]) * effect[i];
    effect[kLatitude] = R_TL * d_latitude;
    const Matrix3d d_attitude = R_TL * Skew(earth);
    const Vector3d d_roll(e.y(), -e.x(), 0);
    for (int i = 0; i < axes_; ++i) {
      const Index row = i * count_ + k;
      r[row] = windows_[at].w_IT_T[i] - model[i];
      raw.row(row).head<3>() = d_attitude.row(i);
      if (k > 0) raw(row, k + 2) = d_roll[i];
      for (const Error error : free_) raw(row, column_[error]) = effect[error][i] * sigma_[error];
    }
  }
  for (int i = 0; i < axes_; ++i) {
    const Cholesky& root = whiten_rate_[static_cast<std::size_t>(i)];
    system.r.segment(i * count_, count_) = root.Whitened(r.segment(i * count_, count_));
    system.J.middleRows(i * count_, count_) = root.Whitened(raw.middleRows(i * count_, count_));
  }
}

Problem::System Problem::Linear(const State& state) const {
  const Index priors = static_cast<Index>(free_.size());
  const Index rows = (axes_ + 3) * count_ + priors;
  System system{MatrixXd::Zero(rows, unknowns()), VectorXd::Zero(rows)};
  Rates(state, system);
  Forces(state, system);
  for (Index i = 0; i < priors; ++i) {
    const Error e = free_[static_cast<std::size_t>(i)];
    system.J(rows - priors + i, column_[e]) = 1;
    system.r[rows - priors + i] = -state.error[e] / sigma_[e];
  }
  return system;
}

/// Normal matrix. Directions of the attitude that no window sees are kept from being singular; at
/// a minimum this moves nothing.
MatrixXd Problem::Normal(const MatrixXd& J) const {
  MatrixXd normal = J.transpose() * J;
  normal.diagonal().head(errors_at_).array() += 1 / kUnknownAngleVariance;
  return normal;
}

double Problem::Profile(double azimuth) const {
  System system = Linear(Start(azimuth));
  system.J.col(2).setZero();  // the heading
  const VectorXd right = system.J.transpose() * system.r;
  const VectorXd step = SolveSymmetric(Normal(system.J), right);
  return (system.r - system.J * step).squaredNorm();
}

Solution Problem::Descend(State state) const {
  double cost = Residual(state).squaredNorm();
  MatrixXd normal;
  for (int iteration = 0; iteration < 50; ++iteration) {
    const System system = Linear(state);
    normal = Normal(system.J);
    VectorXd step = SolveSymmetric(normal, system.J.transpose() * system.r);
    const double turn = step.head<3>().norm();
    if (turn > 0.2) step *= 0.2 / turn;
    double next_cost = 0;
    State next;
    for (int halving = 0; halving < 12; ++halving, step /= 2) {
      next = Moved(state, step);
      next_cost = Residual(next).squaredNorm();
      if (next_cost <= cost) break;
    }
    if (!(next_cost <= cost)) break;
    const bool done = step.cwiseAbs().maxCoeff() < 1e-10 && cost - next_cost < 1e-9;
    state = next;
    cost = next_cost;
    if (done) break;
  }
  normal = Normal(Linear(state).J);
  return {state, cost, InverseOfSymmetric(normal)};
}

std::optional<std::pair<double, double>> Problem::Alone(const Solution& solution,
                                                        Error error) const {
  const Index at = column_[error];
  if (at < 0) return std::nullopt;
  // In units of the prior: posterior information = the data's + 1.
  const double variance = solution.cov(at, at);
  const double data = 1 / variance - 1;
  if (!(data > 0.5)) return std::nullopt;
  const double value = solution.state.error[error] / variance / data;
  return std::pair(value, sigma_[error] / std::sqrt(data));
}

std::pair<double, double> Problem::RateRatio(const State& state) const {
  const System system = Linear(state);
  const Vector3d earth = EarthRateAt(latitude_ + state.error[kLatitude]);
  const Index n = unknowns();
  MatrixXd J = MatrixXd::Zero(system.J.rows(), n + 1);
  J.leftCols(n) = system.J;
  for (int i = 0; i < axes_; ++i) {
    VectorXd rate(count_);
    for (Index k = 0; k < count_; ++k) {
      rate[k] = (state.R_LT_at(static_cast<std::size_t>(k)).transpose() * earth)[i];
    }
    J.col(n).segment(i * count_, count_) = whiten_rate_[static_cast<std::size_t>(i)].Whitened(rate);
  }
  MatrixXd normal = Normal(J);
  normal(n, n) += 1e-4;
  const MatrixXd cov = InverseOfSymmetric(normal);
  return {1 + cov.row(n).dot(J.transpose() * system.r), std::sqrt(cov(n, n))};
}

double HeadingFrom(const State& b, const State& a) {
  return AngleAboutZ(a.R_LT * b.R_LT.transpose());
}

}  // namespace wellgyro::gyrocompass
