#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace wellgyro {

/// Names between blanks, which may have blanks of their own: "MD (m)", "X Offset(m)". They are cut
/// in the way that gives `width` of them, as many as the rows have numbers; nothing where no way
/// does, or where tabs part the line. Without a width, every word is a name.
std::optional<std::vector<std::string>> SpacedNames(std::string_view line,
                                                    std::optional<std::size_t> width);

}  // namespace wellgyro
