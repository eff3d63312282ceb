#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "wellgyro/base/export.h"
#include "wellgyro/base/time.h"
#include "wellgyro/record/station.h"

namespace wellgyro {

struct PassSetup {
  double reversal = 2;      ///< way back from the furthest point that makes a new pass [m]
  double first_move = 0.1;  ///< way from the start that ends the stationary pass [m]
};

/// Where a run stands after a depth.
struct PassState {
  Pass pass = Pass::kStationary;
  std::int32_t number = 1;  ///< of the pass in the run, from 1
  bool begins = false;      ///< this depth is the first of the pass
  /// Furthest depth the pass has reached: never decreases in kIn and kRepeat, never increases in
  /// kOut. A station is made when it passes the station's depth [m].
  double md = 0;
  UtcTime utc_turn;    ///< when the tool was at the turn where the pass begins
  double md_turn = 0;  ///< depth of that turn [m]
};

/// Splits depth against time into the passes of a run.
///
/// Stationary until the tool leaves its starting depth, then in or out. A new pass begins when the
/// tool has come back by `reversal` from the furthest point; smaller steps back are ignored, so
/// that the way between the turn and its discovery belongs to the old pass and `md` starts at the
/// depth of discovery; after the stationary pass, the way from `md_turn` on belongs to the new one.
/// Going in above the deepest point already reached going in is a repeat; at that point an in pass
/// begins again. Stops do not end a pass.
class WELLGYRO_EXPORT PassTracker {
 public:
  /// Throws std::invalid_argument unless 0 < first_move <= reversal.
  explicit PassTracker(const PassSetup& setup = {});

  /// Takes the depth at an instant later than the one before.
  const PassState& Push(UtcTime utc, double md);
  /// The furthest depth after these as well, where it is plain that no pass begins among them; as
  /// Push of each would find, but for this.
  std::optional<double> FurthestWithin(std::span<const double> md) const;
  /// Takes depths for which FurthestWithin() has a value.
  const PassState& Push(std::span<const UtcTime> utc, std::span<const double> md);
  /// The depth scale changes before the next depth (see DepthTrack::Segment): a pass of the same
  /// kind begins there, and what was covered before counts no more.
  void Restart();

  const PassState& state() const { return state_; }

 private:
  void Start(UtcTime utc, double md);
  void LeaveStationary(UtcTime utc, double md);
  void Begin(Pass pass, UtcTime utc, double md);
  Pass Inward(double md) const;

  PassSetup setup_;
  PassState state_;
  bool started_ = false;
  bool restart_ = false;
  UtcTime utc_furthest_;
  double md_low_ = 0, md_high_ = 0;   ///< of the stationary pass
  std::optional<double> deepest_in_;  ///< reached going in [m]
};

}  // namespace wellgyro
