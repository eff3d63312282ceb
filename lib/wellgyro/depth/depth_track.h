#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/base/time.h"
#include "wellgyro/math/interpolation.h"
#include "wellgyro/record/along_hole.h"
#include "wellgyro/record/depth_mark.h"
#include "wellgyro/record/operations.h"

namespace wellgyro {

struct DepthTrackSetup {
  Duration half_window = Duration::Seconds(2);  ///< marks this far on both sides are fitted
  Duration latency = Duration::Seconds(1);      ///< how far behind the newest a mark may come in
  Duration max_gap = Duration::Seconds(5);      ///< between marks, above which depth is unknown
  double speed_limit = 10;       ///< faster steps between marks are jumps of the counter [m/s]
  double sigma_reading = 0.003;  ///< of one mark, rounding of the encoder [m]
  double sigma_md = 0;           ///< of marks that bring no sigma of their own [m]
};

/// What one mark says, before anything is made of it.
struct MarkRead {
  UtcTime utc;
  double md = 0;  ///< [m]
};

/// Depth of the string's reference point against UTC, from the marks of the depth system.
///
/// Depth, speed and acceleration at an instant t are a local quadratic with weights 1 - u^2 over
/// the marks nearer to t than `half_window`, where these are no further apart than half of it: a
/// function of these marks alone. Marks rarer than that are joined by a monotone cubic, whose
/// sigmas say how much the speed changes from mark to mark, so that whoever needs the acceleration
/// knows where it is not known. Depth never leaves the range of the marks it rests on, and is never
/// extrapolated beyond the last.
/// Between marks further apart than `max_gap` depth is unknown, unless the first says `stopped` and
/// both agree within 2 cm; across a jump of the counter it is unknown, and no fit spans one.
/// A 1 cm encoder on a winch that swings by 4 cm/s gives speed and acceleration to 1 mm/s and
/// 2 mm/s^2 rms at 10 Hz, to 2 mm/s and 5 mm/s^2 at 1 Hz; one count at rest reads as 5 mm/s. A
/// sudden change of speed is smeared over the window. Sigmas follow the scatter of the marks about
/// the fit, or, where it holds too few, from mark to mark over the last of them. Marks that repeat
/// one reading count as fewer, and quantisation that does not show as scatter is added as an error
/// common to all. Truncation of the parabola is included where it exceeds the scatter; of a string
/// that sticks within a window the sigmas may still be a third of the error.
///
/// Depth events cut the track: from a DEPTH_ZERO, DEPTH_REZERO or DEPTH_TIE on depths read value_m
/// there, whether or not the depth system itself was set; earlier depths stay. No fit spans one.
/// Without marks about an event the system is taken to have been set.
class WELLGYRO_EXPORT DepthTrack {
 public:
  /// Throws std::invalid_argument when a duration or sigma is not positive as it must be.
  explicit DepthTrack(const DepthTrackSetup& setup = {});

  /// Takes a mark, sorting it in where it is out of order. Marks seen before (session and seq) are
  /// skipped in silence; one that is `latency` or more behind the newest is refused.
  [[nodiscard]] std::optional<Fault> Push(const DepthMark& mark);
  /// Takes a depth event, before or after the marks around it; other kinds, and an event_id seen
  /// before of the session, are skipped. Refused (kLate) when the marks at its time are forgotten
  /// already.
  [[nodiscard]] std::optional<Fault> Push(const Event& event);

  AlongHole At(UtcTime utc) const { return AtRest(utc, utc); }
  /// At the middle of a time at rest that others than the marks know of: it does not count to the
  /// gap between two marks that agree within 2 cm, and which may lie at its ends.
  AlongHole AtRest(UtcTime begin, UtcTime end) const;
  /// At(utc) is final: no mark that may still come in changes it. Events must be in by then.
  bool Covers(UtcTime utc) const;
  /// How far behind the newest mark Covers() stays.
  Duration lag() const { return Reach() + setup_.latency; }
  /// How long after an instant the marks that tell its depth are made, or have come.
  Duration wait() const { return std::max(setup_.half_window + setup_.latency, setup_.max_gap); }
  bool empty() const { return marks_.empty(); }
  /// The first mark at or after `utc` of those that are in, as the depth system sent it.
  std::optional<MarkRead> FirstMark(UtcTime utc) const;
  UtcTime newest() const { return newest_; }
  /// Depth events that hold at `utc`, so far pushed: where it changes, depth may jump.
  std::int32_t Segment(UtcTime utc) const { return shifts_.empty() ? 0 : SegmentAt(utc); }
  /// Drops what is needed only before `utc`. Without it memory grows with the marks.
  void Forget(UtcTime utc);

 private:
  /// Of the half window: marks no further apart are fitted, others joined.
  static constexpr double kDense = 0.55;
  /// Marks that tell of the scatter where the window holds too few.
  static constexpr std::size_t kMemory = 24;

  struct Mark {
    UtcTime utc;
    std::int64_t seq;
    std::int32_t session;
    bool stopped;
    bool jumps;  ///< the counter jumped between the mark before and this one
    double md;
    double sigma;
  };
  /// Marks [begin, end) that one fit may use.
  struct Span {
    std::size_t begin, end;
  };
  /// Squares of the scatter of single marks, summed, and of how many degrees of freedom.
  struct Scatter {
    double squares = 0, freedom = 0;
  };
  /// Squares of what a fit misses, of its value and derivatives by the half window.
  struct Bend {
    double value = 0, slope = 0, curvature = 0;
  };
  struct Shift {
    UtcTime utc;
    std::int64_t seq;
    double value, sigma;
    std::int32_t session, event_id;
    std::optional<double> offset;  ///< to add to the marks, once it is final
  };

  std::size_t After(UtcTime utc) const;
  std::int32_t SegmentAt(UtcTime utc) const;
  Span SpanAt(UtcTime utc) const;
  double Offset(const Shift& shift) const;
  bool Bracketed(UtcTime utc, Span span, UtcTime rest_begin, UtcTime rest_end) const;
  bool Seen(const DepthMark& mark) const;
  bool Settled(UtcTime utc) const;
  void NoteJump(std::size_t i);
  std::optional<Fault> DropSpike(std::size_t last);
  /// How far from an instant the marks may be that tell its depth.
  Duration Reach() const { return std::max(setup_.half_window, setup_.max_gap); }
  bool Sparse(UtcTime utc) const;
  AlongHole Join(UtcTime utc, Span span) const;
  AlongHole Fitted(UtcTime utc, Span span) const;
  Scatter ScatterAbout(UtcTime utc) const;
  double Noise(Scatter scatter) const;
  double Common(Scatter scatter) const;
  Bend BendOf(UtcTime utc, Span span, const LocalFit::Value& y, double noise) const;

  DepthTrackSetup setup_;
  std::vector<Mark> marks_;    ///< by time
  std::vector<Shift> shifts_;  ///< by time
  UtcTime newest_;
  std::optional<UtcTime> forgotten_;  ///< marks before it are gone
  std::int32_t session_ = 0;          ///< of the newest mark
  std::int64_t seq_ = 0;              ///< highest of that session
};

}  // namespace wellgyro
