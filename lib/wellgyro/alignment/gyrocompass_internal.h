#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/alignment/gyrocompass.h"
#include "wellgyro/math/linear_algebra.h"
#include "wellgyro/math/rotation.h"

/// The least-squares problem behind Gyrocompass().
namespace wellgyro::gyrocompass {

/// Errors of the gyros and the place that are estimated by their priors.
enum Error {
  kBiasX,
  kBiasY,
  kBiasZ,
  kMass,
  kQuadrature,
  kGravity,
  kLatitude,
  kRoll,
  kScaleX,
  kScaleY,
  kMisX,
  kMisY,
  kErrors
};

/// Attitude of the first window, toolfaces of the others against it, and the errors.
struct State {
  Eigen::Matrix3d R_LT = Eigen::Matrix3d::Identity();
  std::vector<double> roll;             ///< of every window, first 0 [rad]
  std::array<double, kErrors> error{};  ///< in SI

  Eigen::Matrix3d R_LT_at(std::size_t k) const { return R_LT * RotationZ(roll[k]); }
};

struct Solution {
  State state;
  double cost = 0;
  Eigen::MatrixXd cov;  ///< of the unknowns
};

/// Whitened least squares over: rotation of the first attitude in L (north, east, down), rolls of
/// the further windows, and the errors that have a prior, each in units of it.
class Problem {
 public:
  Problem(std::span<const StillWindow> windows, const Site& site, const GyrocompassSetup& setup);

  Eigen::Index unknowns() const { return errors_at_ + static_cast<Eigen::Index>(free_.size()); }
  /// Level by the windows' forces, at this heading, errors zero.
  State Start(double azimuth) const;
  /// Cost least over all but the heading, by one linear step.
  double Profile(double azimuth) const;
  /// Gauss-Newton from `state` to the minimum about it.
  Solution Descend(State state) const;
  /// One of the estimated errors as the data alone tell it, its prior taken out again, and sigma of
  /// that [SI]; absent where they tell less than half of what the prior does.
  std::optional<std::pair<double, double>> Alone(const Solution& solution, Error error) const;
  /// The Earth's rate as the data would have it over its reference, and sigma of that.
  std::pair<double, double> RateRatio(const State& state) const;

 private:
  struct System {
    Eigen::MatrixXd J;
    Eigen::VectorXd r;
  };
  /// Whitened residuals with their derivatives by all unknowns, priors among them.
  System Linear(const State& state) const;
  Eigen::VectorXd Residual(const State& state) const { return Linear(state).r; }
  Eigen::MatrixXd Normal(const Eigen::MatrixXd& J) const;
  void Rates(const State& state, System& system) const;
  void Forces(const State& state, System& system) const;
  /// Of the mean rates of all windows about one axis [(rad/s)^2]: white noise in each, bias
  /// instability and walk from window to window.
  Eigen::MatrixXd RateCovariance(int axis, const NoiseCoefficients& gyro) const;
  /// Of the mean forces, window by window [(m/s^2)^2]: white noise in each, and constant errors of
  /// the accelerometers in all.
  Eigen::MatrixXd ForceCovariance(const ErrorPriors& errors) const;
  void ChooseErrors(const GyrocompassSetup& setup);
  bool Separated() const;
  State Moved(const State& state, const Eigen::VectorXd& step) const;

  std::span<const StillWindow> windows_;
  double latitude_, gravity_;
  int axes_;
  std::array<Cholesky, 3> whiten_rate_;
  Cholesky whiten_force_;
  std::array<double, kErrors> sigma_{};
  std::array<double, kErrors> known_{};  ///< what of them is no error: the samples have it
  std::vector<Error> free_;
  std::array<Eigen::Index, kErrors> column_{};  ///< -1: not estimated
  Eigen::Index count_, errors_at_;
};

/// Heading of a against b, their tilts being alike; regular at the vertical.
double HeadingFrom(const State& b, const State& a);

}  // namespace wellgyro::gyrocompass
