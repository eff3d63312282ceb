#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace wellgyro::apps {

/// Why PrintByChromium cannot print to `pdf`, as far as that shows before there is a page.
std::optional<std::string> CannotPrint(const std::filesystem::path& pdf);

/// Prints the page in the file `html` as `pdf`, by a headless Chromium from PATH with a profile of
/// its own. The complaint, where there is no Chromium or it did not do it within a minute.
std::optional<std::string> PrintByChromium(const std::filesystem::path& html,
                                           const std::filesystem::path& pdf);

}  // namespace wellgyro::apps
