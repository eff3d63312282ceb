#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "wellgyro/base/export.h"
#include "wellgyro/base/time.h"
#include "wellgyro/depth/depth_track.h"
#include "wellgyro/record/along_hole_block.h"

namespace wellgyro {

/// A depth track for samples at any rate: asked at whole tenths of a second of UTC, and between
/// them the quadratics of both ends, each by its nearness. What it says depends on the track and
/// the instant alone, not on how often or in which order it is asked.
///
/// Against the track itself, on a winch that swings by 0.3 m/s: 1 mm, 1 mm/s and 3 mm/s^2 at most
/// with marks at 10 Hz and more; at 2 and 1 Hz, where the track has kinks, 2 mm, 7 mm/s and
/// 7 mm/s^2, and 1 cm, 7 mm/s and 25 mm/s^2.
/// Where one end is unknown, or a depth event or a jump of the counter lies between, the track
/// itself is asked.
class WELLGYRO_EXPORT DepthGrid {
 public:
  static constexpr Duration kStep{100'000'000};

  /// `track` must outlive this object.
  explicit DepthGrid(const DepthTrack& track) : track_(&track) {}

  /// At(utc) is final where all marks and events up to `until` are in.
  bool Knows(UtcTime utc, UtcTime until) {
    const auto since = static_cast<std::uint64_t>(utc.ns) - static_cast<std::uint64_t>(final_ns_);
    return since < static_cast<std::uint64_t>(kStep.ns) || CellIsFinal(utc, until);
  }
  /// Must be final: what has been asked is kept.
  AlongHole At(UtcTime utc) {
    // Unsigned, so that no nonsense overflows.
    const auto since = static_cast<std::uint64_t>(utc.ns) - static_cast<std::uint64_t>(begin_ns_);
    if (since >= static_cast<std::uint64_t>(kStep.ns)) Enter(utc);
    return smooth_ ? Smooth(static_cast<double>(utc.ns - begin_ns_) * 1e-9) : Asked(utc);
  }
  /// What of the motion is asked for: all, or depth, speed and the speed's sigma.
  enum class Asks { kAll, kSpeed };
  /// At() each of `utc`, SampleBlock::kMost at most; what is not asked for may be left as it was.
  void At(std::span<const UtcTime> utc, Asks asks, AlongHoleBlock& along);

 private:
  struct Node {
    std::int64_t index = INT64_MIN;
    AlongHole along;
  };
  /// Coefficients of the blend, of powers of the seconds since the cell began, in no frame.
  struct Blend {
    std::array<double, 4> md{};
    std::array<double, 3> speed{};
    // Of acceleration and of the sigmas of depth, speed and acceleration.
    std::array<double, 4> begin{}, slope{};
    double md_low = 0, md_high = 0;  ///< the ends': a blend never turns back
  };

  bool CellIsFinal(UtcTime utc, UtcTime until);
  void Enter(UtcTime utc);
  AlongHole Asked(UtcTime utc) const;
  void Smooth(std::span<const UtcTime> utc, std::size_t begin, Asks asks,
              AlongHoleBlock& along) const;
  const AlongHole& NodeAt(std::int64_t index);
  static Blend BlendOf(const AlongHole& a, const AlongHole& b);
  AlongHole Smooth(double t) const {
    const Blend& c = blend_;
    const auto line = [&](std::size_t i) { return c.begin[i] + t * c.slope[i]; };
    const double md = c.md[0] + t * (c.md[1] + t * (c.md[2] + t * c.md[3]));
    const double speed = c.speed[0] + t * (c.speed[1] + t * c.speed[2]);
    return {.md = std::clamp(md, c.md_low, c.md_high),
            .speed = speed,
            .acceleration = line(0),
            .sigma_md = line(1),
            .known = true,
            .sigma_speed = line(2),
            .sigma_acceleration = line(3)};
  }

  const DepthTrack* track_;
  std::array<Node, 4> nodes_;            ///< the latest asked, by index modulo 4
  std::int64_t begin_ns_ = -kStep.ns;    ///< of the present cell, UTC
  std::int64_t final_ns_ = -kStep.ns;    ///< of the last cell found to be final
  bool known_ = false, smooth_ = false;  ///< anywhere in it; all over it
  Blend blend_;
};

}  // namespace wellgyro
