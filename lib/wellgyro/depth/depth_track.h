#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/base/time.h"
#include "wellgyro/math/interpolation.h"
#include "wellgyro/record/along_hole.h"
#include "wellgyro/record/depth.h"
#include "wellgyro/record/operations.h"

namespace wellgyro {

struct DepthTrackSetup {
  Duration half_window = Duration::Seconds(2);  ///< marks this far behind are fitted
  Duration ahead = Duration::Seconds(0.8);      ///< and, where they are dense, this far ahead
  Duration latency = Duration::Seconds(1);      ///< how far behind the newest a mark may come in
  Duration max_gap = Duration::Seconds(5);      ///< between marks, above which depth is unknown
  double speed_limit = 10;       ///< faster steps between marks are jumps of the counter [m/s]
  double sigma_reading = 0.003;  ///< of one mark, 1 cm / sqrt(12) of an encoder [m]
  double sigma_md = 0;           ///< of marks that bring no sigma of their own [m]
};

/// What one mark says, before anything is made of it.
struct MarkRead {
  UtcTime utc;
  double md = 0;  ///< [m]
};

/// Depth of the string's reference point against UTC, from the marks of the depth system.
///
/// Depth, speed and acceleration at an instant t are a local quadratic over the marks from
/// `half_window` before t to `ahead` after it, with weights 1 - u^2 by u from -1 to 1 over this
/// time; where the marks about t are too far apart for that (0.77 s), to `half_window` after it.
/// Marks rarer still (1.1 s) are joined by a monotone cubic, whose sigmas say how much the speed
/// changes from mark to mark. Depth never leaves the range of the marks it rests on, is never
/// extrapolated, and is a function of the marks of Knows() alone.
/// Between marks further apart than `max_gap` depth is unknown, unless the first says `stopped`,
/// both agree within 2 cm and the second is no further ahead; across a jump of the counter it is
/// unknown, and no fit spans one.
/// A 1 cm encoder on a winch that swings by 4 cm/s gives speed and acceleration to 2 mm/s and
/// 3 mm/s^2 rms at 10 Hz, to 2 mm/s and 5 mm/s^2 at 1 Hz; one count at rest reads as 11 mm/s. A
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
  /// At(utc) is final where all marks and events up to `until` are in: no other one changes it.
  /// That takes `ahead`; where marks are rare, the next one or two of them, or `max_gap`.
  bool Knows(UtcTime utc, UtcTime until) const;
  Duration ahead() const { return setup_.ahead; }
  Duration latency() const { return setup_.latency; }
  /// How far from an instant the marks may be that tell its depth.
  Duration reach() const { return std::max(setup_.half_window, setup_.max_gap); }
  bool empty() const { return marks_.empty(); }
  /// The first mark at or after `utc` of those that are in, as the depth system sent it.
  std::optional<MarkRead> FirstMark(UtcTime utc) const;
  UtcTime newest() const { return newest_; }
  /// Depths are needed from here on; the earliest counts. To be said before Forget().
  void NeedFrom(UtcTime utc) { needed_ = needed_ ? std::min(*needed_, utc) : utc; }
  /// Of the marks from where depths are needed up to `until`, as the depth system sent them [m];
  /// nothing without marks, or where an event has shifted them.
  std::optional<double> Deepest(UtcTime until) const;
  /// Depth events that hold at `utc`, so far pushed: where it changes, depth may jump.
  std::int32_t Segment(UtcTime utc) const { return shifts_.empty() ? 0 : SegmentAt(utc); }
  /// Drops what is needed only before `utc`. Without it memory grows with the marks.
  void Forget(UtcTime utc);

 private:
  /// Of the time that a fit spans: its marks are no further apart. It takes three at least, which
  /// gaps of up to 1/3 leave it; 17 % less for jitter.
  static constexpr double kDense = 0.275;
  /// Marks that tell of the scatter where the window holds too few: 21 third differences, 9 degrees
  /// of freedom.
  static constexpr std::size_t kMemory = 24;

  struct Mark {
    UtcTime utc;
    std::int64_t seq;
    std::int32_t session;
    bool stopped;
    bool jumps;    ///< the counter jumped between the mark before and this one
    bool doubted;  ///< far off the way before: the next mark may tell that it was none
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
  /// Squares of what a fit misses, of its value and derivatives by half the time it spans.
  struct Bend {
    double value = 0, slope = 0, curvature = 0;
  };
  /// A fit's time, in units of half of it: its middle, seen from the instant.
  struct Window {
    double half;  ///< [s]
    double middle;
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
  Span SpanAt(UtcTime utc, Duration ahead) const;
  double Offset(const Shift& shift) const;
  bool Bracketed(UtcTime utc, Span span, UtcTime rest_begin, UtcTime rest_end) const;
  bool Seen(const DepthMark& mark) const;
  bool OffsetIsKnown(const Shift& shift, UtcTime until) const;
  bool Stands(UtcTime last, UtcTime until) const;
  void Note(std::size_t i);
  std::optional<Fault> DropSpikes(std::size_t around);
  std::optional<Fault> DropSpike(std::size_t middle);
  double GapAt(UtcTime utc) const;
  bool Sparse(double gap) const;
  Duration AheadAt(UtcTime utc) const;
  Window WindowAt(UtcTime utc) const {
    const double behind = setup_.half_window.seconds(), ahead = AheadAt(utc).seconds();
    return {(behind + ahead) / 2, (ahead - behind) / (behind + ahead)};
  }
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
  std::optional<UtcTime> forgotten_;      ///< marks before it are gone
  std::optional<UtcTime> needed_;         ///< depths are, from here on
  double deepest_forgotten_ = -HUGE_VAL;  ///< from there on [m]
  std::int32_t session_ = 0;              ///< of the newest mark
  std::int64_t seq_ = 0;                  ///< highest of that session
};

}  // namespace wellgyro
