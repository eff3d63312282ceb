#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "wellgyro/base/export.h"
#include "wellgyro/base/time.h"
#include "wellgyro/depth/clock_tie.h"
#include "wellgyro/record/sample.h"

namespace wellgyro {

/// One tool's clock as the stages are to have it: running on where the tool's own starts anew with
/// a session or jumps, so that the times of a run stay in order; and its tie to UTC.
///
/// A break lasts as long as two of sample number, tool clock and UTC say, at a new session as UTC
/// says. Behind it the stages see another session, and so a gap. Until the first break the stamps
/// are the tool's own.
class WELLGYRO_EXPORT RunClock {
 public:
  /// The next sample's stamp, in order; `jumps`: its times contradict those before within one
  /// session. Marked utc_unsynced where the UTC is in doubt.
  const SampleStamp& Take(const SampleStamp& stamp, bool jumps);

  /// Takes the stamps of samples that follow the one of Take() in a SampleBlock, as long as its tie
  /// has nothing to learn of them and says the same of all; says how many. They are handed on as
  /// Continued(), at ToUtc() of their times.
  std::size_t Follow(std::span<const ImuSample> samples);
  SampleStamp Continued(SampleStamp stamp) const;

  /// The UTC that Take() will find for it, to what the stamp itself will teach.
  UtcTime Expected(const SampleStamp& stamp) const;

  /// So far every stamp was handed on as it came.
  bool own() const { return !broken_ && doubt_ == 0; }
  /// Of the last sample, by the tie.
  UtcTime utc() const { return tie_.ToUtc(out_.tool_time); }
  /// Of times a period after each other, as they are handed on, from `first` on.
  void ToUtc(ToolTime first, Duration period, std::span<UtcTime> utc) const {
    tie_.ToUtc(first, period, utc);
  }
  /// By which UTC may be wrong since it jumped against the tool's clock [s]; 0: it has not.
  double doubt() const { return doubt_; }
  /// By which the last sample's UTC was found to have stepped against the tool's clock [s].
  std::optional<double> step() const { return step_; }

 private:
  UtcTime Break(const SampleStamp& stamp, bool jumps);
  void NoteSteps();

  ClockTie tie_;
  std::optional<SampleStamp> in_;  ///< the last stamp as it came
  SampleStamp out_;                ///< and as it was handed on
  Duration ahead_;                 ///< of the times handed on before those that come
  bool broken_ = false;
  std::int32_t session_ = 0;          ///< handed on since the first break
  std::int32_t steps_ = 0;            ///< of the tie, seen
  double doubt_ = 0;                  ///< [s]
  std::optional<ToolTime> restless_;  ///< until then UTC is tied anew
  std::optional<double> step_;
};

}  // namespace wellgyro
