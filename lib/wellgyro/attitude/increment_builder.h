#pragma once

#include <cstddef>
#include <memory>

#include "wellgyro/base/export.h"
#include "wellgyro/base/time.h"
#include "wellgyro/base/units.h"
#include "wellgyro/record/increment.h"
#include "wellgyro/record/sample.h"
#include "wellgyro/record/sample_block.h"

namespace wellgyro {

struct IncrementOptions {
  enum Order {
    kSecond,  ///< each sample by itself: error of the turn falls as period^2
    kThird,   ///< turn and roll that change together within a sample too, from its neighbours
  };
  Order order = kThird;
  double accel_noise = 0;        ///< of the mean over t seconds: this / sqrt(t) [m/s^2 sqrt(s)]
  double angle_random_walk = 0;  ///< of the transverse gyros [rad/sqrt(s)]
  /// Constant error of the accelerometers across the axis, 1 sigma: a phase is believed where
  /// gravity across is five times that [m/s^2]. Up to 0.017 the least inclination of 0.5 deg
  /// decides instead.
  double accel_bias = 0.005;
  double gravity = units::kStandardGravity;  ///< near enough [m/s^2]
};

/// Whether the sample comes behind the one before, where there is one: not late, not sent twice,
/// with a period, and finite.
bool CanFollow(const SampleStamp* before, const ImuSample& sample);

/// Sums the samples of two transverse gyros (a third where there is one) and three accelerometers
/// to Increments between knots. It holds no attitude, no inclination and no Earth: what an
/// increment says is the sensors' own.
///
/// Samples go into blocks of some 20 ms at most (one sample where that is longer), which keep
/// three moments in time of every channel. The relative roll psi of the blocks is the phase of
/// gravity across the axis, freed of what the turning of the axis adds to it, smoothed against a
/// walk of its rate that the samples themselves choose; where gravity says nothing the rate goes
/// on. Blocks are turned by e^{i psi} and summed. What comes out does not depend on where knots are
/// cut but for the knots' own ends, nor on when it is fetched.
///
/// Increments come out 6 to 12 s behind the samples, the same live and offline. A knot of more than
/// 20 s ends by itself. Push() allocates nothing.
///
/// Over a second, perfect sensors of 10 Hz and more: 1e-9 rad of the axis in a tool that turns at
/// up to 20 rpm, 2e-8 where the roll swings by 8 deg at 0.7 Hz; turns are summed to the second
/// order in U, so that a whirl of 0.1 deg leaves 3e-8. Noise of the relative roll adds 1e-7 at
/// most.
class WELLGYRO_EXPORT IncrementBuilder {
 public:
  /// Throws std::invalid_argument for an option outside its domain.
  explicit IncrementBuilder(const IncrementOptions& options);
  ~IncrementBuilder();
  IncrementBuilder(IncrementBuilder&&) noexcept;
  IncrementBuilder& operator=(IncrementBuilder&&) noexcept;
  /// A copy goes on by itself: flushed, it tells at once what the other will tell later by more
  /// samples. To assign copies what waits, some 12 s, and allocates nothing.
  IncrementBuilder(const IncrementBuilder& other);
  IncrementBuilder& operator=(const IncrementBuilder& other);

  /// Takes the next sample; `rests`: the depth says that the tool makes no way. Returns false and
  /// changes nothing where the sample begins before the last one ended (late, or sent twice), has
  /// no period or is not finite. A jump in time, number or session is a gap.
  /// Throws std::logic_error where more increments wait to be fetched than there is room for.
  bool Push(const ImuSample& sample, bool rests);

  /// How many samples from this one on the sums at hand still hold, each a period behind the one
  /// before: no increment can come of them.
  std::size_t Room(const SampleStamp& next) const;
  /// Takes samples, no more than there is Room() for; `rest`: at all of them the tool makes no way.
  /// As Push of each would, at less cost.
  void Append(const SampleBlock& samples, bool rest);

  /// Ends the knot at `fraction` in (0, 1] of the last pushed sample. Throws std::invalid_argument
  /// before the first sample, for a fraction outside (0, 1] or not behind the last cut.
  void Cut(double fraction = 1);
  /// Ends the knot in the gap before the last pushed sample, `into` it. Throws
  /// std::invalid_argument where there is none, beyond its end, or not behind the last cut.
  void CutGap(Duration into);

  /// No sample follows for now: all that waits comes out. A Push() may follow.
  void Flush();

  bool Ready() const;  ///< Pop() has an increment
  /// The next increment, in the order of the cuts. Throws std::logic_error where none is ready.
  Increment Pop();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace wellgyro
