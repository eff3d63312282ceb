#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "wellgyro/base/result.h"
#include "wellgyro/base/time.h"
#include "wellgyro/record/depth.h"

namespace wellgyro {

/// Keeps a depth mark that is ahead of everything else in time until the samples get there, so that
/// one wrong time does not make every true mark late. What waits is handed on in the order of time;
/// a mark that kOthers others have overtaken contradicts them and is told. So are those before the
/// first sample whose next is too far away to be joined to it. Nothing is lost by a stream that is
/// merely ahead of the samples.
class MarkGate {
 public:
  /// Marks that contradict one which they overtake: ten seconds of them at 1 Hz. Those of a stream
  /// that is merely ahead of the samples overtake none.
  static constexpr int kOthers = 10;
  /// That wait at most, 17 minutes at 10 Hz; then the furthest ahead is told and left out, or,
  /// without samples, all are used.
  static constexpr std::size_t kAsideMax = 10'000;

  using Use = std::function<void(const DepthMark&)>;
  using Tell = std::function<void(const Fault&)>;

  /// `ahead`: by so much a mark may be ahead of the newest sample and mark; `max_gap`: between two
  /// marks further apart there is no depth.
  MarkGate(Duration ahead, Duration max_gap, Use use, Tell tell)
      : ahead_(ahead), max_gap_(max_gap), use_(std::move(use)), tell_(std::move(tell)) {}

  void Push(const DepthMark& mark);
  /// Samples that are believed have come up to this time.
  void HeardAt(UtcTime utc);
  /// Hands on everything that waits for a first sample: averages at rest ask for their depth now.
  void Open();
  /// The end: what is still ahead is told.
  void Close();

 private:
  struct Aside {
    DepthMark mark;
    int overtaken = 0;
  };
  /// Further on than the newest sample and mark by more than `ahead`; before the first sample
  /// every mark is, until Open.
  bool IsAhead(UtcTime utc) const;
  void Pass(const DepthMark& mark);
  void Release(UtcTime utc);
  void Overtake();
  void LeaveOutBefore(UtcTime first);
  std::string Ahead(UtcTime utc) const;
  void TellOf(const DepthMark& mark, std::string_view wrong);

  Duration ahead_, max_gap_;
  Use use_;
  Tell tell_;
  bool open_ = false;  ///< before the first sample too
  std::optional<UtcTime> heard_, passed_;
  std::multimap<UtcTime, Aside> aside_;  ///< by time
};

}  // namespace wellgyro
