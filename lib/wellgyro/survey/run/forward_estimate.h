#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "wellgyro/attitude/station_state.h"
#include "wellgyro/attitude/unseen.h"
#include "wellgyro/estimate/forward_run.h"
#include "wellgyro/estimate/run_state.h"
#include "wellgyro/record/attitude_sample.h"
#include "wellgyro/record/increment.h"
#include "wellgyro/record/north_fix.h"
#include "wellgyro/record/run_knot.h"
#include "wellgyro/survey/hole/path_site.h"
#include "wellgyro/survey/job.h"
#include "wellgyro/survey/run/kept_knots.h"
#include "wellgyro/survey/run/run_history.h"
#include "wellgyro/survey/run/waiting_knot.h"

namespace wellgyro {

/// Norths of the run's own stops are part of it.
inline bool UsesFixes(const AlignmentSpec& alignment) {
  return alignment.method == AlignmentSpec::Method::kGyrocompass || alignment.use_fixes;
}

/// A run as it is known on its way, and all that it leaves to be estimated from.
///
/// Without a north gravity alone tells inclination and toolface. When one has come the run so far
/// is solved together and goes on from there knot by knot (ForwardRun), as long as the heading is
/// sure. What adds a north returns true where the heading became sure by it: all stations behind
/// it then have an azimuth.
///
/// A heading is sure below 1 deg, and good enough to go on from below 5 deg (kSureHeading,
/// kRoughHeading say why). From one that was sure the rest may be solved alone, which is what keeps
/// the cost of a long run that loses its heading again and again in bounds.
class ForwardEstimate {
 public:
  /// `job` must outlive this object.
  explicit ForwardEstimate(const Job& job);

  /// The next knot, with its increment. What stands behind it, if that is known, tells how the tool
  /// rolls from there on. Returns the knot as the estimator takes it.
  const RunKnot& Step(const WaitingKnot& waiting, const Increment* next);
  /// Makes the end of the last knot a station: its number among those of the history.
  std::size_t AddStation();

  /// An azimuth from outside that holds at the run's begin.
  bool TieBegin(const AzimuthTie& tie);
  /// The same at the end of the last knot, by a fix that gets its closure; `of_mark`: it is the
  /// job's, of the reference mark.
  bool Tie(NorthFix& fix, bool of_mark);
  /// The north of a stop that ends there, which gets its closure and the likelier of its azimuths.
  bool Use(NorthFix& fix, bool roll_hidden);
  /// Tries again to start where a north is known and no heading is sure yet.
  bool TryAgain();

  bool empty() const { return knots_.empty(); }
  bool azimuth_known() const { return !empty() && known_.azimuth_known; }
  /// How often the run was solved anew so far, and with it the states of all stations.
  std::size_t solutions() const { return solutions_; }
  /// The run goes on knot by knot from a north.
  bool goes_on() const { return forward_.has_value(); }
  const RunState* state() const { return forward_ ? &forward_->state() : nullptr; }
  const RunKnot& last() const { return recent_.back(); }
  /// What is known at the end of the last knot.
  const AttitudeSample& known() const { return known_; }
  /// Where the tool is there.
  const PathSite& site() const { return site_; }
  const KeptKnots& knots() const { return knots_; }
  /// All but knots and attitudes.
  const RunHistory& history() const { return history_; }
  /// All of it.
  RunHistory History() const;

  /// Goes on from what is known now through knots that wait, and leaves the estimate as it was.
  class Ahead {
   public:
    explicit Ahead(ForwardEstimate& now);
    ~Ahead();
    Ahead(const Ahead&) = delete;
    Ahead& operator=(const Ahead&) = delete;
    /// False where its heading is not sure: there is nothing to be told of it.
    bool Step(const WaitingKnot& waiting, const Increment& increment, const Increment* next);
    /// Makes the end of the last knot a station.
    StationState AddStation();
    const RunKnot& last() const { return now_.recent_.back(); }

   private:
    ForwardEstimate& now_;
    ForwardRun forward_;
    UnseenTurn unseen_;
    std::size_t steps_ = 0;
  };

 private:
  /// What was known at the end of so many knots, when it was sure.
  struct Known {
    std::size_t knots;
    RunState state;
  };

  /// The knot as the estimator takes it. `unseen` sums how far the axis turned where nothing was
  /// seen.
  RunKnot KnotOf(const WaitingKnot& waiting, const Increment& increment, UnseenTurn& unseen) const;
  AttitudeSample AttitudeNow() const;
  /// What came since the heading was last sure, all of it where it never was, counted from there:
  /// what is solved from; without what was known on the way.
  RunHistory PartSinceSure() const;
  bool Begin();
  bool KeepIfSure(std::size_t knots);

  const Job& job_;
  PathSite site_;                ///< at the end of the last knot
  RunHistory history_;           ///< but for knots and attitudes, which are in ...
  KeptKnots knots_;              ///< ... here, and the last of them in ...
  std::vector<RunKnot> recent_;  ///< ... here, ForwardRun::kLooksBack or all
  AttitudeSample known_;         ///< at the end of the last one
  UnseenTurn unseen_;
  std::optional<ForwardRun> forward_;  ///< from the first north on
  std::optional<Known> sure_;          ///< when its heading was last sure
  bool begun_roughly_ = false;         ///< about a heading that was not yet sure
  std::size_t solutions_ = 0;
  std::size_t next_try_ = 0;  ///< knots, from which a start is tried again
};

}  // namespace wellgyro
