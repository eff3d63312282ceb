#pragma once

#include <cstdint>
#include <variant>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/math/random.h"
#include "wellgyro/record/depth.h"
#include "wellgyro/record/operations.h"
#include "wellgyro/record/sample.h"
#include "wellgyro/simulate/fault_player.h"
#include "wellgyro/simulate/simulation.h"
#include "wellgyro/simulate/tool_errors.h"
#include "wellgyro/simulate/truth.h"

namespace wellgyro {

/// What the surface receives next.
using SimulatedStep = std::variant<ToolMode, ImuSample, DepthMark>;

/// Plays a simulation: samples, depth marks and tool modes in the order in which they come to be
/// known, a sample at the end of its period. Memory does not grow with the run, and Next allocates
/// nothing. The same simulation and seed give the same bytes.
///
///   Simulator simulator(simulation);
///   SimulatedStep step;
///   while (simulator.Next(step)) std::visit([&](const auto& record) { ... }, step);
///
/// Samples follow one another without loss or overlap; SampleBatcher makes messages of them.
/// The UTC of samples and marks is in whole microseconds, as on the wire. The surface's clock is
/// the truth's; a sample's rate is a mean over true time, also where the tool's clock drifts.
class WELLGYRO_EXPORT Simulator {
 public:
  /// Throws std::invalid_argument, naming the field, where the simulation makes no sense.
  explicit Simulator(const Simulation& simulation);

  /// False at the end of the run; `step` is then left alone.
  bool Next(SimulatedStep& step);

  const Truth& truth() const { return truth_; }
  std::int64_t sample_count() const { return sample_count_; }
  ToolInfo tool_info() const;
  /// Begin of sample `k` since the begin of the run, in true time [s].
  double SampleTime(std::int64_t k) const;

 private:
  UtcTime UtcAt(double time) const;
  double MarkTime(std::int64_t k) const;
  ToolMode NextMode();
  ImuSample NextSample();
  DepthMark NextMark();

  SimulatedStreams streams_;
  SimulatedTool tool_;
  Truth truth_;
  SensorErrors sensor_errors_;
  FaultPlayer faults_;
  Random jitter_;
  Random depth_noise_;
  std::int32_t period_ns_;
  std::int64_t sample_count_;
  std::int64_t mark_count_;
  std::int64_t samples_done_ = 0;
  std::int64_t marks_done_ = 0;
  std::int64_t modes_done_ = 0;
};

}  // namespace wellgyro
