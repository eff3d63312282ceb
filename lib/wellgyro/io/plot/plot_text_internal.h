#pragma once

#include <string>
#include <string_view>

namespace wellgyro {

/// Text as it may stand in SVG and HTML.
std::string SvgText(std::string_view text);

/// The next of 1, 2, 5, 10, ... not below `x`, which is above 0.
double RoundTick(double x);

}  // namespace wellgyro
