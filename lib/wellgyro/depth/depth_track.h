#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/base/time.h"
#include "wellgyro/record/along_hole.h"
#include "wellgyro/record/depth_mark.h"
#include "wellgyro/record/operations.h"

namespace wellgyro {

struct DepthTrackSetup {
  Duration half_window = Duration::Seconds(2);  ///< marks this far on both sides are fitted
  Duration latency = Duration::Seconds(1);      ///< how far behind the newest a mark may come in
  Duration max_gap = Duration::Seconds(5);      ///< between marks, above which depth is unknown
  double sigma_reading = 0.003;                 ///< of one mark, rounding of the encoder [m]
  double sigma_md = 0;                          ///< of marks that bring no sigma of their own [m]
};

/// Depth of the string's reference point against UTC, from the marks of the depth system.
///
/// Depth, speed and acceleration at an instant t are a local quadratic with weights 1 - u^2 over
/// the marks within `half_window` of t (a straight line where fewer than four marks are there): a
/// function of these marks alone. It is never extrapolated beyond the last mark; between marks
/// further apart than `max_gap` depth is unknown, unless the first says `stopped` and both agree
/// within 2 cm. With a 1 cm encoder the speed is good to 2 mm/s and the acceleration to 2 mm/s^2
/// (rms, 10 Hz); at 1 Hz to 4 mm/s and 8 mm/s^2. A change of speed is smeared over the window.
///
/// Depth events cut the track: from a DEPTH_ZERO, DEPTH_REZERO or DEPTH_TIE on depths read value_m
/// there, whether or not the depth system itself was set; earlier depths stay. No fit spans one.
class WELLGYRO_EXPORT DepthTrack {
 public:
  /// Throws std::invalid_argument when a duration or sigma is not positive as it must be.
  explicit DepthTrack(const DepthTrackSetup& setup = {});

  /// Takes a mark, sorting it in where it is out of order. Marks seen before (session and seq) are
  /// skipped in silence; one that is `latency` or more behind the newest is refused.
  [[nodiscard]] std::optional<Fault> Push(const DepthMark& mark);
  /// Takes a depth event, before or after the marks around it; other kinds, and an event_id seen
  /// before, are skipped. Refused (kLate) when the marks at its time are forgotten already.
  [[nodiscard]] std::optional<Fault> Push(const Event& event);

  AlongHole At(UtcTime utc) const;
  /// At(utc) is final: no mark that may still come in changes it.
  bool Covers(UtcTime utc) const;
  /// How far behind the newest mark Covers() stays.
  Duration lag() const { return setup_.half_window + setup_.latency; }
  bool empty() const { return marks_.empty(); }
  UtcTime newest() const { return newest_; }
  /// Depth events that hold at `utc`, so far pushed: where it changes, depth may jump.
  std::int32_t Segment(UtcTime utc) const;
  /// Drops what is needed only before `utc`. Without it memory grows with the marks.
  void Forget(UtcTime utc);

 private:
  struct Mark {
    UtcTime utc;
    std::int64_t seq;
    std::int32_t session;
    bool stopped;
    double md;
    double sigma;
  };
  /// A stretch between depth events, as marks and limits.
  struct Span {
    std::size_t begin, end;
  };
  struct Shift {
    UtcTime utc;
    std::int64_t seq;
    double value, sigma;
    std::int32_t event_id;
    bool settled;
    double offset;  ///< to add to the marks; where settled
  };

  Span SpanAt(UtcTime utc) const;
  const Shift* ShiftAt(UtcTime utc) const;
  double Offset(const Shift& shift) const;
  bool Bracketed(UtcTime utc, Span span) const;
  bool Seen(const DepthMark& mark) const;
  void Settle();

  DepthTrackSetup setup_;
  std::vector<Mark> marks_;    // by time
  std::vector<Shift> shifts_;  // by time
  UtcTime newest_;
  std::optional<UtcTime> forgotten_;  // marks before it are gone
};

}  // namespace wellgyro
