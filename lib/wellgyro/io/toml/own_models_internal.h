#pragma once

#include <span>
#include <string_view>

namespace wellgyro {

/// A file of data/models, whole. The sources are written by CMake when the library is built.
struct OwnModelText {
  std::string_view file, text;
};
std::span<const OwnModelText> OwnModelTexts();

}  // namespace wellgyro
