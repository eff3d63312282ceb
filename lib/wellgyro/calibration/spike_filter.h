#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/record/noise.h"
#include "wellgyro/record/sample.h"

namespace wellgyro {

/// Finds single impossible samples (spikes, bit errors) by their neighbours and replaces the axis
/// that has them, before anything sums them.
///
/// A value is impossible where it departs from the cubic through the four samples about it by more
/// than six sigmas of the stated noise (and 2 deg/h or 1e-3 m/s^2), and by ten times what its
/// neighbours depart from theirs without it. A roll is cubic enough (10 rpm at 10 Hz: 1e-4 g); in a
/// whirl or vibration neighbours depart as much, and the filter goes blind by itself. The cubic
/// takes its place. Bad samples beside each other are found by the median of the six about them,
/// beyond three times the spread of the middle four, and replaced by it. Of white noise one value
/// in 1e8 is touched.
///
/// Samples come out three later than they go in, in order and all of them. What does not continue
/// the samples before is no neighbour: Flush first. The three on either side of such a place are
/// left as they are. Nothing is allocated.
class WELLGYRO_EXPORT SpikeFilter {
 public:
  /// A sample that is done.
  struct Out {
    ImuSample sample;
    bool mark = false;                 ///< as it came with the sample
    bool gyro = false, accel = false;  ///< an axis was replaced
  };

  SpikeFilter(const NoiseCoefficients& gyro, const ErrorPriors& errors)
      : gyro_noise_(gyro.angle_random_walk), accel_noise_(errors.accel_noise) {}

  /// The sample is the next of the last that was pushed, and nothing has been flushed since.
  bool Continues(const SampleStamp& stamp) const;
  /// Takes a sample that continues, or the first; the one that is then done, or nullptr. `mark`
  /// goes with the sample. Valid until the next call.
  const Out* Push(const ImuSample& sample, bool mark);
  /// One that still waits, or nullptr where none is left.
  const Out* Flush();

 private:
  static constexpr std::size_t kWindow = 7, kMiddle = 3;
  static constexpr std::size_t kRing = 8;  // the least power of two that holds the window
  /// Rates x, y, z and forces x, y, z of a sample.
  using Values = Eigen::Array<double, 6, 1>;

  std::size_t Slot(std::size_t i) const { return (first_ + i) % kRing; }
  Out& At(std::size_t i) { return ring_[Slot(i)]; }
  const Out& At(std::size_t i) const { return ring_[Slot(i)]; }
  const Values& ValuesAt(std::size_t i) const { return values_[Slot(i)]; }
  void SetFloor(std::int32_t period_ns);
  Values Beyond(std::size_t i) const;
  void MendMiddle();
  bool MendAxis(Eigen::Index axis, double off);

  double gyro_noise_, accel_noise_;  // of a mean over 1 s [rad/s], [m/s^2]
  Values floor_ = Values::Zero();    // below which a departure is noise, at this period
  std::int32_t floor_period_ns_ = 0;
  std::array<Out, kRing> ring_;
  std::array<Values, kRing> values_;
  std::size_t first_ = 0, size_ = 0;
  std::size_t waiting_ = 0;  // at the end of the window, not yet done
};

}  // namespace wellgyro
