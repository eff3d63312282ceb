#include "wellgyro/plan/stop_search.h"

#include <algorithm>
#include <cmath>

#include "wellgyro/base/angle.h"
#include "wellgyro/plan/stop_pairs.h"

namespace wellgyro {
namespace {

using Rest = StopStand::Rest;

// Halved or doubled, each leaves the plan of the demonstration's well the same.
constexpr double kLeastGain = 1e-7;  // of the logarithm, per second: 0.1 % in 10 000 s
constexpr std::size_t kKept = 24;    // places looked at again, beside those near the stops
constexpr std::size_t kNear = 2;     // places to either side
constexpr int kRounds = 3;           // of replacing, shifting and turning, while they save

double HiddenLimit(const PlanLimits& limits) { return limits.hidden.value_or(HUGE_VAL); }

class Search {
 public:
  Search(const StopInformation& info, const PlanLimits& limits)
      : info_(info), limits_(limits), stand_(info, limits.ellipse, HiddenLimit(limits)) {}

  std::optional<std::vector<Rest>> Run(std::span<const Rest> start) {
    if (Floor(0) > 0) stand_.Add({0, 0, Floor(0)});
    bool met = Fill(stand_);
    if (met) {
      // A north may be needed, whatever the run alone would come to.
      if (CountOf(stand_) < limits_.fewest) {
        const Choice best = BestRest(stand_);
        stand_.Add(best.gain > 0 ? best.rest : Rest{0, 0, Least(0) - Floor(0)});
      }
      Trim(stand_);
      Improve();
    }
    const auto take = [&](const std::vector<Rest>& rests) {
      if (rests.empty() || !TakeIfBelow(met ? Cost(stand_) : HUGE_VAL, StandOf(rests))) return;
      met = true;
      Improve();
    };
    if (!limits_.here) {
      take(StopsOf(start));
      const double cost = met ? Cost(stand_) : HUGE_VAL;
      take(BestOfTwo(info_, limits_, cost).value_or(std::vector<Rest>()));
    }
    if (!met) return std::nullopt;
    return Stops();
  }

  std::optional<std::vector<Rest>> Mend(const std::vector<Rest>& stops) {
    if (!TakeIfBelow(HUGE_VAL, StandOf(stops))) return std::nullopt;
    Improve();
    return Stops();
  }

 private:
  struct Choice {
    Rest rest;
    double gain = 0;            // of ln soft, per second
    double enough = -HUGE_VAL;  // ln soft below which nothing is gained
  };

  /// In the order of time.
  std::vector<Rest> Stops() const {
    std::vector<Rest> stops(stand_.stops().begin(), stand_.stops().end());
    std::sort(stops.begin(), stops.end(),
              [](const Rest& a, const Rest& b) { return a.place < b.place; });
    return stops;
  }

  bool IsHere(std::size_t place) const { return limits_.here && place == 0; }
  double Overhead(std::size_t place) const { return IsHere(place) ? 0 : limits_.overhead; }
  /// Of the time at a place, what no plan can take back.
  double Floor(std::size_t place) const { return IsHere(place) ? limits_.here->fresh : 0; }
  /// More than that it is a stop only from here on.
  double Least(std::size_t place) const {
    if (!IsHere(place)) return limits_.least_stop;
    return std::max(limits_.here->fresh, limits_.least_stop - limits_.here->known);
  }
  double Longest(std::size_t place) const {
    return limits_.longest_stop - (IsHere(place) ? limits_.here->known : 0);
  }

  double Cost(const StopStand& stand) const {
    double cost = stand.at_rest();
    for (const Rest& stop : stand.stops()) cost += Overhead(stop.place);
    return cost;
  }

  std::size_t CountOf(const StopStand& stand) const {
    const auto counts = [this](const Rest& r) { return r.seconds >= Least(r.place); };
    return static_cast<std::size_t>(
        std::count_if(stand.stops().begin(), stand.stops().end(), counts));
  }

  /// The stop that stands at a place; the tool is turned once there.
  static const Rest* StopIn(std::span<const Rest> stops, std::size_t place) {
    const auto found = std::find_if(stops.begin(), stops.end(),
                                    [place](const Rest& r) { return r.place == place; });
    return found == stops.end() ? nullptr : &*found;
  }
  static const Rest* StopAt(const StopStand& stand, std::size_t place) {
    return StopIn(stand.stops(), place);
  }

