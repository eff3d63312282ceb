#pragma once

#include <array>
#include <cstddef>
#include <string_view>

/// The words of a job file's choices, each list in the order of its enumerators, or false and true:
/// the files are read and written, and their reference is written, by these lists.
namespace wellgyro::words {

template <std::size_t size>
using Words = std::array<std::string_view, size>;

inline constexpr Words<3> kProjection{"transverse_mercator", "lambert_conformal_conic",
                                      "polar_stereographic"};
inline constexpr Words<2> kPole{"south", "north"};
inline constexpr Words<2> kAlignment{"gyrocompass", "external"};
inline constexpr Words<2> kAzimuthOf{"axis", "mark"};
inline constexpr Words<2> kOrder{"second", "third"};
inline constexpr Words<5> kDepthKind{"indicated", "wireline", "drill_pipe", "tubing", "other"};
inline constexpr Words<2> kRunVerdict{"ok", "misrun"};
/// There is no event of number 0.
inline constexpr Words<11> kEvent{
    "",          "depth_zero", "depth_rezero", "depth_tie", "return_to_zero", "foresight",
    "run_begin", "run_end",    "accept",       "reject",    "remark"};

}  // namespace wellgyro::words
