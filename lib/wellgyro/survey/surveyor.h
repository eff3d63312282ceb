#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/record/check.h"
#include "wellgyro/record/depth.h"
#include "wellgyro/record/north_fix.h"
#include "wellgyro/record/operations.h"
#include "wellgyro/record/sample.h"
#include "wellgyro/record/station.h"
#include "wellgyro/survey/job.h"
#include "wellgyro/survey/survey.h"

/// @file
/// From samples and depth marks to stations, as they come.
namespace wellgyro {

class RunAdjuster;
struct RunNow;

/// Where results go while they are made. Override what you want to hear. What is called must not
/// call the surveyor that calls it.
class WELLGYRO_EXPORT Sink {
 public:
  virtual ~Sink();
  /// And again, with a higher revision, when better known.
  virtual void OnStation(const Station&) {}
  virtual void OnNorthFix(const NorthFix&) {}
  virtual void OnCheck(const Check&) {}
  virtual void OnFault(const Fault&) {}  ///< what was dropped, where, and why
  virtual void OnAcknowledged(std::int32_t /*command_id*/) {}
};

/// How the samples of all tools came, since the begin.
struct SampleTally {
  std::int64_t received = 0;      ///< accepted
  std::int64_t lost = 0;          ///< by sequence number
  std::int64_t gaps = 0;          ///< places where some were lost
  std::int64_t duplicates = 0;    ///< sent again and skipped
  std::optional<UtcTime> newest;  ///< begin of the newest sample
};

/// From sensor samples to stations: the one place that knows the order of the rooms.
///
/// ```
/// samples -> in order -> still? -> north fix -+
///                     -> attitude <-----------+-> knots -> azimuth -+-> stations -> positions
/// depth marks -> depth against time --------------------------------+
/// ```
///
/// Rig, log and vendor code differ only in who calls Push. Two laws hold, and tests keep them:
/// (1) in one build the same messages give the same stations, bit for bit; (2) how the streams
/// interleave does not matter within job.depth.latency. A sample waits until the depth that belongs
/// to it is known, or until samples a latency later have come.
///
/// Data never make Push throw: what cannot be used reaches the sink as a Fault, hard physics as
/// Quality. The sink must not throw either: what it interrupts is not done again. Memory grows with
/// stations and knots only (one knot a second, about .35 kB). One that was moved from may only be
/// assigned to or destroyed.
class WELLGYRO_EXPORT Surveyor {
 public:
  /// What comes beyond these is left out with a Fault; of more tools those with the most samples
  /// stay, of modes for a tool that is heard of later the last.
  /// No string has a tenth of them; bounds of the memory that an invented flood takes.
  static constexpr std::size_t kToolsMax = 256;
  static constexpr std::size_t kRunsMax = 1000;           ///< of one tool
  static constexpr std::size_t kOperationsMax = 100'000;  ///< commands and events
  static constexpr std::size_t kModesKept = 1000;

  /// Throws std::invalid_argument, naming the field, when `job` makes no sense. `sink` must
  /// outlive this object.
  Surveyor(const Job& job, Sink& sink);
  ~Surveyor();
  Surveyor(Surveyor&&) noexcept;
  Surveyor& operator=(Surveyor&&) noexcept;

  void Push(std::span<const ImuSample> batch);
  /// Counts, made SI by job.tool; a Fault where the job has none. Samples with fewer channels or
  /// thermometers than it names are left out, with a Fault for the first of a batch.
  void Push(std::span<const RawSample> batch);
  void Push(const ImuSample& sample);
  void Push(const StillWindow& window);
  void Push(const DepthMark& mark);
  void Push(const ToolMode& mode);
  void Push(const ToolInfo& info);
  void Push(const Command& command);
  void Push(const Event& event);

  /// 1-sigma of the difference of the samples' UTC from that of the depth marks [s]: one error of
  /// the whole run, as of clocks joined by stops; 0 where it is not called. `depth_lag` allows for
  /// it. Throws std::invalid_argument where it is negative or non-finite.
  void TieClock(double sigma_utc);

  /// Sends revisions from all that is known so far; changes nothing that follows.
  void Adjust();
  /// Works off what still waits for its depth, as Finish does, and adjusts nothing: what is known
  /// when a survey is broken off. Pushes after it are faults.
  void Flush();
  /// The last Adjust: works off what still waits, then revises every station. Pushes after it are
  /// faults.
  void Finish();

  /// Finish was called, or a FINISH obeyed.
  bool finished() const;
  SampleTally tally() const;

  /// Tools of the string that have been heard of.
  std::vector<std::int32_t> tools() const;
  /// All stations, checks and runs of one tool as they are now.
  Survey Current(std::int32_t tool) const;

 private:
  friend void AdjustBy(const RunAdjuster& adjuster, Surveyor& surveyor);
  friend RunNow NowOf(const Surveyor& surveyor, std::int32_t tool);
  RunNow Now(std::int32_t tool) const;
  struct Rooms;
  std::unique_ptr<Rooms> rooms_;
};

}  // namespace wellgyro
