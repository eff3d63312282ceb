#pragma once

#include <cstdint>

namespace wellgyro::support {

/// Calls the C interface `calls` times, in an order and with values drawn from `seed`: sessions are
/// opened, used after they are finished, and closed. Null pointers and impossible numbers are among
/// the values. Gives how many calls were refused.
std::int64_t CallAtRandom(std::uint64_t seed, std::int64_t calls);

}  // namespace wellgyro::support
