#include "wellgyro/plan/stop_search.h"

#include <algorithm>
#include <cmath>

#include "wellgyro/base/angle.h"

namespace wellgyro {
namespace {

using Rest = StopStand::Rest;

constexpr int kToolfaces = 8;
constexpr double kGrain = 10;        // [s] to which times are found
constexpr double kLeastGain = 1e-7;  // of the logarithm, per second
constexpr std::size_t kKept = 24;    // places looked at again, beside those near the stops
constexpr std::size_t kNear = 2;     // places to either side
constexpr int kRounds = 3;

double HiddenLimit(const PlanLimits& limits) { return limits.hidden.value_or(HUGE_VAL); }

class Search {
 public:
  Search(const StopInformation& info, const PlanLimits& limits)
      : limits_(limits), stand_(info, limits.ellipse, HiddenLimit(limits)) {}

  std::optional<std::vector<Rest>> Run() {
    if (!Fill(stand_)) return std::nullopt;
    // A north may be needed, whatever the run alone would come to.
    if (stand_.stops().size() < limits_.fewest) {
      const Choice best = BestRest(stand_);
      stand_.Add(best.gain > 0 ? best.rest : Rest{0, 0, limits_.least_stop});
    }
    Trim(stand_);
    Narrow();
    for (int round = 0; round < kRounds; ++round) {
      const double before = Cost(stand_);
      for (std::size_t i = 0; i < stand_.stops().size(); ++i) Replace(i);
      for (std::size_t i = 0; i < stand_.stops().size(); ++i) Shift(i);
      if (!(Cost(stand_) < before)) break;
    }
    std::vector<Rest> stops(stand_.stops().begin(), stand_.stops().end());
    std::sort(stops.begin(), stops.end(),
              [](const Rest& a, const Rest& b) { return a.place < b.place; });
    return stops;
  }

 private:
  struct Choice {
    Rest rest;
    double gain = 0;  // of ln soft, per second
  };

  double Cost(const StopStand& stand) const {
    return stand.at_rest() + limits_.overhead * static_cast<double>(stand.stops().size());
  }

  /// The stop that stands at a place; the tool is turned once there.
  static const Rest* StopAt(const StopStand& stand, std::size_t place) {
    const auto found = std::find_if(stand.stops().begin(), stand.stops().end(),
                                    [place](const Rest& r) { return r.place == place; });
    return found == stand.stops().end() ? nullptr : &*found;
  }

  void Try(const StopStand& stand, const Rest& rest, double cost, double before,
           Choice& best) const {
    const double gain = (before - std::log(stand.ValueWith(rest).soft)) / cost;
    if (gain > best.gain) best = {rest, gain};
  }

  Choice BestRest(const StopStand& stand) const {
    Choice best;
    const double before = std::log(stand.Value().soft);
    for (const std::size_t place : stand.places()) {
      if (const Rest* stop = StopAt(stand, place)) {
        for (const double more : {kGrain, 0.5 * limits_.least_stop, limits_.least_stop}) {
          if (stop->seconds + more > limits_.longest_stop) continue;
          Try(stand, {place, stop->turn, more}, more, before, best);
        }
        continue;
      }
      const int turns = limits_.turns ? kToolfaces : 1;
      for (int i = 0; i < turns; ++i) {
        for (const double factor : {1., 2., 4.}) {
          const double seconds = std::min(factor * limits_.least_stop, limits_.longest_stop);
          Try(stand, {place, kTwoPi * i / kToolfaces, seconds}, seconds + limits_.overhead, before,
              best);
        }
      }
    }
    return best;
  }

  /// Adds rest until both limits are met. False: that takes too long.
  bool Fill(StopStand& stand, double cost_most = HUGE_VAL) const {
    while (!stand.Meets()) {
      const Choice best = BestRest(stand);
      if (!(best.gain > kLeastGain)) return false;
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
        const bool last = stand.stops().size() <= limits_.fewest;
        const bool shorter = stop.seconds - kGrain >= limits_.least_stop;
        for (const double less : {shorter ? kGrain : 0, last ? 0 : stop.seconds}) {
          if (less == 0) continue;
          const Rest back{stop.place, stop.turn, -less};
          const PlanValue value = stand.ValueWith(back);
          if (!stand.MeetsWith(back)) continue;
          const double saved = less + (less == stop.seconds ? limits_.overhead : 0);
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
    std::vector<std::size_t> kept;
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

  void TakeIfBetter(StopStand tried) {
    if (!Fill(tried, Cost(stand_))) return;
    if (tried.stops().size() < limits_.fewest) return;
    Trim(tried);
    if (Cost(tried) < Cost(stand_)) stand_ = std::move(tried);
  }

  void Replace(std::size_t i) {
    if (i >= stand_.stops().size()) return;
    StopStand tried = stand_;
    const Rest stop = stand_.stops()[i];
    tried.Add({stop.place, stop.turn, -stop.seconds});
    TakeIfBetter(std::move(tried));
  }

  void Shift(std::size_t i) {
    for (const int by : {-2, -1, 1, 2}) {
      if (i >= stand_.stops().size()) return;
      const Rest stop = stand_.stops()[i];
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

  const PlanLimits limits_;
  StopStand stand_;
};

}  // namespace

std::optional<std::vector<Rest>> FindStops(const StopInformation& info, const PlanLimits& limits) {
  return Search(info, limits).Run();
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
