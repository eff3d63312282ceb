#pragma once

#include <stdexcept>
#include <string>

namespace wellgyro {

/// What the caller's simulation must be.
inline void Require(bool holds, const std::string& what) {
  if (!holds) throw std::invalid_argument(what);
}

}  // namespace wellgyro
