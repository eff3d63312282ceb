#pragma once

#include <cstddef>
#include <span>

#include <Eigen/Core>

#include "wellgyro/record/sample.h"

namespace wellgyro {

/// A cache line of x86-64 and of most ARM [bytes], by which samples are fetched ahead.
inline constexpr std::size_t kCacheLine = 64;

/// Rates x, y, z [rad/s] and specific forces x, y, z [m/s^2] of a sample, in T.
using SixAxes = Eigen::Array<double, 6, 1>;

/// Written out, so that a compiler loads two at a time.
inline SixAxes AxesOf(const ImuSample& s) {
  return SixAxes{{s.w_IT_T[0], s.w_IT_T[1], s.w_IT_T[2], s.f_T[0], s.f_T[1], s.f_T[2]}};
}

/// `b` comes right behind `a`: of the same source, by number, and on the tool's clock to the
/// nanosecond.
inline bool IsNext(const SampleStamp& a, const SampleStamp& b) {
  return b.seq - a.seq == 1 && (b.tool_time - a.tool_time).ns == a.period_ns &&
         b.session == a.session && b.tool == a.tool && b.period_ns == a.period_ns;
}

/// Samples right behind each other, so that what holds for one need not be asked for each: by
/// number, and on both clocks each begins where the one before ends. But for number and times
/// their stamps are the same, and so are has_gz and has_mag. A view; what it shows is another's.
struct SampleBlock {
  /// A batch of a hundred is one block; by 64, two, a log of 10 kHz takes 5 % longer.
  static constexpr std::size_t kMost = 128;

  std::span<const ImuSample> samples;
  std::span<const SixAxes> axes;  ///< of each of them

  std::size_t size() const { return samples.size(); }
  bool empty() const { return samples.empty(); }
  const SampleStamp& first() const { return samples.front().stamp; }
  const SampleStamp& last() const { return samples.back().stamp; }
  SampleBlock Part(std::size_t begin, std::size_t count) const {
    return {samples.subspan(begin, count), axes.subspan(begin, count)};
  }
};

/// `b` can stand right behind `a` in a block.
inline bool IsEven(const ImuSample& a, const ImuSample& b) {
  const SampleStamp& s = a.stamp;
  const SampleStamp& t = b.stamp;
  const bool next = t.seq == s.seq + 1 && (t.tool_time - s.tool_time).ns == s.period_ns &&
                    (t.utc - s.utc).ns == s.period_ns;
  const bool source =
      t.session == s.session && t.run == s.run && t.tool == s.tool && t.period_ns == s.period_ns;
  const bool flags = t.gyro_saturated == s.gyro_saturated &&
                     t.accel_saturated == s.accel_saturated && t.utc_unsynced == s.utc_unsynced &&
                     t.simulated == s.simulated && t.temperature_outside == s.temperature_outside;
  return next && source && flags && t.temperature == s.temperature && a.has_gz == b.has_gz &&
         a.has_mag == b.has_mag;
}

}  // namespace wellgyro
