#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "wellgyro/base/export.h"

namespace wellgyro {

/// Whether one of the two may be a slip for the other: insertions, deletions and replacements of
/// single characters (Levenshtein's distance) are at most one and a fifth of the length.
WELLGYRO_EXPORT bool Alike(std::string_view a, std::string_view b);

/// The one of `known` that is meant by `word`: alike, and nearest; empty where there is none.
WELLGYRO_EXPORT std::string Nearest(std::string_view word, const std::vector<std::string>& known);

}  // namespace wellgyro