  void Try(const StopStand& stand, const Rest& rest, double cost, double before,
           Choice& best) const {
    // What gains less than the best is not looked at to the end.
    const double most = std::exp(before - best.gain * cost);
    const double after = std::max(best.enough, std::log(stand.ValueWith(rest, most).soft));
    const double gain = (before - after) / cost;
    if (gain > best.gain) best = {rest, gain, best.enough};
  }

  /// Every way to rest longer at one place.
  void TryPlace(const StopStand& stand, std::size_t place, double before, Choice& best) const {
    const Rest* stop = StopAt(stand, place);
    if (stop == nullptr && !IsHere(place)) {
      const int turns = limits_.turns ? kToolfaces : 1;
      for (int i = 0; i < turns; ++i) {
        for (const double factor : {1., 2., 4.}) {
          const double seconds = std::min(factor * limits_.least_stop, limits_.longest_stop);
          Try(stand, {place, kTwoPi * i / kToolfaces, seconds}, seconds + limits_.overhead, before,
              best);
        }
      }
      return;
    }
    const double seconds = stop != nullptr ? stop->seconds : 0;
    for (const double step : {kStopGrain, 0.5 * limits_.least_stop, limits_.least_stop}) {
      const double more = std::max(step, Least(place) - seconds);
      if (seconds + more > Longest(place)) continue;
      Try(stand, {place, stop != nullptr ? stop->turn : 0, more}, more, before, best);
    }
  }

  Choice BestRest(const StopStand& stand, double enough = -HUGE_VAL) const {
    Choice best{.enough = enough};
    const double before = std::log(stand.Value().soft);
    for (const std::size_t place : stand.places()) TryPlace(stand, place, before, best);
    return best;
  }

  /// Adds rest until both limits are met. False: that takes too long. `just`: what is gained below
  /// the limits counts for nothing, so that little that lacks is had by resting a little.
  bool Fill(StopStand& stand, double cost_most = HUGE_VAL, bool just = false) const {
    while (!stand.Meets()) {
      const Choice best = BestRest(stand, just ? 0 : -HUGE_VAL);
      const bool ends = just && best.gain > 0 && stand.MeetsWith(best.rest);
      if (!ends && !(best.gain > kLeastGain)) return false;
      stand.Add(best.rest);
      if (stand.at_rest() > limits_.most_at_rest || Cost(stand) > cost_most) return false;
    }
    return true;
  }

  /// Shortens what is longer than it need be, that first which is worth the least.
  void Trim(StopStand& stand) const {
    for (;;) {
      Choice best{{}, -HUGE_VAL};
      const double before = std::log(stand.Value().soft);
      for (const Rest& stop : stand.stops()) {
        const bool last = CountOf(stand) <= limits_.fewest;
        const bool shorter = stop.seconds - kStopGrain >= Least(stop.place);
        const double all = stop.seconds - Floor(stop.place);
        for (const double less : {shorter ? kStopGrain : 0, last ? 0 : all}) {
          if (!(less > 0)) continue;
          const Rest back{stop.place, stop.turn, -less};
          const PlanValue value = stand.ValueWith(back);
          if (!value.Meets(limits_.ellipse, HiddenLimit(limits_))) continue;
          const double saved = less + (less == all ? Overhead(stop.place) : 0);
          const double gain = (before - std::log(value.soft)) / saved;
          if (gain > best.gain) best = {back, gain};
        }
      }
      if (best.gain == -HUGE_VAL) return;
      stand.Add(best.rest);
    }
  }

  /// Keeps the places near the stops and those that alone would be worth the most.
  void Narrow() {
    const double before = std::log(stand_.Value().soft);
    std::vector<std::pair<double, std::size_t>> worth;
    for (const std::size_t place : stand_.places()) {
      const Rest rest{place, 0, limits_.least_stop};
      worth.emplace_back(before - std::log(stand_.ValueWith(rest).soft), place);
    }
    std::sort(worth.rbegin(), worth.rend());
    std::vector<std::size_t> kept{0};
    for (std::size_t i = 0; i < std::min(kKept, worth.size()); ++i) kept.push_back(worth[i].second);
    const std::size_t count = stand_.places().size();
    for (const Rest& stop : stand_.stops()) {
      const std::size_t first = stop.place > kNear ? stop.place - kNear : 0;
      for (std::size_t i = first; i <= std::min(stop.place + kNear, count - 1); ++i) {
        kept.push_back(i);
      }
    }
    stand_.Keep(kept);
  }

