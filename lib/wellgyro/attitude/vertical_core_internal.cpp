#include "wellgyro/attitude/vertical_core_internal.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/rotation.h"

namespace wellgyro::vertical {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kSineLeast = 1e-6;
constexpr double kAxialFirst = 0.5;     // what a tool may turn at when the filter meets it [rad/s]
constexpr double kBiasLeast = 1e-9;     // of a measured rate about z [rad/s]
constexpr double kLostVariance = 0.25;  // of the heading [rad^2]
constexpr double kLinearVariance = 0.01;  // of it too
constexpr double kLinearTurn = 0.03;      // of the turn about the axis in a gap [rad^2]
constexpr double kRateSeconds = 10;       // over which the Earth's unknown rate would be one [s]
constexpr double kSure = 3;               // sigmas at which what is seen is no error
constexpr double kHeldSeconds = 3;        // at least, that a stop goes on [s]
constexpr double kTiltFirst = 0.03;       // before the first force is taken [rad]

double Square(double x) { return x * x; }

Matrix3d Skew(const Vector3d& v) {
  Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

// Rotation by v, to 1e-12 for the turns of one sample.
Matrix3d Exp(const Vector3d& v) {
  const double n = v.squaredNorm();
  double a = 1 - n / 6 + n * n / 120, b = 0.5 - n / 24 + n * n / 720;
  if (n > 0.01) {
    const double angle = std::sqrt(n);
    a = std::sin(angle) / angle;
    b = (1 - std::cos(angle)) / n;
  }
  const Matrix3d k = Skew(v);
  return Matrix3d::Identity() + a * k + b * k * k;
}

double InverseSinc(double x) {
  const double half = x / 2;
  return std::abs(half) < 1e-3 ? 1 + half * half / 6 : half / std::sin(half);
}

// The rate about z turns the attitude about `z`, and walks.
void AddAxial(double seconds, const Vector3d& z, double walk, Covariance* phi, Covariance* added) {
  const double T = seconds;
  phi->block<3, 1>(kTurn, kAxial) = T * z;
  added->topLeftCorner<3, 3>() += walk * T * T * T / 3 * (z * z.transpose());
  added->block<3, 1>(kTurn, kAxial) = walk * T * T / 2 * z;
  added->block<1, 3>(kAxial, kTurn) = added->block<3, 1>(kTurn, kAxial).transpose();
  (*added)(kAxial, kAxial) = walk * T;
}

// Rounding of thousands of products, once a block.
void Orthonormalize(Matrix3d& R) {
  R.col(0).normalize();
  R.col(1) = (R.col(1) - R.col(0) * R.col(0).dot(R.col(1))).normalized();
  R.col(2) = R.col(0).cross(R.col(1));
}

}  // namespace

Sensed SensedOf(const ImuSample& sample, const AlongHole& along, const Site& site,
                const Heading& heading, const Matrix3d& R_LT) {
  Sensed s;
  s.seconds = 1e-9 * sample.stamp.period_ns;
  s.has_gz = sample.has_gz;
  s.w_IT_T = sample.w_IT_T;
  if (!s.has_gz) s.w_IT_T.z() = 0;
  s.gravity = site.gravity;
  s.accel_good = !sample.stamp.accel_saturated;
  const double horizontal = kEarthRate * std::cos(site.latitude);
  const Vector2d across = horizontal * heading.north;
  s.unknown_rate = horizontal * heading.unsure;
  s.w_IL_L = Vector3d(across.x(), across.y(), -kEarthRate * std::sin(site.latitude));
  s.gravity_T = sample.f_T;
  if (along.known) {
    const Vector3d w = s.w_IT_T + R_LT.transpose() * s.w_IL_L;
    s.gravity_T -= along.speed * Vector3d(w.y(), -w.x(), 0);
    s.gravity_T.z() -= along.acceleration;
    // The level frame turns with the travel over the Earth, taken for a sphere here; about the
    // vertical it then turns by less than 1e-9 rad/s.
    const double radius = (site.radius_north + site.radius_east) / 2;
    s.w_IL_L += along.speed / radius * Vector3d(R_LT(1, 2), -R_LT(0, 2), 0);
  }
  return s;
}

Matrix3d EulerSlopes(const Matrix3d& R_LT) {
  const Vector3d t = R_LT.col(2);
  const double across = std::hypot(t.x(), t.y());
  const double sine = std::max(across, kSineLeast);
  const double ca = across > 0 ? t.x() / across : 1, sa = across > 0 ? t.y() / across : 0;
  const Vector3d h(t.z() * ca, t.z() * sa, -across), r(-sa, ca, 0);
  Matrix3d slopes;
  slopes.row(0) = r.transpose();
  slopes.row(1) = -h.transpose() / sine;
  slopes.row(2) = t.transpose() + h.transpose() * (t.z() / sine);
  return slopes;
}

Eigen::RowVector3d SumSlope(const Matrix3d& R_LT) {
  const Vector3d t = R_LT.col(2);
  // (1 - cos I) / sin I times the high side, less its vertical part: all finite at I = 0.
  const double less = 1 / (1 + t.z());
  const Vector3d h(t.z() * t.x(), t.z() * t.y(), -t.head<2>().squaredNorm());
  return (t - less * h).transpose();
}

void Core::Start(const Sensed& s, const Matrix3d& R_LT, const ErrorPriors& errors,
                 double bias_sigma) {
  *this = Core();
  R_ = R_LT;
  has_gz_ = s.has_gz;
  accel_sigma_ = errors.accel_bias_sigma;
  scale_sigma_ = errors.gyro_scale_sigma;
  Eigen::Matrix<double, kStates, 1> sigma;
  sigma << kTiltFirst, kTiltFirst, 0, s.has_gz ? std::max(bias_sigma, kBiasLeast) : kAxialFirst,
      bias_sigma, bias_sigma, errors.accel_bias_sigma, errors.accel_bias_sigma,
      s.has_gz ? scale_sigma_ : 0;
  cov_ = sigma.cwiseAbs2().asDiagonal();
  cov_noise_ = cov_;
  for (int i = kGyro; i < kScale; ++i) cov_noise_(i, i) = 0;
  sources_(kGyro, Knot::kGyroBiasX) = sources_(kGyro + 1, Knot::kGyroBiasY) = -1;
  sources_(kAccel, Knot::kAccelBiasX) = sources_(kAccel + 1, Knot::kAccelBiasY) = -1;
}

void Core::Predict(const Sensed& s) {
  const double spin = ((1 + scale_) * s.w_IT_T.z() + axial_) * s.seconds;
  const double regain = InverseSinc(spin);
  const Vector2d across = (s.w_IT_T.head<2>() - gyro_) * (s.seconds * regain);
  const Matrix3d half = RotationZ(spin / 2);
  const Vector3d step(across.x() / 2, across.y() / 2, 0);
  const Matrix3d tilt = Exp(step);
  R_ = Exp(-0.5 * s.seconds * s.w_IL_L) * R_ * half * tilt;
  R_middle_ = R_;
  R_sum_ += s.seconds * R_;
  if (s.accel_good) {
    const Vector3d f(s.gravity_T.x() * regain, s.gravity_T.y() * regain, s.gravity_T.z());
    force_L_ += s.seconds * (R_ * f);
    force_T_ += s.seconds * f;
    R_accel_ += s.seconds * R_;
    accel_seconds_ += s.seconds;
  }
  R_ = Exp(-0.5 * s.seconds * s.w_IL_L) * R_ * tilt * half;
  w_sum_ += s.seconds * s.w_IT_T;
  last_rate_ << s.w_IT_T.head<2>() - gyro_, (1 + scale_) * s.w_IT_T.z() + axial_;
  spin_ += spin;
  w_IL_L_ += s.seconds * s.w_IL_L;
  w_IL_ = s.w_IL_L;
  unknown_rate_ = s.unknown_rate;
  gravity_ = s.gravity;
  has_gz_ = s.has_gz;
  seconds_ += s.seconds;
}

// The horizontal part of the axis, by which gravity shows a turn about it, less what may be error
// of the estimate: where all of it may be, gravity shows nothing.
double Core::Seen() const {
  const double sine2 = R_.col(2).head<2>().squaredNorm();
  const double var = Square(kSure) * (cov_(0, 0) + cov_(1, 1));
  return sine2 > var ? std::sqrt(1 - var / sine2) : 0;
}

// A turn about it turns the attitude so, as far as gravity shows that.
Vector3d Core::Axis() const {
  Vector3d z = R_.col(2);
  z.head<2>() *= Seen();
  return z;
}

// The heading has become so uncertain that nothing which turns with it is linear any more.
bool Core::Lost() const { return cov_noise_(2, 2) > kLostVariance; }

bool Core::heading_feeds_back() const { return cov_(2, 2) <= kLinearVariance; }

void Core::Carry(const Noise& noise) {
  const double T = seconds_;
  since_hold_ += T;
  const Matrix3d R = R_sum_ / T;
  const Vector3d w = w_sum_ / T, f = force_T_ / std::max(accel_seconds_, 1e-9);
  const double spin = spin_ / T;
  Covariance phi = Covariance::Identity();
  phi.topLeftCorner<3, 3>() -= Skew(w_IL_L_);
  Vector3d z = R.col(2);
  z.head<2>() *= Seen();
  phi.block<3, 2>(kTurn, kGyro) = -T * R.leftCols<2>();

  Covariance added = Covariance::Zero();
  const Matrix3d along = z * z.transpose();
  const double white = Square(noise.rate) * T;
  added.topLeftCorner<3, 3>() = white * (Matrix3d::Identity() - (has_gz_ ? 0 : 1) * along);
  AddAxial(T, z, Square(has_gz_ ? noise.bias_walk : noise.axial_walk), &phi, &added);
  if (has_gz_) phi.block<3, 1>(kTurn, kScale) = spin_ * z;
  // A heading that is wrong turns the Earth's rate. That shows the heading, but falsely as soon as
  // it is no longer linear: then it only counts as noise.
  if (!heading_feeds_back()) {
    phi.block<2, 1>(kTurn, 2).setZero();
    added.topLeftCorner<2, 2>().diagonal().array() +=
        std::min(cov_(2, 2), 1.0) * w_IL_.head<2>().squaredNorm() * kRateSeconds * T;
  }
  // What the tool's turning puts into the other axes changes with it; not with what may be error of
  // the estimate, which would add up to a bias of anything.
  const double faster = spin - last_spin_;
  const bool is_faster = Square(faster) > Square(kSure) * cov_(kAxial, kAxial);
  const double changed = is_faster ? Square(noise.skewed * faster) : 0;
  if (is_faster) last_spin_ = spin;

  for (int i = kGyro; i < kAccel; ++i) added(i, i) = Square(noise.bias_walk) * T;
  cov_noise_ = phi * cov_noise_ * phi.transpose() + added;
  for (int i = kGyro; i < kAccel; ++i) added(i, i) += changed;
  // What an unknown rate does with these gains is in the sensitivities.
  added.topLeftCorner<2, 2>().diagonal().array() += Square(unknown_rate_) * kRateSeconds * T;
  cov_ = phi * cov_ * phi.transpose() + added;

  Eigen::Matrix<double, 2, Knot::kSources> rate = Eigen::Matrix<double, 2, Knot::kSources>::Zero();
  rate.col(Knot::kMassUnbalance) = f.head<2>();
  rate.col(Knot::kQuadrature) = Vector2d(f.y(), -f.x());
  rate(0, Knot::kGyroScaleX) = w.x();
  rate(1, Knot::kGyroScaleY) = w.y();
  rate(0, Knot::kMisalignmentX) = rate(1, Knot::kMisalignmentY) = spin;
  sources_ = (phi * sources_).eval();
  sources_.topLeftCorner<3, Knot::kSources>() += T * R.leftCols<2>() * rate;
  sources_.block<2, 2>(kTurn, kEarth).diagonal().array() -= T;
}

double Core::Take(const Noise& noise) {
  regained_ = 0;
  if (!(accel_seconds_ > 0)) return 0;
  const Matrix3d R = R_accel_ / accel_seconds_;
  const Vector3d f = force_T_ / accel_seconds_;
  const Matrix2d turn = R.topLeftCorner<2, 2>();
  Eigen::Matrix<double, 2, kStates> C = Eigen::Matrix<double, 2, kStates>::Zero();
  C(0, 1) = -gravity_;
  C(1, 0) = gravity_;
  C.block<2, 2>(0, kAccel) = -turn;
  const Vector2d y = (force_L_ / accel_seconds_).head<2>() - turn * accel_;
  const Matrix2d white = Matrix2d::Identity() *
                         std::max(Square(noise.force) / accel_seconds_, Square(1e-8 * gravity_));
  const Matrix2d S = C * cov_ * C.transpose() + white;
  const Matrix2d inverse = S.inverse();
  Gain K = cov_ * C.transpose() * inverse;
  // A tool that turns parts a bias, which turns with it, from tilt; one that only seems to, because
  // the rate about its axis is uncertain, would part them falsely; one at rest for all its length.
  const bool held = since_hold_ < kHeldSeconds;
  if (held || Square(spin_ / seconds_) < Square(kSure) * cov_(kAxial, kAxial)) {
    K.middleRows<2>(kAccel).setZero();
  }
  const Eigen::Matrix<double, kStates, 1> error = K * y;
  R_ = Exp(-error.head<3>()) * R_;
  Orthonormalize(R_);
  regained_ = -R_.col(2).dot(error.head<3>());
  axial_ -= error[kAxial];
  gyro_ -= error.segment<2>(kGyro);
  accel_ -= error.segment<2>(kAccel);
  scale_ -= error[kScale];

  const Covariance left = Covariance::Identity() - K * C;
  const Covariance of_white = K * white * K.transpose();
  cov_ = left * cov_ * left.transpose() + of_white;
  cov_noise_ = left * cov_noise_ * left.transpose() + of_white;
  if (Lost()) {
    const double least = Square(accel_sigma_ / gravity_);
    for (int i = 0; i < 2; ++i) {
      cov_(i, i) = std::max(cov_(i, i), least);
      cov_noise_(i, i) = std::max(cov_noise_(i, i), least);
    }
  }
  // What the constant errors put into the mean force, turned to L.
  Eigen::Matrix<double, 2, Knot::kSources> force = Eigen::Matrix<double, 2, Knot::kSources>::Zero();
  const Vector2d rolled = turn * Vector2d(f.y(), -f.x());
  force.col(Knot::kToolfaceOffset) = rolled;
  force.col(Knot::kTimeSkew) = rolled * (spin_ / seconds_);
  force.col(Knot::kAccelBiasZ) = R.block<2, 1>(0, 2);
  sources_ = (left * sources_).eval();
  sources_.leftCols<Knot::kSources>() -= K * force;
  // The tool had turned by that too, and skewed axes with it.
  sources_.block<3, 1>(kTurn, Knot::kMisalignmentX) += regained_ * R_.col(0);
  sources_.block<3, 1>(kTurn, Knot::kMisalignmentY) += regained_ * R_.col(1);
  return -0.5 * (y.dot(inverse * y) + std::log(S.determinant()));
}

double Core::Close(const Noise& noise) {
  if (!(seconds_ > 0)) return 0;
  Carry(noise);
  const double likelihood = Take(noise);
  seconds_ = accel_seconds_ = spin_ = 0;
  R_sum_.setZero();
  R_accel_.setZero();
  force_L_.setZero();
  force_T_.setZero();
  w_sum_.setZero();
  w_IL_L_.setZero();
  return likelihood;
}

void Core::Hold(double sigma) {
  if (has_gz_) return;
  since_hold_ = 0;
  const double still = R_.col(2).dot(w_IL_);
  Eigen::Matrix<double, kStates, 1> gain =
      cov_.col(kAxial) / (cov_(kAxial, kAxial) + Square(sigma));
  gain.tail<kStates - kGyro>().setZero();
  const Eigen::Matrix<double, kStates, 1> error = gain * (axial_ - still);
  R_ = Exp(-error.head<3>()) * R_;
  axial_ -= error[kAxial];
  Covariance left = Covariance::Identity();
  left.col(kAxial) -= gain;
  const Covariance of_white = gain * Square(sigma) * gain.transpose();
  cov_ = left * cov_ * left.transpose() + of_white;
  cov_noise_ = left * cov_noise_ * left.transpose() + of_white;
  sources_ = (left * sources_).eval();
}

void Core::TakeThird(bool has_gz, double sigma) {
  axial_ = has_gz ? 0 : last_rate_.z();
  scale_ = 0;
  has_gz_ = has_gz;
  for (Covariance* cov : {&cov_, &cov_noise_}) {
    for (const int i : {kAxial, kScale}) {
      cov->row(i).setZero();
      cov->col(i).setZero();
    }
    (*cov)(kAxial, kAxial) = Square(sigma);
    if (has_gz) (*cov)(kScale, kScale) = Square(scale_sigma_);
  }
  sources_.row(kAxial).setZero();
  sources_.row(kScale).setZero();
}

void Core::ForgetBias(double sigma) {
  gyro_.setZero();
  for (Covariance* cov : {&cov_, &cov_noise_}) {
    cov->middleRows<2>(kGyro).setZero();
    cov->middleCols<2>(kGyro).setZero();
  }
  cov_.diagonal().segment<2>(kGyro).setConstant(Square(sigma));
  sources_.middleRows<2>(kGyro).setZero();
  sources_(kGyro, Knot::kGyroBiasX) = sources_(kGyro + 1, Knot::kGyroBiasY) = -1;
}

void Core::Release() {
  if (has_gz_) return;
  since_hold_ = kHeldSeconds;
  cov_(kAxial, kAxial) += Square(kAxialFirst);
  cov_noise_(kAxial, kAxial) += Square(kAxialFirst);
}

Matrix3d Core::Before(double seconds) const { return R_ * Exp(-seconds * last_rate_); }

void Core::Bridge(const Gap& gap) {
  const double T = gap.seconds, begin = has_gz_ ? last_rate_.z() : axial_;
  const double end = gap.axial_end ? (1 + scale_) * *gap.axial_end + axial_ : begin;
  double turned = ((begin + end) / 2 - R_.col(2).dot(w_IL_)) * T;
  // A walk between two ends that are known strays half as far as one from a known begin.
  const double walk = Square(gap.axial_walk);
  const double strayed = walk * T * T * T / (has_gz_ && gap.axial_end ? 12 : 3);
  const double var_turned = T * T * cov_(kAxial, kAxial) + strayed;
  Vector3d about = Axis();
  double var_heading = 0;
  if (gap.toolface_end && var_turned > kLinearTurn) {
    // Too far to be linear: gravity shows the toolface, and the hole keeps its azimuth as far as it
    // does not bend; or else all is lost that turns with the tool.
    const double var_bent = (gap.var_across + cov_(0, 0) + cov_(1, 1)) /
                            std::max(R_.col(2).head<2>().squaredNorm(), Square(kSineLeast));
    if (var_bent < var_turned) {
      const double toolface = std::atan2(R_(2, 1), -R_(2, 0));
      turned += WrapPi(*gap.toolface_end - toolface - turned);
    }
    var_heading = std::min(var_bent, var_turned);
    about.setZero();
  }
  R_ = (R_ * RotationZ(turned)).eval();
  Covariance phi = Covariance::Identity(), added = Covariance::Zero();
  AddAxial(T, about, has_gz_ ? 0 : walk, &phi, &added);
  if (has_gz_) added.topLeftCorner<3, 3>() += strayed * (about * about.transpose());
  added(2, 2) += var_heading;
  for (Covariance* cov : {&cov_, &cov_noise_}) *cov = phi * *cov * phi.transpose() + added;
  sources_ = (phi * sources_).eval();
  Widen(gap.var_across, 0);
}

void Core::Widen(double var_across, double var_about) {
  const Vector3d z = Axis();
  for (Covariance* cov : {&cov_, &cov_noise_}) {
    cov->topLeftCorner<3, 3>() += var_about * z * z.transpose();
    cov->topLeftCorner<2, 2>().diagonal().array() += var_across;
  }
}

void Core::CountSum() {
  Covariance set = Covariance::Identity();
  set.block<1, 3>(2, 0) -= SumSlope(R_);  // of which a turn about the vertical is one
  cov_ = (set * cov_ * set.transpose()).eval();
  cov_noise_ = (set * cov_noise_ * set.transpose()).eval();
  sources_ = (set * sources_).eval();
}

void Core::SetHeading(double azimuth, double variance) {
  const Vector3d t = R_.col(2);
  const Matrix3d turn = RotationZ(WrapPi(azimuth - std::atan2(t.y(), t.x())));
  Covariance set = Covariance::Identity();
  set.block<1, 3>(2, 0) -= EulerSlopes(R_).row(1);  // to no error of azimuth at all
  Covariance turned = Covariance::Identity();
  turned.topLeftCorner<3, 3>() = turn;
  set = (turned * set).eval();
  R_ = turn * R_;
  cov_ = (set * cov_ * set.transpose()).eval();
  cov_noise_ = (set * cov_noise_ * set.transpose()).eval();
  sources_ = (set * sources_).eval();
  cov_(2, 2) += variance;
  cov_noise_(2, 2) += variance;
}

}  // namespace wellgyro::vertical
