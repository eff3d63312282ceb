#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/noise/allan_variance.h"

namespace wellgyro {

/// Allan variance at octaves of a stream of any length, for live use: about half a MiB, whatever
/// the length.
///
/// Averaging factors up to 16 take every difference, as AllanVariance does, and give the same to
/// rounding. Above, where a full overlap would have to remember 2 m samples, differences begin
/// every m/16 samples. Of the degrees of freedom of full overlap that keeps 0.996 for white noise
/// and more for flicker and random walk; only for quantisation noise, long invisible at such times,
/// it keeps 16/m. The result does not depend on how the stream is cut into batches, bit for bit.
class WELLGYRO_EXPORT AllanStream {
 public:
  static constexpr std::int64_t kOverlap = 16;  ///< differences begun in a cluster's time

  /// Throws std::invalid_argument when the period between samples [s] is not positive.
  explicit AllanStream(double period);

  /// Successive mean rates. One that is not finite is missing; its place is kept.
  void Push(std::span<const double> rates);
  /// That many samples are missing here. No difference is taken across them.
  void Skip(std::int64_t samples);

  std::int64_t samples() const { return samples_; }  ///< so far, missing ones included

  /// Memory it holds beside itself.
  std::size_t state_bytes() const { return levels_.capacity() * sizeof(Level); }

  /// The variances so far. `terms` counts the differences of full overlap that the ones taken
  /// stand for, so that intervals and fits take it as it is. Octaves without one are left out.
  AllanResult Result() const;

 private:
  /// Samples that an octave takes at once, 8 KiB: 62 octaves of them are the half MiB.
  static constexpr std::int64_t kBlock = 1024;
  static constexpr std::int64_t kHistory = 2 * kOverlap;  // what a difference spans, 2 m
  static constexpr int kOctavesBelow = 5;                 // 1 to 16

  // One octave of sampling; its samples are sums of two of the one below.
  struct Level {
    std::array<double, kBlock> rates;
    std::int64_t pending = 0;                // in `rates`
    std::int64_t processed = 0;              // since the last gap
    std::array<double, kHistory> history{};  // phases before the next one, which is 0
    std::array<double, kOctavesBelow> squares{};
    std::array<std::int64_t, kOctavesBelow> taken{};
    std::array<std::int64_t, kOctavesBelow> stands_for{};
  };

  void AppendOrSkip(std::span<const double> rate);
  void Append(std::span<const double> rates);
  void Process(std::size_t level);
  void TakeDifferences(std::size_t level, const double* phases, std::int64_t count);
  void EndSegment();

  double period_;
  double shift_ = 0;
  bool begun_ = false;
  std::int64_t samples_ = 0;
  std::int64_t missing_ = 0;
  std::int64_t segment_ = 0;  // samples since the last gap
  std::vector<SampleGap> not_finite_;
  std::vector<Level> levels_;
};

}  // namespace wellgyro
