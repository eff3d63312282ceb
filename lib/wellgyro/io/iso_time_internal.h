#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace wellgyro {

/// Seconds since 1970 UTC of an ISO 8601 instant with its zone, as 2026-01-15T06:12:00.5+01:00.
std::optional<double> UtcOf(std::string_view text);
/// The instant to the millisecond, or the microsecond where it has one: 2026-01-15T06:12:00.500Z.
std::string IsoUtc(double seconds);

}  // namespace wellgyro
