#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "wellgyro/base/export.h"
#include "wellgyro/uncertainty/error_model.h"
#include "wellgyro/uncertainty/survey_point.h"

namespace wellgyro {

inline constexpr std::size_t kMaxZones = 3;  ///< of a model: one each of three axes, two and one

/// Of sin I or cos I, by which a drift is divided: 0.6 deg from where it vanishes no error is told.
inline constexpr double kSmallestTurnFactor = 0.01;

/// What a gyro tool does at one station.
struct GyroMode {
  int section = 0;  ///< of continuous survey, from 1; 0: gyrocompassing at rest
  /// Where the section was initialised: there the fix had the error that is carried.
  double init_inclination = 0;  ///< [rad]
  double init_azimuth = 0;      ///< in the survey's frame [rad]
  /// Per zone: integral of dt / f, that multiplies a drift, and of dt / f^2, whose root multiplies
  /// a random walk [s]. f is 1, sin I or cos I for three axes, two and one.
  std::array<double, kMaxZones> drift_time{};
  std::array<double, kMaxZones> walk_time{};
  /// Likewise of dt^3 / (3 f^2) [s^3], whose root multiplies a rate random walk, and of dt^2 / (2
  /// f) [s^2], that multiplies a ramp, dt a whole leg's: the printed recursions, which begin anew
  /// at every station and so grow with the leg's length. See allan_error.h for what is exact.
  std::array<double, kMaxZones> rate_walk_time{};
  std::array<double, kMaxZones> ramp_time{};
  std::string refusal;  ///< why the model does not reach this station; empty: it does
};

/// Follows the mode of a tool from the first station of a well down (SPE 90408, App. C):
/// - gyrocompass at every station while the inclination is inside the stationary range;
/// - leaving it upwards opens a section, whose fix belongs to the point of the circular arc between
///   the two stations where the inclination is `initialise`;
/// - coming back into the range closes it;
/// - a tool that gyrocompasses only to initialise runs its gyro from the first station on, and
///   initialises again at a station not above `initialise`, once that is min_distance from the
///   first station or the last time;
/// - a negative `initialise`, or an external reference, opens the section at the first station;
/// - a gyro whose zone was left keeps what it had gathered until the next section.
/// The interval in which a section opens counts in full, with the mean of its two inclinations.
/// These rules give the figures of SPE 90408, App. E. The arc itself is integrated by
/// allan_error.h.
class WELLGYRO_EXPORT GyroModeTracker {
 public:
  /// `model` must outlive this object and have no complaint.
  explicit GyroModeTracker(const ErrorModel& model);

  void Begin(const SurveyPoint& first);
  void Advance(const SurveyPoint& previous, const SurveyPoint& point);
  /// At the last point given.
  const GyroMode& mode() const { return mode_; }

  /// The survey began above the inclination at which the model initialises.
  bool began_above() const { return began_above_; }

 private:
  void Open(double inclination, double azimuth);
  void Gather(const SurveyPoint& previous, const SurveyPoint& point);

  const ErrorModel& model_;
  double initialise_ = -1;
  bool returns_to_rest_ = false;
  bool began_above_ = false;
  int opened_ = 0;
  double last_initialised_ = 0;
  GyroMode mode_;
};

}  // namespace wellgyro
