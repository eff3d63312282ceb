#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "wellgyro/depth/depth_motion.h"
#include "wellgyro/record/check.h"

namespace wellgyro {

/// Depth marks against the motion along the hole that the accelerometers feel:
/// - `depth_unit` [1]: starts and stops of the marks over those felt; fails where they are those of
///   feet and metres. Where they are -1, `depth_reversed`, or `tool_upside_down` where the tool
///   points up too.
/// - `depth_jump` [m]: a step that no cable makes; `depth_lag` [s]: one that any speed makes an
///   error of depth. Of marks in another unit neither has a meaning, and nothing of all where
///   `checks` say that axes or accelerometers are wrong.
///
/// `lean`: f_z of the first rest over gravity, where known.
void AddDepthChecks(const DepthMotion::Found& found, std::optional<double> lean, std::int32_t run,
                    std::vector<Check>& checks);

}  // namespace wellgyro
