#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "wellgyro/noise/difference_sums_internal.h"
#include "wellgyro/noise/gap_terms_internal.h"

namespace wellgyro {

/// The phases x[n] = sum of rate[i] - shift, i < n, block after block, with any earlier stretch at
/// hand: lately made ones from a ring, older ones made again from the rates. So an analysis of any
/// length needs a few MiB beside its data.
///
/// Within a block phases are summed from the block's first one; the block's own phase is carried as
/// the unevaluated sum of two doubles, so that rounding never accumulates.
class PhaseBlocks {
 public:
  /// [phases], 64 KiB; summed from their first, they are rounded by n eps / 2 = 9e-13 of the sizes.
  static constexpr std::int64_t kBlock = 8192;

  PhaseBlocks(std::span<const double> rate, double shift, std::span<const Bridge> bridges);

  /// Makes the next block; false when there is none or when the rates in it are not finite.
  bool Next();
  bool finite() const { return finite_; }

  std::int64_t begin() const { return begin_; }  ///< first phase of the block
  std::int64_t count() const { return count_; }  ///< phases in it
  std::int64_t phases() const { return samples_ + 1; }

  /// Phase `n` of this block or the one before, from this block's first phase: exact to the
  /// rounding of sums over two blocks, however far the phase has walked.
  const double* Local(std::int64_t n) const { return local_.data() + kBlock + (n - begin_); }

  /// `count` <= kBlock phases from `n` on, anywhere up to the end of this block. Stays until Next.
  const double* At(std::int64_t n, std::int64_t count);

 private:
  /// The phase at a block's begin as the unevaluated sum high + low.
  struct Base {
    double high = 0;
    double low = 0;
  };
  /// Phases made again, or joined from two blocks, for one that asks for them.
  struct Stretch {
    std::int64_t begin = -1;
    std::int64_t count = 0;
    std::array<double, kBlock> phases;
  };

  const double* Rates(std::int64_t from, std::int64_t n);
  double Make(std::int64_t block, const Base& base, double* local, double* phases);
  const double* Remake(std::int64_t block);
  /// Where the ring holds a block, or would.
  double* Slot(std::int64_t block) { return ring_.get() + (block % slots_) * kBlock; }

  std::span<const double> rate_;
  double shift_;
  std::span<const Bridge> bridges_;
  std::int64_t samples_;
  std::int64_t slots_;
  std::unique_ptr<double[]> ring_;
  std::vector<Base> bases_;
  std::array<double, 2 * kBlock> local_{};
  std::array<double, kBlock> bridged_{};
  std::array<double, kBlock> again_{};
  std::vector<std::unique_ptr<Stretch>> remade_;
  std::size_t remade_used_ = 0;
  std::vector<std::unique_ptr<Stretch>> joined_;
  std::size_t joined_used_ = 0;
  Simd simd_ = WidestSimd();
  std::int64_t block_ = -1;
  std::int64_t begin_ = 0;
  std::int64_t count_ = 0;
  double total_ = 0;
  bool finite_ = true;
};

}  // namespace wellgyro
