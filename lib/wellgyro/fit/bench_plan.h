#pragma once

#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/calibration/bench_axes.h"

namespace wellgyro {

/// What a plan of gyro positions is for. The gyros are a two-axis rotor across the hole: bias and
/// its bend in temperature, sensitivity, mass unbalance and quadrature, anisoelasticity.
struct BenchPlanSetup {
  BenchAxes axes = BenchAxes::kTrade;
  double bench_latitude = 0, well_latitude = 0;  ///< [rad]
  double sigma_gyro = 0.02;                      ///< of a reading at rest [deg/h]
  /// Wanted, of what the calibration leaves [rad]; 0: that of the plain bench (PlainSettings).
  double sigma_azimuth = 0;
  /// Of the sensitivities where a rate table is read too, scale and misalignment [1]; 0: it is not.
  double sigma_sensitivity = 0;
  int temperatures = 1;  ///< stops of the chamber, evenly; 1 to 5
  enum class Criterion {
    kLargest,      ///< the azimuth's largest sigma over the hole (c-optimal, minimax)
    kMean,         ///< its root mean square
    kDeterminant,  ///< all parameters alike (D-optimal); the largest sigma is what must be reached
  } criterion = Criterion::kLargest;
  int most = 240;  ///< settings at a temperature
  /// Of the hole that it is for [rad]: a plan for a part of all directions needs fewer settings.
  double inclination_from = 0.0873, inclination_to = 1.6581;  ///< 5 to 95 deg
  double azimuth_from = 0, azimuth_to = 6.2832;               ///< clockwise, the whole circle
  struct Direction {
    double inclination = 0, azimuth = 0;
  };
  std::vector<Direction> hole;  ///< its stations, in place of the ranges
};

/// One setting: attitude of the bench and, from -1 to 1, the temperature in its range.
struct BenchSetting {
  double inclination = 0, azimuth = 0, toolface = 0;  ///< [rad]
  double tau = 0;
};

struct BenchPlan {
  std::vector<BenchSetting> settings;  ///< by temperature, then inclination
  double sigma_azimuth = 0;            ///< that they give, by AzimuthSigmaOf [rad]
  double wanted = 0;                   ///< [rad]
  bool reached = false;                ///< what was wanted
  /// With less time than that of so many settings no choice among the same attitudes reaches what
  /// was wanted, however the time is divided among them.
  double fewest = 0;
};

/// The azimuth's sigma that a calibration from `settings` leaves, over the hole's attitudes that
/// are not near east-west and horizontal and all toolfaces: the largest, or the root mean square
/// for Criterion::kMean; infinite where they leave a parameter open.
WELLGYRO_EXPORT double AzimuthSigmaOf(const std::vector<BenchSetting>& settings,
                                      const BenchPlanSetup& setup);

/// The positions of a plain bench: inclinations 0, 45, 90 and 135 deg, four azimuths, six
/// toolfaces, at every temperature.
WELLGYRO_EXPORT std::vector<BenchSetting> PlainSettings(int temperatures);

/// The fewest settings that reach `sigma_azimuth`, each read once, by exchange (Fedorov 1972) among
/// inclinations every 15 deg, azimuths every 45 and toolfaces every 30; a local optimum, the same
/// every time, with the bound that no optimum passes (BenchPlan::fewest). However little is wanted,
/// they have 30 readings more than unknowns, from which the bench finds its noise. Throws
/// std::invalid_argument for a setup that makes no sense.
WELLGYRO_EXPORT BenchPlan PlanBench(const BenchPlanSetup& setup);

}  // namespace wellgyro
