#include <algorithm>
#include <cmath>

#include "wellgyro/noise/phase_blocks_internal.h"

namespace wellgyro {
namespace {

constexpr std::int64_t kQuarter = PhaseBlocks::kBlock / 4;
constexpr std::int64_t kRingBlocks = 130;  // 8 MiB, a little more than 2^20 phases

}  // namespace

PhaseBlocks::PhaseBlocks(std::span<const double> rate, double shift,
                         std::span<const Bridge> bridges)
    : rate_(rate),
      shift_(shift),
      bridges_(bridges),
      samples_(static_cast<std::int64_t>(rate.size())),
      slots_(std::min(kRingBlocks, samples_ / kBlock + 1)),
      ring_(std::make_unique_for_overwrite<double[]>(static_cast<std::size_t>(slots_ * kBlock))) {
  bases_.reserve(static_cast<std::size_t>(samples_ / kBlock + 1));
}

const double* PhaseBlocks::Rates(std::int64_t from, std::int64_t n) {
  const double* y = rate_.data() + from;
  auto b = std::upper_bound(bridges_.begin(), bridges_.end(), from,
                            [](auto at, const Bridge& bridge) { return at < bridge.gap.end; });
  if (b == bridges_.end() || b->gap.begin >= from + n) return y;
  std::copy_n(y, n, bridged_.begin());
  for (; b != bridges_.end() && b->gap.begin < from + n; ++b) {
    std::fill(bridged_.begin() + std::max<std::int64_t>(0, b->gap.begin - from),
              bridged_.begin() + std::min(n, b->gap.end - from), b->value);
  }
  return bridged_.data();
}

// Phases of the block, counted from its own first one and placed on `base`; returns the sum over
// the block. Its quarters are summed side by side, because one sum waits for itself.
double PhaseBlocks::Make(std::int64_t block, const Base& base, double* local, double* phases) {
  const std::int64_t from = block * kBlock;
  const std::int64_t n = std::min(kBlock, samples_ - from);
  const double* y = Rates(from, n);
  std::array<double, 4> sum{};
  if (n == kBlock) {
    for (std::int64_t i = 0; i < kQuarter; ++i) {
      for (std::size_t q = 0; q < 4; ++q) {
        const auto at = static_cast<std::int64_t>(q) * kQuarter + i;
        local[at] = sum[q];
        sum[q] += y[at] - shift_;
      }
    }
  } else {
    for (std::int64_t i = 0; i < n; ++i) {
      auto& s = sum[static_cast<std::size_t>(i / kQuarter)];
      local[i] = s;
      s += y[i] - shift_;
    }
    local[n] = sum[static_cast<std::size_t>(n / kQuarter)];
  }
  const std::int64_t count = std::min(kBlock, n + 1);
  double before = 0;
  for (std::size_t q = 0; q < 4; ++q) {
    const auto begin = static_cast<std::int64_t>(q) * kQuarter;
    const std::int64_t part = std::min(kQuarter, count - begin);
    if (part > 0) {
      PlacePhases(simd_, local + begin, part, before, base.low, base.high, local + begin,
                  phases + begin);
    }
    before += sum[q];
  }
  return before;
}

bool PhaseBlocks::Next() {
  const std::int64_t begin = (block_ + 1) * kBlock;
  if (!finite_ || begin > samples_) return false;
  Base base;
  if (block_ >= 0) {
    for (std::int64_t i = 0; i < kBlock; ++i) {
      local_[static_cast<std::size_t>(i)] = local_[static_cast<std::size_t>(kBlock + i)] - total_;
    }
    const Base& last = bases_.back();
    base.high = last.high + total_;
    const double virtual_part = base.high - last.high;
    base.low = last.low + ((last.high - (base.high - virtual_part)) + (total_ - virtual_part));
  }
  ++block_;
  begin_ = begin;
  count_ = std::min(kBlock, samples_ + 1 - begin);
  remade_used_ = 0;
  joined_used_ = 0;
  bases_.push_back(base);
  total_ = Make(block_, base, local_.data() + kBlock, Slot(block_));
  finite_ = std::abs(total_) <= kBeyondAnySum;  // false for NaN
  return finite_;
}

const double* PhaseBlocks::Remake(std::int64_t block) {
  for (std::size_t i = 0; i < remade_used_; ++i) {
    if (remade_[i]->begin == block) return remade_[i]->phases.data();
  }
  if (remade_used_ == remade_.size()) remade_.push_back(std::make_unique<Stretch>());
  Stretch& stretch = *remade_[remade_used_++];
  stretch.begin = block;
  Make(block, bases_[static_cast<std::size_t>(block)], again_.data(), stretch.phases.data());
  return stretch.phases.data();
}

const double* PhaseBlocks::At(std::int64_t n, std::int64_t count) {
  const auto block_at = [this](std::int64_t block) -> const double* {
    return block > block_ - slots_ ? Slot(block) : Remake(block);
  };
  const std::int64_t block = n / kBlock;
  const std::int64_t offset = n - block * kBlock;
  if (offset + count <= kBlock) return block_at(block) + offset;
  // Across two blocks: joined in a stretch of its own.
  for (std::size_t i = 0; i < joined_used_; ++i) {
    if (joined_[i]->begin == n && joined_[i]->count >= count) return joined_[i]->phases.data();
  }
  if (joined_used_ == joined_.size()) joined_.push_back(std::make_unique<Stretch>());
  Stretch& stretch = *joined_[joined_used_++];
  stretch.begin = n;
  stretch.count = count;
  const std::int64_t left = kBlock - offset;
  std::copy_n(block_at(block) + offset, left, stretch.phases.begin());
  std::copy_n(block_at(block + 1), count - left, stretch.phases.begin() + left);
  return stretch.phases.data();
}

}  // namespace wellgyro
