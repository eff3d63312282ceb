#pragma once

#include <cstddef>
#include <deque>
#include <span>
#include <vector>

#include "wellgyro/attitude/station_state.h"
#include "wellgyro/record/increment.h"
#include "wellgyro/record/north_fix.h"
#include "wellgyro/record/quality.h"
#include "wellgyro/record/run_knot.h"
#include "wellgyro/record/sample.h"
#include "wellgyro/survey/job.h"
#include "wellgyro/survey/run/draft_book.h"
#include "wellgyro/survey/run/forward_estimate.h"
#include "wellgyro/survey/run/waiting_knot.h"

namespace wellgyro {

/// The stations of a run as drafts. One is told at once, *ahead*, while its knot still waits, by
/// the increments that the samples there are give; its state follows when the knot is known. A
/// station carries what was not seen (gaps, saturation, aliasing) on the whole way since the one
/// listed before it: its azimuth hangs on all of that.
class RunDrafts {
 public:
  /// All drafts, and which of them are to be told.
  DraftBook& book() { return book_; }
  const DraftBook& book() const { return book_; }
  /// How many, the youngest, are told ahead.
  std::size_t ahead() const { return states_ahead_.size(); }
  /// States of stations, in their order: those of the run's history, `known`, then those told
  /// ahead.
  std::vector<StationState> States(std::span<const StationState> known) const;
  const StationState& State(std::size_t number, std::span<const StationState> known) const;

  /// The knot just stepped; a draft that waited for it becomes a station of `estimate`.
  void Take(const WaitingKnot& waiting, ForwardEstimate& estimate);
  /// Those of knots that wait, as far as there are increments for them.
  void TellAhead(std::span<const Increment> increments, ForwardEstimate& estimate,
                 WaitingKnots& waiting);
  /// Some of the knots that wait have a draft that is listed and not told. Those that are not are
  /// told with the next one: of depths in whole metres each mark ends a rest.
  static bool AnyUntold(const WaitingKnots& waiting);
  /// Averages at rest that the tool made itself, of which this is the north.
  void Add(const StillWindow& window, const NorthFix& fix);

  /// The station made last is asked for after all.
  void ListLast(WaitingKnots& waiting);
  /// The station of a stop gets what its north fix says of the place; `list`: it is asked for.
  void TakeStop(const NorthFix& fix, bool list);
  /// The deepest station of the in-runs so far closes the survey, and none before it any more.
  void CloseAtDeepest();

 private:
  void Add(const Draft& waiting, std::size_t state, const RunKnot& knot, Quality unseen,
           bool heard);

  DraftBook book_;
  std::deque<StationState> states_ahead_;  ///< of the youngest drafts, whose knots still wait
  Quality unseen_ = Quality::kGood;        ///< since the last station that is listed
};

}  // namespace wellgyro
