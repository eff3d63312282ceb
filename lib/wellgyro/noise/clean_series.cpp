#include "wellgyro/noise/clean_series.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <fmt/core.h>

#include "wellgyro/math/linear_algebra.h"
#include "wellgyro/math/median.h"

namespace wellgyro {
namespace {

void AddGap(SampleSeries& series, SampleGap gap) {
  series.gaps.push_back(gap);
  std::sort(series.gaps.begin(), series.gaps.end(),
            [](const SampleGap& a, const SampleGap& b) { return a.begin < b.begin; });
  std::vector<SampleGap> joined;
  for (const SampleGap& next : series.gaps) {
    if (!joined.empty() && next.begin <= joined.back().end) {
      joined.back().end = std::max(joined.back().end, next.end);
    } else {
      joined.push_back(next);
    }
  }
  series.gaps = std::move(joined);
}

std::vector<char> MissingOf(const SampleSeries& series) {
  std::vector<char> missing(series.values.size(), 0);
  for (const SampleGap& gap : series.gaps) {
    const auto end = std::min<std::int64_t>(gap.end, std::ssize(missing));
    for (std::int64_t i = std::max<std::int64_t>(gap.begin, 0); i < end; ++i) {
      missing[static_cast<std::size_t>(i)] = 1;
    }
  }
  for (std::size_t i = 0; i < missing.size(); ++i) {
    if (!std::isfinite(series.values[i])) missing[i] = 1;
  }
  return missing;
}

// Places of the spikes among the readings [begin, end).
void FindSpikes(const SampleSeries& series, const std::vector<char>& missing, std::size_t begin,
                std::size_t end, std::vector<std::size_t>& spikes) {
  std::vector<double> values;
  for (std::size_t i = begin; i < end; ++i) {
    if (missing[i] == 0) values.push_back(series.values[i]);
  }
  if (values.size() < 32) return;
  const double middle = Median(values);
  constexpr double kSigmas = 8;  // P(|x| > 8) = 1.2e-15
  const double limit = kSigmas * RobustSigma(std::move(values), middle);
  if (!(limit > 0)) return;
  for (std::size_t i = begin; i < end; ++i) {
    if (missing[i] == 0 && std::abs(series.values[i] - middle) > limit) spikes.push_back(i);
  }
}

struct Means {
  std::vector<double> at, value, temperature;  ///< middle [samples]
};

Means MeansOf(const SampleSeries& series) {
  Means means;
  const std::vector<char> missing = MissingOf(series);
  const std::size_t n = series.values.size(), length = std::max<std::size_t>(16, n / 2000);
  for (std::size_t begin = 0; begin + length <= n; begin += length) {
    double value = 0, temperature = 0, count = 0;
    for (std::size_t i = begin; i < begin + length; ++i) {
      if (missing[i] != 0) continue;
      value += series.values[i];
      temperature += static_cast<double>(series.temperature[i]);
      count += 1;
    }
    if (count < static_cast<double>(length) / 2) continue;
    means.at.push_back(static_cast<double>(begin) + static_cast<double>(length) / 2);
    means.value.push_back(value / count);
    means.temperature.push_back(temperature / count);
  }
  return means;
}

// Takes the trend off, along the temperature's means: the thermometer's own noise stays out.
void TakeOff(const Means& means, const TemperatureTrend& trend, SampleSeries& series) {
  std::size_t k = 0;
  for (std::size_t i = 0; i < series.values.size(); ++i) {
    const double at = static_cast<double>(i);
    while (k + 2 < means.at.size() && means.at[k + 1] < at) ++k;
    const double part = std::clamp((at - means.at[k]) / (means.at[k + 1] - means.at[k]), 0.0, 1.0);
    const double T = means.temperature[k] +
                     part * (means.temperature[k + 1] - means.temperature[k]) - trend.mean;
    series.values[i] -= T * (trend.per_degree + T * trend.per_degree2);
  }
}

TimesComplaint NotRising(std::span<const double> times) {
  const auto at =
      std::adjacent_find(times.begin(), times.end(), [](double a, double b) { return !(b > a); });
  return {
      "the times do not rise from row to row: sort the rows, write times with all their "
      "digits, or name another column (--time, or --sequence for numbers)",
      static_cast<std::size_t>(at - times.begin()) + 1};
}

}  // namespace

std::optional<TimesComplaint> PlaceByTime(SampleSeries& series, std::span<const double> times) {
  if (times.size() < 3 || times.size() != series.values.size()) {
    return TimesComplaint{"too few times to tell the period of the samples"};
  }
  std::vector<double> steps;
  for (std::size_t i = 1; i < times.size() && i < 100'001; ++i) {
    steps.push_back(times[i] - times[i - 1]);
  }
  const double period = Median(std::move(steps));
  if (!(period > 0)) return NotRising(times);
  // Time of the last place, as the stamps about it have it: their jitter, with which single stamps
  // come nearer than half a period, is smoothed over some 1 / kFollow of them, and a clock that
  // runs by p of a period away is followed to p / kFollow. Behind a gap it begins anew.
  constexpr double kFollow = 0.1;
  double last = times.front();
  std::vector<std::int64_t> place(times.size(), 0);
  for (std::size_t i = 1; i < times.size(); ++i) {
    const double step = (times[i] - last) / period;
    if (!(step > 0.5) || step > static_cast<double>(kGapSamplesMost)) {
      return TimesComplaint{
          fmt::format("its time is {:.6g} s after that of the sample before, where the period is "
                      "{:.6g} s: mend or leave out the row, or name another column (--time, or "
                      "--sequence for numbers)",
                      times[i] - times[i - 1], period),
          i};
    }
    const std::int64_t steps_on = std::llround(step);
    place[i] = place[i - 1] + steps_on;
    last = steps_on > 1 ? times[i] : last + period + kFollow * (times[i] - last - period);
  }
  // Places of missing samples are kept, 8 bytes each: 8 MB, or 100 for each sample there is.
  constexpr std::int64_t kRoom = 1'000'000, kPerSample = 100;
  if (place.back() > kRoom + kPerSample * std::ssize(place)) {
    return TimesComplaint{fmt::format("the times leave {} places for {} samples", place.back() + 1,
                                      std::ssize(place))};
  }
  series.period = (times.back() - times.front()) / static_cast<double>(place.back());
  if (place.back() + 1 == std::ssize(place)) return std::nullopt;
  SampleSeries spread = series;
  spread.values.assign(static_cast<std::size_t>(place.back()) + 1, 0);
  if (!series.temperature.empty()) spread.temperature.assign(spread.values.size(), 0);
  for (std::size_t i = 0; i < place.size(); ++i) {
    const auto at = static_cast<std::size_t>(place[i]);
    spread.values[at] = series.values[i];
    if (i > 0 && place[i] > place[i - 1] + 1) spread.gaps.push_back({place[i - 1] + 1, place[i]});
    if (series.temperature.empty()) continue;
    for (auto k = static_cast<std::size_t>(i > 0 ? place[i - 1] + 1 : 0); k <= at; ++k) {
      spread.temperature[k] = series.temperature[i];
    }
  }
  series = std::move(spread);
  return std::nullopt;
}

std::int64_t Exclude(SampleSeries& series, double from, double to) {
  const double last = static_cast<double>(series.values.size());
  const double begin = std::clamp(std::ceil(from / series.period - 1e-9), 0.0, last);
  const double end = std::clamp(std::ceil(to / series.period - 1e-9), begin, last);
  if (end > begin) {
    AddGap(series, {static_cast<std::int64_t>(begin), static_cast<std::int64_t>(end)});
  }
  return static_cast<std::int64_t>(end - begin);
}

std::int64_t ExcludeSpikes(SampleSeries& series) {
  // Samples about whose median spikes are told: known to 1.25 sigma / sqrt(1000) = 4 %, and short
  // against what drifts.
  constexpr std::size_t kBlock = 1000;
  const std::vector<char> missing = MissingOf(series);
  std::vector<std::size_t> spikes;
  const std::size_t n = series.values.size();
  for (std::size_t begin = 0; begin < n; begin += kBlock) {
    FindSpikes(series, missing, begin, std::min(n, begin + kBlock), spikes);
  }
  if (spikes.empty() || 100 * spikes.size() > n) return 0;
  for (const std::size_t spike : spikes) {
    const auto at = static_cast<std::int64_t>(spike);
    series.gaps.push_back({at, at + 1});
  }
  AddGap(series, series.gaps.back());
  return std::ssize(spikes);
}

std::optional<TemperatureTrend> DetrendTemperature(SampleSeries& series) {
  if (series.temperature.size() != series.values.size()) return std::nullopt;
  const Means means = MeansOf(series);
  const auto n = static_cast<Eigen::Index>(means.at.size());
  if (n < 16) return std::nullopt;
  const Eigen::Map<const Eigen::VectorXd> y(means.value.data(), n), T(means.temperature.data(), n);
  TemperatureTrend trend;
  trend.mean = T.mean();
  const double spread = T.maxCoeff() - T.minCoeff();
  constexpr double kLeast = 0.1;  // [degC]: below it a thermometer's noise would be the regressor
  if (!(spread > kLeast)) return std::nullopt;
  const Eigen::VectorXd x = (T.array() - trend.mean) / spread;
  Eigen::MatrixXd A(n, 3);
  A << Eigen::VectorXd::Ones(n), x, x.cwiseAbs2();
  const Eigen::Vector3d c = SolveLeastSquares(A, y);
  const Eigen::VectorXd left = y - A * c;
  const double variance = left.squaredNorm() / static_cast<double>(n - 3);
  const Eigen::Matrix3d cov = variance * InverseOfSymmetric(A.transpose() * A);
  trend.per_degree = c[1] / spread;
  trend.per_degree2 = c[2] / (spread * spread);
  trend.per_degree_sigma = std::sqrt(std::max(0.0, cov(1, 1))) / spread;
  const double all = (y.array() - y.mean()).matrix().squaredNorm();
  trend.explained = all > 0 ? 1 - left.squaredNorm() / all : 0;
  TakeOff(means, trend, series);
  return trend;
}

}  // namespace wellgyro
