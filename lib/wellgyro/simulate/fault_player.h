#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/math/random.h"
#include "wellgyro/record/sample.h"
#include "wellgyro/simulate/fault.h"
#include "wellgyro/simulate/simulation.h"

namespace wellgyro {

/// Plays a simulation's faults: what each makes of tool errors, samples and depth marks at an
/// instant. Times are true seconds since the begin of the run. Allocates nothing after it is made.
class WELLGYRO_EXPORT FaultPlayer {
 public:
  /// Throws std::invalid_argument, naming the fault, where one makes no sense.
  explicit FaultPlayer(const Simulation& simulation);

  bool empty() const { return faults_.empty(); }
  /// The tool's errors at `time` with those that faults add to them.
  ToolErrors ErrorsAt(double time) const;
  /// When the sample that is stamped `time` was really taken.
  double SampledAt(double time) const;
  /// Where the tool was that a mark at `time` tells of.
  double MarkedAt(double time) const;
  double MarkMd(double time, double md) const;
  double UtcOffset(double time) const;
  /// What the faults make of a sample over [begin, end]. One call a sample, in order.
  void Spoil(double begin, double end, ImuSample& sample);

 private:
  void AddNoise(const SimulatedFault& f, double seconds, ImuSample& s);
  bool Strikes(const SimulatedFault& fault, std::size_t index, double begin);
  void Sense(const SimulatedFault& fault, std::size_t index, double begin, double end,
             ImuSample& sample);
  void Turn(const SimulatedFault& fault, double begin, double end, ImuSample& sample) const;

  std::vector<SimulatedFault> faults_;
  std::vector<double> held_;        ///< of each fault, what a stuck axis read first
  std::vector<bool> holds_;         ///< whether it has
  std::vector<std::int64_t> done_;  ///< of each fault, spikes so far
  ToolErrors errors_;
  Random noise_;
};

/// The simulation as its truth has it: with the latitude that a fault moves.
WELLGYRO_EXPORT Simulation WithTruth(Simulation simulation);

}  // namespace wellgyro
