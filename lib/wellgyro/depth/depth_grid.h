#pragma once

#include <array>
#include <cstdint>

#include "wellgyro/base/export.h"
#include "wellgyro/base/time.h"
#include "wellgyro/depth/depth_track.h"

namespace wellgyro {

/// A depth track for samples at any rate: asked at whole tenths of a second of UTC, and between
/// them the quadratics of both ends, each by its nearness. What it says depends on the track and
/// the instant alone, not on how often or in which order it is asked.
///
/// Against the track itself, on a winch that swings by 0.3 m/s: 1 mm, 1 mm/s and 3 mm/s^2 at most
/// with marks at 2 Hz and more; 1 cm, 5 mm/s and 25 mm/s^2 at 1 Hz, where the track has kinks.
/// Where one end is unknown, or a depth event or a jump of the counter lies between, the track
/// itself is asked.
class WELLGYRO_EXPORT DepthGrid {
 public:
  static constexpr Duration kStep{100'000'000};

  /// `track` must outlive this object.
  explicit DepthGrid(const DepthTrack& track) : track_(&track) {}

  /// The track must be final (Covers) up to kStep after `utc`: nodes are kept.
  AlongHole At(UtcTime utc);

 private:
  struct Node {
    std::int64_t index = INT64_MIN;
    AlongHole along;
  };
  const AlongHole& NodeAt(std::int64_t index);

  const DepthTrack* track_;
  std::array<Node, 4> nodes_;      ///< the latest asked, by index modulo 4
  std::int64_t cell_ = INT64_MIN;  ///< whose ends are a_ and b_
  bool smooth_ = false;            ///< between them
  AlongHole a_, b_;
};

}  // namespace wellgyro
