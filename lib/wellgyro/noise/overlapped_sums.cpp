#include <algorithm>
#include <array>

#include "wellgyro/noise/difference_sums_internal.h"
#include "wellgyro/noise/phase_blocks_internal.h"
#include "wellgyro/noise/term_sums_internal.h"

namespace wellgyro {
namespace {

constexpr std::int64_t kBlock = PhaseBlocks::kBlock;

// Short lags are taken from phases counted from nearby, where nothing has walked away.
bool IsShort(std::int64_t m) { return 2 * m <= kBlock; }

class OverlappedSummer {
 public:
  OverlappedSummer(PhaseBlocks& blocks, std::span<TermSum> sums)
      : blocks_(blocks), sums_(sums), next_(sums.size(), 0), simd_(WidestSimd()) {}

  void AddBlock() {
    for (std::size_t i = 0; i < sums_.size();) {
      const std::size_t chain = WholeChain(i);
      if (chain > 0) {
        AddChain(i, chain);
        i += chain;
      } else {
        AddPieces(i++);
      }
    }
  }

 private:
  // Terms that end in this block, by their first sample.
  TermRange Here(std::int64_t m) const {
    return {blocks_.begin() - 2 * m, blocks_.begin() + blocks_.count() - 2 * m};
  }

  bool AllUsable(std::size_t i) {
    const auto& usable = sums_[i].usable;
    const TermRange here = Here(sums_[i].factor);
    auto& next = next_[i];
    while (next < usable.size() && usable[next].end <= here.begin) ++next;
    return next < usable.size() && usable[next].begin <= here.begin && usable[next].end >= here.end;
  }

  // How many octaves from i on can be taken at once.
  std::size_t WholeChain(std::size_t i) {
    std::size_t chain = 0;
    while (chain < kChainMax && i + chain < sums_.size()) {
      const std::int64_t m = sums_[i + chain].factor;
      if (chain > 0 &&
          (m != 2 * sums_[i + chain - 1].factor || IsShort(m) != IsShort(sums_[i].factor))) {
        break;
      }
      if (!AllUsable(i + chain)) break;
      ++chain;
    }
    return chain;
  }

  const double* Phases(std::int64_t n, std::int64_t count, bool is_short) {
    return is_short ? blocks_.Local(n) : blocks_.At(n, count);
  }

  void AddChain(std::size_t i, std::size_t chain) {
    const std::int64_t n = blocks_.begin();
    const std::int64_t count = blocks_.count();
    const std::int64_t m = sums_[i].factor;
    const bool is_short = IsShort(m);
    std::array<const double*, kChainMax + 1> lags{};
    for (std::size_t j = 0; j <= chain; ++j) lags[j] = Phases(n - (m << j), count, is_short);
    std::array<double, kChainMax> squares{};
    AddSquaredDifferences(simd_, Phases(n, count, is_short), lags.data(), static_cast<int>(chain),
                          count, squares.data());
    for (std::size_t j = 0; j < chain; ++j) {
      sums_[i + j].squares += squares[j];
      sums_[i + j].terms += count;
    }
  }

  void AddPieces(std::size_t i) {
    const std::int64_t m = sums_[i].factor;
    const bool is_short = IsShort(m);
    const TermRange here = Here(m);
    const auto& usable = sums_[i].usable;
    for (std::size_t r = next_[i]; r < usable.size() && usable[r].begin < here.end; ++r) {
      const std::int64_t k = std::max(usable[r].begin, here.begin);
      const std::int64_t count = std::min(usable[r].end, here.end) - k;
      if (count <= 0) continue;
      const std::array<const double*, 2> lags{Phases(k + m, count, is_short),
                                              Phases(k, count, is_short)};
      AddSquaredDifferences(simd_, Phases(k + 2 * m, count, is_short), lags.data(), 1, count,
                            &sums_[i].squares);
      sums_[i].terms += count;
    }
  }

  PhaseBlocks& blocks_;
  std::span<TermSum> sums_;
  std::vector<std::size_t> next_;  // first range of each that is not behind
  Simd simd_;
};

}  // namespace

bool SumOverlapped(const BridgedRates& rates, std::span<TermSum> sums) {
  constexpr std::int64_t kReportEvery = 1024;  // blocks: 8.4e6 phases
  PhaseBlocks blocks(rates.rate, rates.shift, rates.bridges);
  OverlappedSummer summer(blocks, sums);
  for (std::int64_t block = 1; blocks.Next(); ++block) {
    summer.AddBlock();
    if (rates.progress && block % kReportEvery == 0) {
      rates.progress(static_cast<double>(blocks.begin()) / static_cast<double>(blocks.phases()));
    }
  }
  return blocks.finite();
}

}  // namespace wellgyro
