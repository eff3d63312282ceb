#include "wellgyro/noise/allan_stream.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "wellgyro/noise/difference_sums_internal.h"
#include "wellgyro/noise/gap_terms_internal.h"

namespace wellgyro {
namespace {

// Running sums of `rates`; returns the last. Quarters are summed side by side, because one sum
// waits for itself.
double SumUp(const double* rates, std::int64_t count, double* sums) {
  const std::int64_t quarter = count / 4;
  double a = 0;
  double b = 0;
  double c = 0;
  double d = 0;
  for (std::int64_t i = 0; i < quarter; ++i) {
    sums[i] = a += rates[i];
    sums[quarter + i] = b += rates[quarter + i];
    sums[2 * quarter + i] = c += rates[2 * quarter + i];
    sums[3 * quarter + i] = d += rates[3 * quarter + i];
  }
  b += a;
  c += b;
  d += c;
  for (std::int64_t i = 0; i < quarter; ++i) {
    sums[quarter + i] += a;
    sums[2 * quarter + i] += b;
    sums[3 * quarter + i] += c;
  }
  for (std::int64_t i = 4 * quarter; i < count; ++i) sums[i] = d += rates[i];
  return d;
}

}  // namespace

AllanStream::AllanStream(double period) : period_(period), levels_(1) {
  if (!(period > 0) || std::isinf(period)) {
    throw std::invalid_argument("AllanStream: period must be positive, not " +
                                std::to_string(period));
  }
}

void AllanStream::Push(std::span<const double> rates) {
  while (!rates.empty()) {
    const auto room = static_cast<std::size_t>(kBlock - levels_.front().pending);
    const auto chunk = rates.first(std::min(room, rates.size()));
    bool good = true;
    for (const double rate : chunk) good &= std::abs(rate) <= kBeyondAnySensor;
    if (good) {
      Append(chunk);
    } else {
      for (std::size_t i = 0; i < chunk.size(); ++i) AppendOrSkip(chunk.subspan(i, 1));
    }
    rates = rates.subspan(chunk.size());
  }
}

void AllanStream::AppendOrSkip(std::span<const double> rate) {
  if (std::abs(rate.front()) <= kBeyondAnySensor) {
    Append(rate);
    return;
  }
  if (!not_finite_.empty() && not_finite_.back().end == samples_) {
    ++not_finite_.back().end;
  } else {
    not_finite_.push_back({samples_, samples_ + 1});
  }
  Skip(1);
}

// At most as many as the bottom level has room for.
void AllanStream::Append(std::span<const double> rates) {
  if (!begun_) {
    begun_ = true;
    shift_ = rates.front();
  }
  Level& bottom = levels_.front();
  double* to = bottom.rates.data() + bottom.pending;
  for (std::size_t i = 0; i < rates.size(); ++i) to[i] = rates[i] - shift_;
  const auto count = static_cast<std::int64_t>(rates.size());
  samples_ += count;
  segment_ += count;
  bottom.pending += count;
  if (bottom.pending == kBlock) Process(0);
}

void AllanStream::Skip(std::int64_t samples) {
  if (samples <= 0) return;
  EndSegment();
  samples_ += samples;
  missing_ += samples;
}

// Phases of what is pending, on the history; differences; then the sums of two go one level up.
void AllanStream::Process(std::size_t index) {
  const std::int64_t count = levels_[index].pending;
  std::array<double, kHistory + kBlock + 1> phases;
  Level& level = levels_[index];
  std::copy(level.history.begin(), level.history.end(), phases.begin());
  phases[kHistory] = 0;
  double* const sums = phases.data() + kHistory + 1;
  const double sum = SumUp(level.rates.data(), count, sums);
  TakeDifferences(index, sums, count);
  for (std::size_t i = 0; i < kHistory; ++i) {
    level.history[i] = phases[i + static_cast<std::size_t>(count)] - sum;
  }
  level.pending = 0;
  level.processed += count;
  if (index + 1 == levels_.size()) levels_.emplace_back();
  // Whole blocks give half a block each, so the one above is filled exactly.
  const double* pair = levels_[index].rates.data();
  Level& above = levels_[index + 1];
  for (std::int64_t i = 0; i + 1 < count; i += 2) {
    above.rates[static_cast<std::size_t>(above.pending++)] = pair[i] + pair[i + 1];
  }
  if (above.pending == kBlock) Process(index + 1);
}

// `phases` begins with the one after the first pending sample.
void AllanStream::TakeDifferences(std::size_t index, const double* phases, std::int64_t count) {
  static const Simd simd = WidestSimd();
  Level& level = levels_[index];
  const int octaves = index == 0 ? kOctavesBelow : 1;
  const std::int64_t first = index == 0 ? 1 : kOverlap;
  const auto begin_of = [&](int octave) {
    return std::clamp<std::int64_t>(2 * (first << octave) - level.processed - 1, 0, count);
  };
  const bool all = begin_of(octaves - 1) == 0;
  for (int o = 0; o < octaves; o += all ? octaves : 1) {
    const int chain = all ? octaves : 1;
    const std::int64_t begin = begin_of(o);
    std::array<const double*, kOctavesBelow + 1> lags{};
    for (int j = 0; j <= chain; ++j) {
      lags[static_cast<std::size_t>(j)] = phases + begin - (first << (o + j));
    }
    AddSquaredDifferences(simd, phases + begin, lags.data(), chain, count - begin,
                          level.squares.data() + o);
    for (int j = o; j < o + chain; ++j) level.taken[static_cast<std::size_t>(j)] += count - begin;
  }
}

void AllanStream::EndSegment() {
  for (std::size_t i = 0; i < levels_.size(); ++i) {
    // Processing may open a level above, never one for a single sample left over.
    if (levels_[i].pending > 0) Process(i);
    Level& level = levels_[i];
    level.processed = 0;
    const int octaves = i == 0 ? kOctavesBelow : 1;
    for (int o = 0; o < octaves; ++o) {
      const std::int64_t m = i == 0 ? std::int64_t{1} << o : kOverlap << i;
      level.stands_for[static_cast<std::size_t>(o)] +=
          std::max<std::int64_t>(0, segment_ - 2 * m + 1);
    }
  }
  segment_ = 0;
}

AllanResult AllanStream::Result() const {
  AllanStream whole = *this;
  whole.EndSegment();
  AllanResult result;
  result.deviation = Deviation::kOverlapped;
  result.period = period_;
  result.samples = samples_;
  result.missing = missing_;
  result.not_finite = not_finite_;
  for (std::size_t i = 0; i < whole.levels_.size(); ++i) {
    const Level& level = whole.levels_[i];
    const int octaves = i == 0 ? kOctavesBelow : 1;
    for (int o = 0; o < octaves; ++o) {
      const auto at = static_cast<std::size_t>(o);
      if (level.taken[at] == 0) continue;
      const std::int64_t m = i == 0 ? std::int64_t{1} << o : kOverlap << i;
      const auto factor = static_cast<double>(m);
      const double mean = level.squares[at] / static_cast<double>(level.taken[at]);
      result.points.push_back(
          {m, factor * period_, level.stands_for[at], mean / (2 * factor * factor)});
    }
  }
  return result;
}

}  // namespace wellgyro
