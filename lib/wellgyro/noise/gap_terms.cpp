#include <algorithm>
#include <cmath>
#include <limits>

#include "wellgyro/noise/gap_terms_internal.h"

namespace wellgyro {
namespace {

void Append(std::vector<TermRange>& ranges, std::int64_t begin, std::int64_t end) {
  if (begin >= end) return;
  if (!ranges.empty() && ranges.back().end == begin) {
    ranges.back().end = end;
  } else {
    ranges.push_back({begin, end});
  }
}

}  // namespace

std::vector<TermRange> UsableTerms(std::int64_t samples, std::int64_t window, std::int64_t allowed,
                                   std::span<const SampleGap> gaps) {
  const std::int64_t terms = samples - window + 1;
  std::vector<TermRange> ranges;
  if (terms <= 0) return ranges;
  // The number missing in [k, k + window) is piecewise linear in k: it rises while the window's
  // leading edge crosses a gap and falls while the trailing edge does.
  std::int64_t missing = 0;
  for (const auto& gap : gaps) {
    missing += std::max<std::int64_t>(0, std::min(gap.end, window) - gap.begin);
  }
  constexpr auto kNever = std::numeric_limits<std::int64_t>::max();
  std::size_t lead = 0;   // first gap that the leading edge has not left
  std::size_t trail = 0;  // likewise the trailing edge
  for (std::int64_t k = 0; k < terms;) {
    while (lead < gaps.size() && gaps[lead].end - window <= k) ++lead;
    while (trail < gaps.size() && gaps[trail].end <= k) ++trail;
    std::int64_t next = terms;
    int slope = 0;
    const auto edge = [&](std::size_t gap, std::int64_t back, int change) {
      const std::int64_t begin = gap < gaps.size() ? gaps[gap].begin - back : kNever;
      if (begin > k) {
        next = std::min(next, begin);
      } else {
        slope += change;
        next = std::min(next, gaps[gap].end - back);
      }
    };
    edge(lead, window, 1);
    edge(trail, 0, -1);
    const std::int64_t length = next - k;
    if (slope == 0) {
      if (missing <= allowed) Append(ranges, k, next);
    } else if (slope > 0) {
      Append(ranges, k, k + std::clamp<std::int64_t>(allowed - missing + 1, 0, length));
    } else {
      Append(ranges, k + std::clamp<std::int64_t>(missing - allowed, 0, length), next);
    }
    missing += slope * length;
    k = next;
  }
  return ranges;
}

std::vector<Bridge> BridgesOver(std::span<const double> rate, std::span<const SampleGap> gaps) {
  const auto samples = static_cast<std::int64_t>(rate.size());
  std::vector<Bridge> bridges;
  bridges.reserve(gaps.size());
  for (std::size_t g = 0; g < gaps.size(); ++g) {
    const auto [begin, end] = gaps[g];
    const std::int64_t reach = end - begin;
    const std::int64_t from = std::max(g > 0 ? gaps[g - 1].end : 0, begin - reach);
    const std::int64_t to =
        std::min(g + 1 < gaps.size() ? gaps[g + 1].begin : samples, end + reach);
    double sum = 0;
    std::int64_t count = 0;
    double anchor = 0;
    const auto add = [&](std::int64_t i) {
      const double y = rate[static_cast<std::size_t>(i)];
      if (count++ == 0) anchor = y;
      sum += y - anchor;
    };
    for (std::int64_t i = from; i < begin; ++i) add(i);
    for (std::int64_t i = end; i < to; ++i) add(i);
    bridges.push_back({gaps[g], count > 0 ? anchor + sum / static_cast<double>(count) : 0});
  }
  return bridges;
}

std::vector<SampleGap> NotFinite(std::span<const double> rate) {
  std::vector<SampleGap> found;
  for (std::size_t i = 0; i < rate.size(); ++i) {
    if (std::abs(rate[i]) <= kBeyondAnySensor) continue;  // false for NaN
    const auto at = static_cast<std::int64_t>(i);
    if (!found.empty() && found.back().end == at) {
      ++found.back().end;
    } else {
      found.push_back({at, at + 1});
    }
  }
  return found;
}

std::vector<SampleGap> Union(std::span<const SampleGap> a, std::span<const SampleGap> b) {
  std::vector<SampleGap> all(a.begin(), a.end());
  all.insert(all.end(), b.begin(), b.end());
  std::sort(all.begin(), all.end(),
            [](const SampleGap& l, const SampleGap& r) { return l.begin < r.begin; });
  std::vector<SampleGap> merged;
  for (const auto& gap : all) {
    if (gap.begin >= gap.end) continue;
    if (!merged.empty() && gap.begin <= merged.back().end) {
      merged.back().end = std::max(merged.back().end, gap.end);
    } else {
      merged.push_back(gap);
    }
  }
  return merged;
}

}  // namespace wellgyro
