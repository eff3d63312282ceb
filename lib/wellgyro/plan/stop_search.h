#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "wellgyro/plan/stop_information.h"
#include "wellgyro/plan/stop_stand.h"

namespace wellgyro {

/// To which a tool may be turned before a stop, evenly spread: 22.5 deg from the best at most,
/// whose part is then cos 22.5 deg = 0.92.
inline constexpr int kToolfaces = 8;

/// What a plan must meet and what stops may be like.
struct PlanLimits {
  double ellipse = 5;  ///< semi-major axis of the end's 95 % ellipse, at most [m]
  /// Horizontal shift of the end by a fault that stays unseen, at most [m]; absent: not asked.
  std::optional<double> hidden = {};
  double least_stop = 60;        ///< [s]
  double longest_stop = 900;     ///< [s]
  double overhead = 30;          ///< that a stop costs beside its time at rest [s]
  double most_at_rest = 14'400;  ///< over all stops [s]
  bool turns = false;            ///< the tool may be turned to a toolface before a stop
  std::size_t fewest = 1;        ///< stops: the first north fix needs one
  /// A tool at rest at the first place: what it adds there costs its time alone.
  struct Here {
    double known = 0;  ///< of the rest so far, what the information holds [s]
    double fresh = 0;  ///< what it does not: part of every plan [s]
  };
  std::optional<Here> here = {};
};

/// Stops that meet both limits in little time, or none where that is not possible.
///
/// Greedy by what a second buys, the overhead counted; then every stop is shortened, let go and
/// sought anew, turned, and moved to its neighbours, as long as that saves time. The same from
/// `start`, times that may be as those of LeastAtRest(). Against both stands the best plan of one
/// or two stops, see BestOfTwo(): two toolfaces half a turn apart part the gyros' biases from the
/// Earth's rate, where the first alone buys little. With more stops a local optimum: the bound of
/// LeastAtRest() tells how far it can be from the best.
std::optional<std::vector<StopStand::Rest>> FindStops(const StopInformation& info,
                                                      const PlanLimits& limits,
                                                      std::span<const StopStand::Rest> start = {});

/// The same from stops that nearly meet both, alone: a local optimum near to them.
std::optional<std::vector<StopStand::Rest>> MendStops(const StopInformation& info,
                                                      const PlanLimits& limits,
                                                      const std::vector<StopStand::Rest>& stops);

/// Times at rest that meet the ellipse's limit were any length allowed and no overhead.
struct RelaxedPlan {
  double least = 0;                         ///< no set of stops meets it with less in all [s]
  std::vector<StopStand::Rest> rests = {};  ///< that come to it within 0.2 %
};

/// Nothing where no time does. The end's largest eigenvalue f is convex in the times d, so that
/// f(d) - g'(d* - d) bounds it below, g = -grad f: sum d* is at least (f(d) - limit + g'd) / max g
/// (Joshi and Boyd, IEEE Trans. Signal Process. 57 (2009) 451).
std::optional<RelaxedPlan> LeastAtRest(const StopInformation& info, const PlanLimits& limits);

/// What an hour at rest at some forty places would come to: no plan of use does better.
PlanValue BestPossible(const StopInformation& info, const PlanLimits& limits);

}  // namespace wellgyro
