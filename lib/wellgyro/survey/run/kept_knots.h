#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "wellgyro/base/time.h"
#include "wellgyro/record/attitude_sample.h"
#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// One knot, and what is known at its end.
struct KeptKnot {
  RunKnot knot;
  AttitudeSample attitude;
};

/// The knots of a run, in the order of time, to the last bit in less than half of their memory.
///
/// Of each number is kept, as an integer without its leading zero bytes, what its bits are above
/// those of what is expected there: the number of the knot before or, in a row of an increment that
/// is another turned by a right angle or made of others, that. Rows of noise keep their mantissas;
/// what is said twice, stays as it is, or is zero takes half a byte.
class KeptKnots {
 public:
  void Add(const RunKnot& knot, const AttitudeSample& attitude);
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  std::size_t bytes() const;  ///< of memory

  /// In place of what was known at the ends of the knots from number `from` on, of all of them.
  /// Takes the time of these knots.
  void Revise(std::size_t from, std::span<const AttitudeSample> attitude);
  /// At the end of the last knot that ends by then.
  std::optional<AttitudeSample> KnownAt(ToolTime time) const;

  /// Goes through knots one by one, from number `from` on. What it reads holds until anything is
  /// added.
  class Reader {
   public:
    explicit Reader(const KeptKnots& kept, std::size_t from = 0);
    /// The next one; nullptr: there is none.
    const KeptKnot* Next();

   private:
    const KeptKnots& kept_;
    std::size_t block_, at_ = 0;  ///< and the byte in it
    KeptKnot last_;
  };

 private:
  /// Of so many knots none is known but by those before it in the block: to reach one, 32 others
  /// are read on average; the first, which is kept whole, adds 1/64 of its bytes to each.
  static constexpr std::size_t kBlock = 64;
  struct Block {
    std::vector<std::byte> bytes;
    ToolTime end;
  };
  const std::vector<std::byte>& BytesOf(std::size_t block) const {
    return block < blocks_.size() ? blocks_[block].bytes : open_;
  }

  std::size_t size_ = 0;
  std::vector<Block> blocks_;    ///< full ones
  std::vector<std::byte> open_;  ///< the last, with room
  KeptKnot last_;                ///< in it
};

}  // namespace wellgyro
