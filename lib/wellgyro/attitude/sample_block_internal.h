#pragma once

#include <array>
#include <complex>
#include <cstdint>

#include "wellgyro/record/quality.h"
#include "wellgyro/record/sample_block.h"

namespace wellgyro::increment {

using Complex = std::complex<double>;

/// Channels whose moments a block keeps, in the order of SixAxes.
enum Channel { kWx, kWy, kWz, kFx, kFy, kFz, kChannels };

/// One channel's integral over a block, and those of it times time and time squared from the
/// block's middle, each sample standing at its own middle.
struct Moments {
  double zeroth = 0, first = 0, second = 0;
};

/// Some adjoining samples, in T; or a gap, which has none. Short enough for the roll inside it to
/// be a parabola, and bound to the samples alone, never to where knots are cut.
struct Block {
  std::int64_t begin_ns = 0;   ///< on the builder's own axis, on which sessions follow each other
  std::int64_t length_ns = 0;  ///< of all its samples, or of the gap
  double seconds = 0;          ///< length_ns
  double period = 0;           ///< of a sample [s]
  std::int64_t seq_begin = 0, seq_end = 0;
  std::int64_t lost = 0;  ///< samples missing before it
  int samples = 0;        ///< none: a gap
  bool breaks = false;    ///< what came before is not its neighbour
  bool anew = false;      ///< what came before was given away as the last
  bool accel_full_scale = false, gyro_full_scale = false;
  bool rests = false, has_gz = false;
  Quality quality = Quality::kGood;
  std::array<Moments, kChannels> sum{};
  double phase = 0;    ///< inertial roll by gravity, mean over the block, unwrapped [rad]
  double weight = 0;   ///< of it [1/rad^2]; zero: gravity says nothing
  double swept = 0;    ///< what the axis' own turning adds to it over the block [rad]
  bool linked = true;  ///< to the phase before it; else only its changes count from here on

  double roll = 0, rate = 0, bend = 0;  ///< psi, psi', psi'' at the middle [rad, rad/s, rad/s^2]
  double walk = 0;  ///< of the rate as psi was smoothed by; 0: not by gravity [rad/s/sqrt(s)]

  // Turned to U by e^{i psi}: integrals over the block, and first moments from its middle.
  Complex unit;              ///< of e^{i psi}
  Complex wx, wy;            ///< of the two gyros by themselves: the turn is wx + i wy
  Complex fx, fy;            ///< of the two accelerometers
  Complex w_first, f_first;  ///< of turn and force
  Complex carried;           ///< mean of the turn's rate over the last second [rad/s]

  double middle() const { return 0.5 * seconds; }
  std::int64_t end_ns() const { return begin_ns + length_ns; }
  Complex turn() const { return wx + Complex(0, 1) * wy; }
  Complex force() const { return fx + Complex(0, 1) * fy; }
};

/// `b` follows `a` and is like it, so that differences can be taken.
inline bool Adjoin(const Block& a, const Block& b) {
  return !b.breaks && a.samples > 0 && b.samples == a.samples && a.length_ns == b.length_ns;
}

/// Sums samples to a block.
class BlockSum {
 public:
  int samples() const { return samples_; }
  const SampleStamp& last() const { return last_; }
  void Add(const ImuSample& sample, bool rests);
  void Add(const SampleBlock& samples, bool rest);
  /// The block so far, which a new one then follows; where it begins is the caller's.
  void Close(Block& block);

 private:
  void Note(const ImuSample& like, const SampleStamp& last, bool rest);

  // Powers of a sample's number in the block; shifted to the middle at Close().
  std::array<SixAxes, 3> sum_{SixAxes::Zero(), SixAxes::Zero(), SixAxes::Zero()};
  int samples_ = 0;
  SampleStamp last_;
  std::int64_t seq_begin_ = 0;
  bool accel_full_scale_ = false, gyro_full_scale_ = false, has_gz_ = true, rests_ = true;
  Quality quality_ = Quality::kGood;
};

/// Turns the block's sums to U by its roll.
void TurnBlock(bool third, Block& block);

}  // namespace wellgyro::increment
