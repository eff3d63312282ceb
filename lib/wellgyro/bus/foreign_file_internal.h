#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace wellgyro {

/// What a file that is no LCM log is instead, by its first bytes, as the rest of a sentence: "is
/// compressed with gzip; unpack it first", "is text that begins with ...".
std::string ForeignFileText(std::span<const std::byte> beginning);

}  // namespace wellgyro
