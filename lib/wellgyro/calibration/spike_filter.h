#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/record/noise.h"
#include "wellgyro/record/sample_block.h"

namespace wellgyro {

/// Finds single impossible samples (spikes, bit errors) by their neighbours and replaces the axis
/// that has them, before anything sums them.
///
/// A value is impossible where it departs from the cubic through the four samples about it by more
/// than six sigmas of the stated noise, all that a gyro that counts pulses of the stated
/// quantization makes of any rate (and 2 deg/h or 1e-3 m/s^2), and by ten times what its
/// neighbours depart from theirs without it. A roll is cubic enough (10 rpm at 10 Hz: 1e-4 g); in a
/// whirl or vibration neighbours depart as much, and the filter goes blind by itself. The cubic
/// takes its place. Bad samples beside each other are found by the median of the six about them,
/// beyond three times the spread of the middle four, and replaced by it. Of white noise one value
/// in 1e8 is touched.
///
/// Axes come out three samples later than they go in, in order and all of them; the samples stay
/// with the caller. What does not continue the samples before is no neighbour: Flush first. The
/// three on either side of such a place are left as they are. How samples come in blocks does not
/// matter. Nothing is allocated.
class WELLGYRO_EXPORT SpikeFilter {
 public:
  static constexpr std::size_t kMost = SampleBlock::kMost;

  struct Mended {
    bool gyro = false, accel = false;  ///< an axis was replaced
    bool any() const { return gyro || accel; }
  };
  /// Of the samples that are done, in order. Valid until the next call.
  struct Done {
    std::span<const SixAxes> axes;
    std::span<const Mended> mended;
    std::size_t taken = 0;  ///< of those that were pushed
  };

  SpikeFilter(const NoiseCoefficients& gyro, const ErrorPriors& errors)
      : gyro_noise_(gyro.angle_random_walk),
        gyro_quantization_(gyro.quantization),
        accel_noise_(errors.accel_noise) {}

  /// The sample is the next of the last that was pushed, and nothing has been flushed since.
  bool Continues(const SampleStamp& stamp) const;
  /// Takes the sample at the begin of `samples`, which continues or is the first, with those that
  /// continue it, kMost at most; those that are then done.
  Done Push(std::span<const ImuSample> samples);
  /// Those that still wait.
  Done Flush();

 private:
  static constexpr std::size_t kMiddle = 3;  // of the window of seven

  SixAxes Beyond(std::size_t i) const;
  void SetFloor(std::int32_t period_ns);
  void Drop();
  bool AnyDeparts(std::size_t begin, std::size_t end) const;
  void Mend(std::size_t i);
  bool MendAxis(std::size_t i, Eigen::Index axis, double off);
  Done DoneUpTo(std::size_t end);

  double gyro_noise_;         // of a mean over 1 s [rad/s]
  double gyro_quantization_;  // step / sqrt(12) [rad]
  double accel_noise_;        // of a mean over 1 s [m/s^2]
  std::array<SixAxes, kMost>
      floors_;  // below which a departure is noise, at this period: all alike
  std::int32_t floor_period_ns_ = 0;
  // The three that were done last, those that wait, and those that are new.
  std::array<SixAxes, 2 * kMiddle + kMost> axes_;
  std::array<Mended, 2 * kMiddle + kMost> mended_;
  std::array<bool, 2 * kMiddle + kMost> has_gz_;
  std::size_t size_ = 0, done_ = 0;
  SampleStamp last_;  // pushed
};

}  // namespace wellgyro
