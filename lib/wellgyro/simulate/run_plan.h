#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/record/operations.h"
#include "wellgyro/simulate/simulation.h"
#include "wellgyro/simulate/truth_well.h"

namespace wellgyro {

/// Where the run is at one instant and how fast.
struct RunMotion {
  double md = 0;            ///< [m]
  double speed = 0;         ///< [m/s]
  double acceleration = 0;  ///< [m/s^2]
  double roll = 0;          ///< from the run's roll reference [rad]
  double roll_rate = 0;     ///< [rad/s]
  bool still = true;
};

/// What the tool announces, and from when.
struct ModeChange {
  double time = 0;  ///< since the begin of the run [s]
  ToolMode::Mode mode = ToolMode::Mode::kUnknown;
  std::optional<std::int32_t> index_position = {};
  double index_angle = 0;  ///< [rad]
};

/// The steps of a run laid out in time, closed form.
class WELLGYRO_EXPORT RunPlan {
 public:
  /// Throws std::invalid_argument, naming the field, for a step that cannot be done in this well.
  RunPlan(const SimulatedRun& run, const TruthWell& well);

  double seconds() const { return seconds_; }
  const std::vector<ModeChange>& modes() const { return modes_; }
  RunMotion At(double time) const;
  /// First instant after `time` at which some higher derivative jumps; infinity after the last.
  double NextBreak(double time) const;
  /// Length of time over which every motion is nearly a low polynomial [s].
  double short_time() const { return short_time_; }

 private:
  struct Leg {
    double begin = 0, seconds = 0, ramp = 0;  // [s]
    double md = 0, speed = 0;                 // at begin [m]; signed, at full window [m/s]
    double roll = 0, turn = 0;                // at begin; of an index turn [rad]
    RunRoll wave = {};
  };
  void AddStop(const RunStop& stop, const SimulatedRun& run, const TruthWell& well,
               std::size_t number);
  void AddMove(const RunMove& move, const TruthWell& well, std::size_t number);
  void AddTurn(double angle, double turn_seconds);
  void AddLeg(Leg leg);

  std::vector<Leg> legs_;
  std::vector<double> breaks_;
  std::vector<ModeChange> modes_;
  RunMotion end_;
  double seconds_ = 0;
  double short_time_ = 0.05;
};

}  // namespace wellgyro
