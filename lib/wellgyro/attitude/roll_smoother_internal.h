#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "wellgyro/attitude/ring_internal.h"
#include "wellgyro/attitude/sample_block_internal.h"

namespace wellgyro::increment {

using Blocks = Ring<Block>;

/// Relative roll psi of blocks: Rauch-Tung-Striebel smoother of the state (psi, psi') whose rate is
/// a random walk, d psi' = q dw, from measured phases psi + v, v white; its mean is the cubic
/// smoothing spline. How a tool turns changes, so q is found for each stretch of blocks: among
/// kWalks the one of greatest likelihood, by the innovations in the stretch and in the one after
/// it, with the noise level free within bounds (Schweppe, IEEE Trans. Inf. Theory 11, 1965).
class RollSmoother {
 public:
  explicit RollSmoother(std::size_t capacity) : seen_(capacity), states_(capacity) {}

  /// Fills roll and rate of blocks [begin, end), looking on to `ahead`, exclusive. Stretches follow
  /// each other, and so do their ends ahead.
  void Smooth(std::uint64_t begin, std::uint64_t end, std::uint64_t ahead, Blocks& blocks);

 private:
  /// Walks of the roll's rate that are tried [rad/s/sqrt(s)]: from a tool that turns as evenly as
  /// two seconds of gravity can tell half a degree from vertical, to one in stick-slip.
  static constexpr std::array<double, 5> kWalks{1e-3, 1e-2, 1e-1, 1, 10};

  struct Seen {  // of a block, what the filters want of it
    double step = 0, phase = 0, noise = 0;
    bool measured = false, linked = false, rests = false;
  };
  struct State {
    double roll = 0, rate = 0, p00 = 1e4, p01 = 0, p11 = 100;  // nothing known
  };
  struct Score {
    double misfit = 0, log_variance = 0, product = 1;
    int count = 0;
  };

  static void Predict(const Seen& seen, double walk, State& s);
  static void Update(const Seen& seen, State& s);
  void Try(std::uint64_t end, const Blocks& blocks);
  double ChooseWalk();
  double Backward(std::uint64_t begin, std::uint64_t end, std::uint64_t ahead, double walk,
                  Blocks& blocks) const;
  void Join(std::uint64_t begin, std::uint64_t end, double before, Blocks& blocks);

  Ring<Seen> seen_;
  std::array<State, kWalks.size()> tried_{};  // after the last block seen
  std::array<Score, kWalks.size()> now_{}, last_{};
  std::vector<State> states_;  // filtered, of the stretch at hand
  State before_;               // filtered, at the last block of the stretch before
  double roll_ = 0;            // its roll as given
};

}  // namespace wellgyro::increment
