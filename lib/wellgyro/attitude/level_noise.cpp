#include "wellgyro/attitude/level_noise.h"

#include <algorithm>
#include <cmath>

#include "wellgyro/base/angle.h"

namespace wellgyro {
namespace {

// The integral of the fitted acceleration errs by so much more than the fitted speed, with
// M_k = integral of u^2 (1 - u^2)^k over [-1, 1]: sqrt(M_4 / M_2^2 / (M_2 / M_1^2)).
constexpr double kIntegral = 1.2185;
constexpr double kDamping = 0.3;
constexpr double kFrequency = 0.9539392;  // damped by undamped, sqrt(1 - 0.3^2)
// Twice the correlation time of what is left beside the linear part, by that of the swing: 0.475
// for its first term, the third Hermite polynomial (by the cube of the autocorrelation), less for
// those that follow.
constexpr double kLeftTime = 0.35;
constexpr double kCancels = 2.5;  // phase of the swing over which what is trusted evens out

struct Error {
  double speed = 0;  // sigma of the integral of the acceleration [m/s]
  double fast = 0;   // of its swing [rad/s]
};

Error ErrorOf(const AlongHole& along) {
  if (!along.known || !(along.sigma_speed > 0)) return {};
  const double speed = kIntegral * along.sigma_speed;
  return {speed, along.sigma_acceleration / speed};
}

// From speed and acceleration, by their sigmas, to those after a phase.
Eigen::Matrix2d Swing(double phase) {
  const double c = std::cos(kFrequency * phase), s = std::sin(kFrequency * phase) / kFrequency;
  Eigen::Matrix2d on;
  on << c + kDamping * s, s, -s, c - kDamping * s;
  return std::exp(-kDamping * phase) * on;
}

// Of x / (c + (s x)^2) for a normal x: the linear share, and the variance beside it.
struct Heard {
  double share, left;
};
Heard HeardOf(double c, double s) {
  const double q = std::sqrt(c) / s, q2 = q * q;
  if (q > 10) return {(1 - 3 / q2) / c, 6 / (c * c * q2 * q2)};
  const double mills = std::sqrt(kPi / 2) * std::exp(0.5 * q2) * std::erfc(q * std::sqrt(0.5));
  const double share = (1 - q * mills) / (s * s);
  const double square = q * (mills * (1 + q2) - q) / (2 * c * s * s);
  return {share, std::max(0.0, square - share * share)};
}

}  // namespace

void LevelNoise::Take(const Block& block, const AlongHole& along) {
  // The first sample's value is taken in full, however little of it is summed yet.
  const double level = begun_ ? block.level : 1;
  begun_ = true;
  const Error error = ErrorOf(along);
  double share = 1, left = 0;
  const double sigma = along.sigma_acceleration;
  const bool scatter = std::abs(along.acceleration) < 3 * sigma;
  if (error.speed > 0 && scatter && block.trust > 0) {
    const Heard heard = HeardOf(block.quiet, sigma / block.reach);
    const double x = error.fast * block.span / kCancels, f = 1 - std::exp(-x * x);
    share += f * (heard.share / block.trust - 1);
    left = f * heard.left / (block.trust * block.trust) * sigma * sigma *
           std::min(kLeftTime / error.fast, block.span) / block.seconds;
  }
  const Eigen::Matrix2d on = Swing(error.fast * block.seconds);
  // Of inclination, its rate, speed before, speed and acceleration after.
  Eigen::Matrix<double, 5, 5> joint;
  joint.topLeftCorner<3, 3>() = cov_.topLeftCorner<3, 3>();
  joint.bottomLeftCorner<2, 3>() = on * cov_.bottomLeftCorner<2, 3>();
  joint.topRightCorner<3, 2>() = joint.bottomLeftCorner<2, 3>().transpose();
  joint.bottomRightCorner<2, 2>().setIdentity();
  const double turned = block.rate / block.seconds;
  const double grown = share * block.per_force * error.speed / block.seconds;
  Eigen::Matrix<double, 4, 5> step = Eigen::Matrix<double, 4, 5>::Zero();
  step.row(0) << 1 - level, block.seconds * (1 - 0.5 * level), -level * grown, level * grown, 0;
  step.row(1) << -turned, 1 - 0.5 * block.rate, -turned * grown, turned * grown, 0;
  step(2, 3) = step(3, 4) = 1;
  cov_ = step * joint * step.transpose();
  const double white = block.psd_accel / block.seconds + left * block.per_force * block.per_force;
  const Eigen::Vector2d gains(level, turned);
  cov_.topLeftCorner<2, 2>() += white * gains * gains.transpose();
  cov_(0, 0) += block.psd_gyro * block.seconds;
}

void LevelNoise::Break() {
  cov_.topRightCorner<2, 2>().setZero();
  cov_.bottomLeftCorner<2, 2>().setZero();
}

double LevelNoise::MeanVariance(const AlongHole& begin, const AlongHole& end, double seconds) {
  const Error a = ErrorOf(begin), b = ErrorOf(end);
  const double alike = Swing(0.5 * (a.fast + b.fast) * seconds)(0, 0);
  const double grown = b.speed - a.speed;
  return (grown * grown + 2 * a.speed * b.speed * (1 - alike)) / (seconds * seconds);
}

}  // namespace wellgyro
