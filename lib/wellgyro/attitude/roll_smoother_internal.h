#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "wellgyro/attitude/ring_internal.h"
#include "wellgyro/attitude/sample_block_internal.h"

namespace wellgyro::increment {

using Blocks = Ring<Block>;

/// Relative roll psi of blocks, from what gravity said of it in each: the smoothing spline whose
/// rate walks by `walk` rad/s per root second, which is the smoothed state (psi, psi') of that
/// model. The walk is chosen for each stretch from decades by likelihood of the stretch and what
/// follows it, the level of the noise free (Wahba's generalised likelihood, Ann. Stat. 13, 1985).
class RollSmoother {
 public:
  explicit RollSmoother(std::size_t capacity) : states_(capacity) {}
  /// Fills roll and rate of blocks [begin, end) from those up to `ahead`, exclusive.
  void Smooth(std::uint64_t begin, std::uint64_t end, std::uint64_t ahead, Blocks& blocks);

 private:
  struct State {
    double roll = 0, rate = 0, p00 = 1e4, p01 = 0, p11 = 100;  // nothing known
  };
  struct Score {
    double misfit = 0, log_variance = 0;
    int count = 0;
    double value() const;
  };

  static void Predict(double h, double walk, bool linked, State& s);
  static void Update(const Block& block, State& s, Score& score);
  Score Forward(std::uint64_t begin, std::uint64_t end, double walk, const Blocks& blocks,
                bool keep);
  double Backward(std::uint64_t begin, std::uint64_t end, std::uint64_t ahead, double walk,
                  Blocks& blocks) const;
  void Join(std::uint64_t begin, std::uint64_t end, double before, Blocks& blocks);

  std::vector<State> states_;  // filtered, of the stretch at hand
  State before_;               // filtered, at the last block of the stretch before
  double roll_ = 0;            // its roll as given
};

}  // namespace wellgyro::increment
