#include "wellgyro/fit/settled_run.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "wellgyro/math/golden_section.h"

namespace wellgyro {
namespace {

// Two readings of a slow rise may agree by chance; of three the last two would have to.
constexpr std::size_t kFewestReadings = 3;
// Value, amplitude and time constant are three parameters: F of chance 1e-3 (below) is 37 with the
// 5 degrees of freedom that 8 readings leave, 5e5 with one, by which no transient is told. Of one
// of 2 mV the fit leaves 0.009 mV at most, the rule that three agree 0.39 mV (400 runs).
constexpr std::size_t kForTransient = 8;

double Spread(std::span<const double> readings) {
  const auto [low, high] = std::minmax_element(readings.begin(), readings.end());
  return *high - *low;
}

double Mean(std::span<const double> readings) {
  // About the first: readings of some volts that differ by microvolts.
  const double first = readings.front();
  double sum = 0;
  for (const double reading : readings) sum += reading - first;
  return first + sum / static_cast<double>(readings.size());
}

struct Decay {
  double value = 0, amplitude = 0;  ///< value + amplitude exp(-i / readings)
  double readings = 1;              ///< time constant
  double squares = 0;               ///< of the residuals
};

// Straight line against e = exp(-i / readings).
Decay FitDecay(std::span<const double> v, double readings) {
  const double n = static_cast<double>(v.size());
  const double mean = Mean(v);
  double e_sum = 0, ee = 0, ev = 0;
  for (std::size_t i = 0; i < v.size(); ++i) e_sum += std::exp(-static_cast<double>(i) / readings);
  const double e_mean = e_sum / n;
  for (std::size_t i = 0; i < v.size(); ++i) {
    const double e = std::exp(-static_cast<double>(i) / readings) - e_mean;
    ee += e * e;
    ev += e * (v[i] - mean);
  }
  Decay decay{.readings = readings};
  decay.amplitude = ee > 0 ? ev / ee : 0;
  decay.value = mean - decay.amplitude * e_mean;
  for (std::size_t i = 0; i < v.size(); ++i) {
    const double r =
        v[i] - decay.value - decay.amplitude * std::exp(-static_cast<double>(i) / readings);
    decay.squares += r * r;
  }
  return decay;
}

Decay BestDecay(std::span<const double> v) {
  // A step of the grid is 15 % of the time constant for 100 readings; 0.618^40 = 4e-9 of two steps
  // is left by golden section, below which rounding decides.
  constexpr int kGrid = 40, kTurns = 40;
  const double low = std::log(0.3), high = std::log(static_cast<double>(v.size()));
  const auto at = [&](double log_readings) { return FitDecay(v, std::exp(log_readings)); };
  const double step = (high - low) / kGrid;
  double best = low;
  for (int i = 1; i <= kGrid; ++i) {
    if (at(low + i * step).squares < at(best).squares) best = low + i * step;
  }
  const auto squares = [&](double log_readings) { return at(log_readings).squares; };
  int turn = 0;
  const auto goes_on = [&](double, double) { return turn++ < kTurns; };
  return at(GoldenSection(best - step, best + step, squares, goes_on));
}

}  // namespace

SettledRun Settle(std::span<const double> readings, double tolerance) {
  SettledRun run;
  const std::size_t n = readings.size();
  if (n > 0) run.value = Mean(readings.last(std::min(n, kFewestReadings)));
  if (n < kFewestReadings) return run;
  run.spread = Spread(readings.last(kFewestReadings));
  if (n < kForTransient) {
    std::size_t used = kFewestReadings;
    while (used < n && Spread(readings.last(used + 1)) <= tolerance) ++used;
    run.used = static_cast<int>(used);
    run.value = Mean(readings.last(used));
    run.settled = run.spread <= tolerance;
    return run;
  }
  run.used = static_cast<int>(n);
  run.value = Mean(readings);
  run.settled = true;
  double squares = 0;
  for (const double reading : readings) squares += std::pow(reading - run.value, 2);
  const Decay decay = BestDecay(readings);
  // Two parameters more; the F distribution of 2 and nu has this quantile in closed form.
  const double nu = static_cast<double>(n) - 3;
  const double limit = nu / 2 * (std::pow(1e-3, -2 / nu) - 1);
  const double rounding = std::pow(1e-12 * std::abs(run.value), 2);
  if ((squares - decay.squares) / 2 > limit * (decay.squares / nu + rounding)) {
    run.value = decay.value;
    const double left =
        std::abs(decay.amplitude) * std::exp(-static_cast<double>(n - 1) / decay.readings);
    run.settled = left <= tolerance;
  }
  return run;
}

}  // namespace wellgyro
