#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "wellgyro/depth/depth_motion.h"
#include "wellgyro/record/check.h"

namespace wellgyro {

/// What depth marks and the motion that accelerometers feel say of each other.
struct DepthAgainstMotion {
  DepthMotion::Found found;
  std::optional<double> lean;  ///< f_z of the first rest over gravity, where known
  double sigma_utc = 0;        ///< of the tie of the samples' clock to the depth's [s]
};

/// Depth marks against the motion along the hole that the accelerometers feel:
/// - `depth_unit` [1]: starts and stops of the marks over those felt; fails where they are those of
///   feet and metres. Where they are -1, `depth_reversed`, or `tool_upside_down` where the tool
///   points up too.
/// - `depth_jump` [m]: a step that no cable makes; `depth_lag` [s]: one that any speed makes an
///   error of depth, var = var of the starts and stops + var of the tie of the two clocks. Of marks
///   in another unit neither has a meaning, and nothing of all where `checks` say that axes or
///   accelerometers are wrong.
void AddDepthChecks(const DepthAgainstMotion& felt, std::int32_t run, std::vector<Check>& checks);

}  // namespace wellgyro
