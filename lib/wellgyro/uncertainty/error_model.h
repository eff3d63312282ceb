#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/units.h"
#include "wellgyro/uncertainty/weight.h"

namespace wellgyro {

class FormulaWeight;

/// How far one error reaches: a new value at every station; one in a tool leg; one in a well; one
/// everywhere.
enum class Propagation { kRandom, kSystematic, kWell, kGlobal };

/// Of XCLA and XCLH: the least that a hole turns between two stations, whatever these say (SPE
/// 187249) [rad/m].
inline constexpr double kLeastTortuosity = units::kDegPer100ft;

/// One error source of a model.
struct ErrorTerm {
  std::string name;                        ///< unique in its model, as "GXY-B1S"
  const WeightFunction* weight = nullptr;  ///< of FindWeight
  double magnitude = 0;                    ///< 1 sigma, in SI units of weight->dimension
  Propagation propagation = Propagation::kSystematic;
  /// Beside the weight OwnFormula: the model's own weighting function, for a magnitude in SI units.
  std::shared_ptr<const FormulaWeight> formula;
  std::string unit;    ///< in which the magnitude was published; empty: SI
  double unit_si = 1;  ///< SI units that one of it is
};

/// Gyrocompassing at rest, and how it starts a continuous section (SPE 90408, App. C).
struct StationaryMode {
  GyroAxes axes = GyroAxes::kXy;
  double end = 0;  ///< greatest inclination at which it is used [rad]; 0: only to initialise
  /// Inclination through which a continuous section is entered [rad]; negative: at the first
  /// station, wherever it points. Absent: there are no continuous sections.
  std::optional<double> initialise;
  /// Along hole between initialisations, of a tool that gyrocompasses only for them [m].
  std::optional<double> min_distance;
  std::optional<double> noise_reduction;     ///< of the random noise, when initialising
  bool noise_reduction_at_stations = false;  ///< and at every station
};

/// Inclinations in which one gyro is integrated.
struct ContinuousZone {
  GyroAxes axes = GyroAxes::kXy;
  double begin = 0;  ///< [rad]
  double end = 0;    ///< [rad]
  double speed = 0;  ///< of the tool along hole [m/s]
};

/// A survey tool's position uncertainty model, as ISCWSA and OWSG publish them.
struct ErrorModel {
  std::string name;
  std::string revision;
  std::string description;         ///< one line
  std::string source;              ///< who published it
  std::vector<std::string> notes;  ///< what was assumed when it was read
  std::vector<ErrorTerm> terms;
  double max_inclination = 0;  ///< beyond it the model says nothing [rad]
  std::optional<StationaryMode> stationary;
  std::vector<ContinuousZone> continuous;   ///< inclinations increasing
  std::optional<double> cant;               ///< of the x accelerometer of a two-axis tool [rad]
  std::optional<double> min_course_length;  ///< Lmin of XYM3E and XYM4E [m]
  std::optional<double> tortuosity;         ///< of XCLA and XCLH [rad/m]
  double vertical_limit = 0;                ///< below it a station counts as vertical [rad]
  /// Rev 5: the first leg's direction is wholly the first station's; Rev 4: half.
  bool doubled_tie_on = true;
};

/// Why a model cannot be used.
struct ModelComplaint {
  std::string text;                 ///< one sentence
  std::optional<std::size_t> term;  ///< index, where one term is to blame
};

/// What `model` lacks or where it contradicts itself; empty when it can be used.
WELLGYRO_EXPORT std::optional<ModelComplaint> FindComplaint(const ErrorModel& model);

}  // namespace wellgyro
