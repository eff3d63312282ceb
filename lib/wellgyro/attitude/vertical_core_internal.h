#pragma once

#include <optional>

#include <Eigen/Core>

#include "wellgyro/earth/earth.h"
#include "wellgyro/record/along_hole.h"
#include "wellgyro/record/knot.h"
#include "wellgyro/record/noise.h"
#include "wellgyro/record/sample.h"

/// The error-state filter behind VerticalFilter.
namespace wellgyro::vertical {

/// Errors, estimate less truth: R_LT_estimated = exp([phi]) R_LT, phi in L.
enum State {
  kTurn = 0,   ///< phi: north, east, down [rad]
  kAxial = 3,  ///< rate about z, or of a measured one the bias with its sign turned [rad/s]
  kGyro = 4,   ///< bias of x, y [rad/s]
  kAccel = 6,  ///< bias of x, y [m/s^2]
  kScale = 8,  ///< of a measured rate about z, with its sign turned [1]
  kStates = 9
};
using Covariance = Eigen::Matrix<double, kStates, kStates>;
/// To the tool's constant errors, and to a rate of the Earth taken too large along x and y of L.
enum SensitivityColumn { kEarth = Knot::kSources, kColumns = kEarth + 2 };
using Sensitivity = Eigen::Matrix<double, kStates, kColumns>;
using Gain = Eigen::Matrix<double, kStates, 2>;

/// What one sample says, and where.
struct Sensed {
  double seconds = 0;
  Eigen::Vector3d w_IT_T = Eigen::Vector3d::Zero();     ///< z zero where not measured
  Eigen::Vector3d gravity_T = Eigen::Vector3d::Zero();  ///< specific force less that of travel
  Eigen::Vector3d w_IL_L = Eigen::Vector3d::Zero();
  double gravity = 0;
  double unknown_rate = 0;  ///< of the Earth, horizontal, by what north is unsure [rad/s]
  bool has_gz = false;
  bool accel_good = true;
};

/// North, as components along the two horizontal axes that an attitude counts from; zero where it
/// is unknown.
struct Heading {
  Eigen::Vector2d north = Eigen::Vector2d::Zero();
  double unsure = 1;  ///< 1-sigma, at most 1 [rad]
};

/// A sample with what travel adds to its force taken out. `R_LT` counts as `heading` does.
Sensed SensedOf(const ImuSample& sample, const AlongHole& along, const Site& site,
                const Heading& heading, const Eigen::Matrix3d& R_LT);

/// Slopes of (inclination, azimuth, toolface) against phi; sine bounded from below.
Eigen::Matrix3d EulerSlopes(const Eigen::Matrix3d& R_LT);
/// Of the sum of azimuth and toolface, regular at vertical.
Eigen::RowVector3d SumSlope(const Eigen::Matrix3d& R_LT);

/// White noise and walks of the model [SI].
struct Noise {
  double rate = 0;        ///< of the gyros [rad/sqrt(s)]
  double force = 0;       ///< [m/s^2 sqrt(s)]
  double bias_walk = 0;   ///< [rad/s/sqrt(s)]
  double axial_walk = 0;  ///< of the rate about z where it is not measured [rad/s/sqrt(s)]
  double skewed = 0;      ///< rate about z seen by x and y [rad]
};

/// Time without samples.
struct Gap {
  double seconds = 0;
  double var_across = 0;               ///< of the axis by its end, each way [rad^2]
  double axial_walk = 0;               ///< of the rate about z in it [rad/s/sqrt(s)]
  std::optional<double> axial_end;     ///< that rate behind it, where measured [rad/s]
  std::optional<double> toolface_end;  ///< as the accelerometers show it behind it [rad]
};

/// One filter with one walk of the axial rate.
class Core {
 public:
  void Start(const Sensed& s, const Eigen::Matrix3d& R_LT, const ErrorPriors& errors,
             double bias_sigma);
  /// Carries the attitude over one sample.
  void Predict(const Sensed& s);
  /// Ends the block: carries the covariance over it and takes its mean force. Returns the
  /// logarithm of the likelihood.
  double Close(const Noise& noise);
  /// Time without samples, which begins here: the axis stays, the tool turns on about it.
  void Bridge(const Gap& gap);
  /// What nothing told: of the axis each way, and of the turn about it [rad^2].
  void Widen(double var_across, double var_about);
  void SetHeading(double azimuth, double variance);
  /// From here on errors of the sum of azimuth and toolface are counted.
  void CountSum();
  /// What was learned of the gyros' bias counts no more.
  void ForgetBias(double sigma);
  /// The tool does not turn about its axis; of the axial rate to `sigma` [rad/s].
  void Hold(double sigma);
  /// From here on the rate about the axis is measured, or no longer; what then stands in its place
  /// is known to `sigma` [rad/s].
  void TakeThird(bool has_gz, double sigma);
  /// It may turn about its axis as never before.
  void Release();
  /// The attitude so long before the end of the last sample.
  Eigen::Matrix3d Before(double seconds) const;

  const Eigen::Matrix3d& R_LT() const { return R_; }
  const Eigen::Matrix3d& R_middle() const { return R_middle_; }  ///< of the last sample
  double axial_rate() const { return last_rate_.z(); }           ///< in it [rad/s]
  double axial() const { return axial_; }
  /// Whether an error of the heading turns the Earth's rate in what the filter holds.
  bool heading_feeds_back() const;
  bool has_gz() const { return has_gz_; }
  double block_seconds() const { return seconds_; }
  double block_spin() const { return spin_; }  ///< about the axis, in these [rad]
  /// What the last block's force added to its turn about the axis [rad]: where the rate there comes
  /// and goes, it is always found a little late.
  double regained() const { return regained_; }
  const Covariance& cov() const { return cov_; }
  /// Of the noise alone, and what the tool's constant errors and the Earth's rate do.
  const Covariance& cov_noise() const { return cov_noise_; }
  const Sensitivity& sources() const { return sources_; }

 private:
  void Carry(const Noise& noise);
  double Take(const Noise& noise);
  bool Lost() const;
  double Seen() const;
  Eigen::Vector3d Axis() const;

  Eigen::Matrix3d R_ = Eigen::Matrix3d::Identity(), R_middle_ = Eigen::Matrix3d::Identity();
  double axial_ = 0, scale_ = 0, regained_ = 0;
  Eigen::Vector2d gyro_ = Eigen::Vector2d::Zero(), accel_ = Eigen::Vector2d::Zero();
  Covariance cov_ = Covariance::Zero(), cov_noise_ = Covariance::Zero();
  Sensitivity sources_ = Sensitivity::Zero();
  // The open block.
  Eigen::Vector3d last_rate_ = Eigen::Vector3d::Zero();
  double accel_sigma_ = 0, scale_sigma_ = 0;
  double since_hold_ = 1e9;  // [s]
  double seconds_ = 0, accel_seconds_ = 0, gravity_ = 0, spin_ = 0, last_spin_ = 0;
  Eigen::Vector3d w_IL_ = Eigen::Vector3d::Zero();  // of the last sample
  double unknown_rate_ = 0;
  bool has_gz_ = false;
  Eigen::Matrix3d R_sum_ = Eigen::Matrix3d::Zero(), R_accel_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d force_L_ = Eigen::Vector3d::Zero(), w_sum_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d force_T_ = Eigen::Vector3d::Zero(), w_IL_L_ = Eigen::Vector3d::Zero();
};

}  // namespace wellgyro::vertical
