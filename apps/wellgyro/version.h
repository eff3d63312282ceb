#pragma once

namespace wellgyro::apps {

/// As --version says it, with the commit.
extern const char* const kVersionText;

}  // namespace wellgyro::apps
