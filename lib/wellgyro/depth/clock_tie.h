#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "wellgyro/base/export.h"
#include "wellgyro/base/time.h"
#include "wellgyro/record/sample.h"

namespace wellgyro {

struct ClockTieSetup {
  double sigma_pair = 2e-3;   ///< first guess of the jitter of a second's pairs [s]
  double sigma_drift = 1e-4;  ///< of the tool clock's rate before any pair [1]
  /// Of that rate in use [1/sqrt(s)]: in an hour 6e-7, and 1.2 ms of the offset.
  double walk_drift = 1e-8;
  double unsynced_factor = 100;  ///< times sigma_pair where the surface doubts its UTC
};

/// Offset and drift of UTC against the tool's clock, from the samples' own pairs of both.
///
/// Pairs are averaged over whole seconds of the tool clock and filtered (offset and rate, random
/// walk of the rate); the jitter is learnt. A second of pairs far out is left out; five in a row
/// that agree are a step of UTC, which the offset follows and `steps` counts. All sums are integers
/// relative to the first pair, so that days cost no digits. A new session starts afresh.
///
/// Causal: what it says depends on the samples pushed so far, so convert a sample's time when it
/// is pushed. Only the first sample of a batch carries a pair of its own, the others follow at the
/// nominal period: a pair is taken where utc - tool_time changes (or has not for ten seconds), so
/// that batch size moves the tie by no more than the pairs' own jitter.
class WELLGYRO_EXPORT ClockTie {
 public:
  /// Pairs are averaged over cells; so many refused in a row make a step: UTC that is wrong for
  /// less than 5 s moves nothing.
  static constexpr Duration kCell{1'000'000'000};
  static constexpr int kCellsOfStep = 5;

  explicit ClockTie(const ClockTieSetup& setup = {});

  /// Takes a pair; times that do not advance within a session are ignored.
  void Push(const SampleStamp& stamp);

  /// Takes the pairs of `count` samples that follow the one pushed last, of `last`, each a period
  /// behind the one before on both clocks, as long as they bring nothing new; says how many. As
  /// Push of each would, at less cost.
  std::size_t Follow(ToolTime last, Duration period, std::size_t count);

  /// True from the first pair on; the conversions need it.
  bool known() const { return known_; }
  /// A straight line, in a session's own times.
  UtcTime ToUtc(ToolTime time) const;
  /// Of times a period after each other, from `first` on.
  void ToUtc(ToolTime first, Duration period, std::span<UtcTime> utc) const;
  double Sigma(ToolTime time) const;       ///< of ToUtc(time) [s]
  double drift() const { return drift_; }  ///< UTC seconds per tool second, less one
  double sigma_drift() const;
  /// No synchronised pair in the last minute, or pairs just now contradict the tie.
  bool doubtful() const;
  int steps() const { return steps_; }   ///< of UTC, in this session
  double step() const { return step_; }  ///< the last of them [s]
  std::int32_t session() const { return session_; }

 private:
  /// Pairs of the second in progress: sums relative to its first.
  struct Cell {
    std::int64_t index = 0;                   ///< second of the tool clock
    std::int64_t tool_ns = 0;                 ///< first pair, since tool0_
    std::int64_t difference = 0;              ///< its (utc - utc0_) - (tool - tool0_) [ns]
    std::int64_t pairs = 0, synced = 0;       ///< unsynced ones only until a synced one comes
    double sum_tool = 0, sum_difference = 0;  ///< [s]
  };

  void Restart(const SampleStamp& stamp);
  void AddPair(std::int64_t tool_ns, std::int64_t difference, bool synced);
  void CloseCell();
  void Predict(std::int64_t tool_ns);
  void Update(double innovation, double variance);
  void Refuse(double innovation, double variance, bool synced);
  void Learn(double surprise);
  void Rescale(double factor);
  double CellVariance(bool synced) const;

  ClockTieSetup setup_;
  bool known_ = false;
  std::int32_t session_ = 0;
  ToolTime tool0_;  ///< first pair: all below counts from it
  UtcTime utc0_;    ///< of the first pair, moved along by steps
  std::int64_t last_ns_ = 0;
  std::int64_t difference_ = 0;  ///< of the last sample
  std::int64_t fresh_ns_ = 0;    ///< last pair taken
  Cell cell_;
  std::int64_t cells_ = 0;   ///< taken
  std::int64_t mid_ns_ = 0;  ///< where offset_ holds, since tool0_
  double offset_ = 0;        ///< (utc - utc0_) - (tool - tool0_) [s]
  double drift_ = 0;
  double p00_ = 0, p01_ = 0, p11_ = 0;
  double scale_ = 1;                       ///< learnt jitter variance over the first guess
  std::optional<std::int64_t> synced_ns_;  ///< the last synchronised second taken, since tool0_
  int refused_ = 0;                        ///< seconds in a row that agree with each other
  double refused_sum_ = 0;
  int steps_ = 0;
  double step_ = 0;
};

}  // namespace wellgyro
