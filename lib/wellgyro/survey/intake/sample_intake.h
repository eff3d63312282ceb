#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "wellgyro/base/time.h"
#include "wellgyro/calibration/spike_filter.h"
#include "wellgyro/depth/cable.h"
#include "wellgyro/depth/depth_track.h"
#include "wellgyro/survey/intake/located_block.h"
#include "wellgyro/survey/intake/run_clock.h"
#include "wellgyro/survey/intake/sample_queue.h"
#include "wellgyro/survey/intake/sensor_depth.h"
#include "wellgyro/survey/job.h"
#include "wellgyro/survey/surveyor.h"

namespace wellgyro {

/// What comes of one tool's samples: ordered, freed of spikes, on one clock and with their depth.
struct AdmittedBlock : LocatedBlock {
  std::span<const ImuSample> sent;  ///< with the stamps as they came
  SpikeFilter::Mended mended;       ///< each of them, all alike
  bool jumps = false;               ///< the clock, before the first
  std::optional<double> step;       ///< of UTC at the first, see RunClock [s]
};

/// Lets one tool's samples in: puts them in order, mends single impossible ones, runs their clock
/// on and finds their depth, in blocks as long as nothing changes; and says what was left out, lost
/// and mended. How the samples came in batches does not matter, but to where blocks end.
class SampleIntake {
 public:
  /// All references must outlive this object.
  SampleIntake(const Job& job, const DepthTrack& track, CableMarks& marks, Sink& sink);

  SampleIntake(const SampleIntake&) = delete;
  SampleIntake& operator=(const SampleIntake&) = delete;

  /// Takes the samples at the begin of `batch` that come right behind each other, or one that has
  /// to be sorted in; what is left. What Next() has is to be used before more come, by the marks up
  /// to newest().
  [[nodiscard]] std::span<const ImuSample> Take(std::span<const ImuSample> batch);
  /// The next samples, or nullptr while they have to wait; those that begin at `until` or later are
  /// left out. Valid until the next call.
  const AdmittedBlock* Next(std::optional<UtcTime> until);
  /// Samples [at, end) of Next() are the run's: counts what they tell of losses and mends.
  void Count(const AdmittedBlock& block, std::size_t at, std::size_t end, RunSummary& summary);
  /// From now on nothing waits.
  void Flush();
  /// Those mended samples of which nobody has been told.
  void TellMended();

  /// Some samples have been counted.
  bool heard() const { return last_.has_value(); }
  const SampleQueue::Counts& counts() const { return queue_.counts(); }
  SampleTally tally() const;
  SensorDepth& depth() { return depth_; }
  /// By which UTC may be wrong now [s].
  double clock_doubt() const { return clock_.doubt(); }

 private:
  bool Refill(std::optional<UtcTime> until);
  std::size_t CountFinal(std::span<const ImuSample> samples);
  void Admit();
  std::span<ImuSample> EvenSamples();
  void Tell(SampleQueue::Verdict verdict, const SampleStamp& stamp);
  void TellStrays();
  void TellClock(const AdmittedBlock& block, const SampleStamp& stamp) const;

  Sink& sink_;
  Duration latency_;  ///< of the depth's marks
  SampleQueue queue_;
  SpikeFilter filter_;
  RunClock clock_;
  SensorDepth depth_;
  SpikeFilter::Done done_;  ///< of the samples that the queue holds, those not yet admitted
  bool jumps_ = false;      ///< the clock, before the first of them
  bool flushed_ = false;
  std::array<ImuSample, SampleBlock::kMost> continued_;  ///< where the clock changes their stamps
  AdmittedBlock admitted_;
  std::size_t admitted_count_ = 0;  ///< samples that the queue holds for it
  /// Samples that the filter has mended and of which nobody has been told.
  struct MendedRange {
    std::int32_t session = 0;
    std::int64_t first = 0, last = 0, count = 0;
  };
  MendedRange mended_;
  std::int64_t strays_told_ = 0;      ///< of the queue's
  std::optional<SampleStamp> other_;  ///< the last that came again with another content
  std::optional<SampleStamp> last_;   ///< counted
  std::int64_t lost_ = 0, gaps_ = 0;  ///< samples, and places
};

}  // namespace wellgyro