  void Improve() {
    Narrow();
    for (int round = 0; round < kRounds; ++round) {
      const double before = Cost(stand_);
      for (std::size_t i = 0; i < stand_.stops().size(); ++i) Replace(i);
      for (std::size_t i = 0; i < stand_.stops().size(); ++i) Shift(i);
      for (std::size_t i = 0; i < stand_.stops().size(); ++i) Turn(i);
      if (!(Cost(stand_) < before)) break;
    }
  }

  bool TakeIfBelow(double cost, StopStand tried, bool just = false) {
    if (!Fill(tried, cost, just)) return false;
    if (CountOf(tried) < limits_.fewest) return false;
    Trim(tried);
    if (!(Cost(tried) < cost)) return false;
    stand_ = std::move(tried);
    return true;
  }
  void TakeIfBetter(StopStand tried, bool just = false) {
    TakeIfBelow(Cost(stand_), std::move(tried), just);
  }

  StopStand StandOf(const std::vector<Rest>& rests) const {
    StopStand stand(info_, limits_.ellipse, HiddenLimit(limits_));
    for (const Rest& rest : rests) stand.Add(rest);
    return stand;
  }

  /// Those times that make more than half a stop, the longest at a place.
  std::vector<Rest> StopsOf(std::span<const Rest> times) const {
    std::vector<Rest> left(times.begin(), times.end()), stops;
    std::sort(left.begin(), left.end(),
              [](const Rest& a, const Rest& b) { return a.seconds > b.seconds; });
    for (Rest rest : left) {
      if (rest.seconds < 0.5 * limits_.least_stop || StopIn(stops, rest.place) != nullptr) continue;
      const double grains = std::ceil((rest.seconds - limits_.least_stop) / kStopGrain);
      rest.seconds =
          std::min(limits_.least_stop + kStopGrain * std::max(0., grains), limits_.longest_stop);
      stops.push_back(rest);
    }
    return stops;
  }

  void Replace(std::size_t i) {
    for (const bool just : {false, true}) {
      if (i >= stand_.stops().size()) return;
      const Rest stop = stand_.stops()[i];
      const double seconds = stop.seconds - Floor(stop.place);
      if (!(seconds > 0)) return;
      StopStand tried = stand_;
      tried.Add({stop.place, stop.turn, -seconds});
      TakeIfBetter(std::move(tried), just);
    }
  }

  void Shift(std::size_t i) {
    for (const int by : {-2, -1, 1, 2}) {
      if (i >= stand_.stops().size()) return;
      const Rest stop = stand_.stops()[i];
      if (IsHere(stop.place)) return;
      const auto to = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(stop.place) + by);
      const auto places = stand_.places();
      if (std::find(places.begin(), places.end(), to) == places.end()) continue;
      if (StopAt(stand_, to) != nullptr) continue;
      StopStand tried = stand_;
      tried.Add({stop.place, stop.turn, -stop.seconds});
      tried.Add({to, stop.turn, stop.seconds});
      TakeIfBetter(std::move(tried));
    }
  }

  void Turn(std::size_t i) {
    for (const int by : {-1, 1}) {
      if (!limits_.turns || i >= stand_.stops().size()) return;
      const Rest stop = stand_.stops()[i];
      if (IsHere(stop.place)) return;
      StopStand tried = stand_;
      tried.Add({stop.place, stop.turn, -stop.seconds});
      tried.Add({stop.place, stop.turn + by * kTwoPi / kToolfaces, stop.seconds});
      TakeIfBetter(std::move(tried));
    }
  }

  const StopInformation& info_;
  const PlanLimits limits_;
  StopStand stand_;
};

}  // namespace

std::optional<std::vector<Rest>> FindStops(const StopInformation& info, const PlanLimits& limits,
                                           std::span<const Rest> start) {
  return Search(info, limits).Run(start);
}

std::optional<std::vector<Rest>> MendStops(const StopInformation& info, const PlanLimits& limits,
                                           const std::vector<Rest>& stops) {
  return Search(info, limits).Mend(stops);
}

PlanValue BestPossible(const StopInformation& info, const PlanLimits& limits) {
  StopStand stand(info, limits.ellipse, HiddenLimit(limits));
  const std::size_t step = std::max<std::size_t>(1, info.places() / 40);
  for (std::size_t i = 0; i < info.places(); i += step) {
    const int turns = limits.turns ? 4 : 1;
    for (int t = 0; t < turns; ++t) stand.Add({i, kTwoPi * t / turns, 3600. / turns});
  }
  return stand.Value();
}

}  // namespace wellgyro
