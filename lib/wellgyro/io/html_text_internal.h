#pragma once

#include <string>
#include <string_view>

namespace wellgyro {

/// Text as it may stand in HTML, in content and in quoted attributes. Signs that a page cannot hold
/// are shown as such (U+FFFD).
std::string Escaped(std::string_view text);

}  // namespace wellgyro
