#pragma once

#include <cstdint>

/// @file
/// Why a value is worth less than its sigma says.
namespace wellgyro {

// g++ takes the enumerator kEarthRate for a shadow of earth/'s constant, which it cannot be.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"
/// Why a value is worth less than its sigma says, as a set of bits that travels with the value to
/// the survey file. The bits are those of survey_station_t.quality.
enum class Quality : std::uint32_t {
  kGood = 0,
  kMoved = 1u << 0,        ///< the tool turned or travelled during a still window
  kMirror = 1u << 1,       ///< the gyrocompass has a second solution that the data do not exclude
  kVertical = 1u << 2,     ///< too near vertical for azimuth or toolface to mean much
  kSaturated = 1u << 3,    ///< a sensor reached its full scale
  kGap = 1u << 4,          ///< samples are missing
  kDepth = 1u << 5,        ///< depth missing, held or contradicted
  kTemperature = 1u << 6,  ///< outside the calibrated temperatures
  kAliased = 1u << 7,      ///< rotation too fast for the sampling on the way since the last station
  kGravity = 1u << 8,      ///< |f| differs from gravity beyond its limit
  kEarthRate = 1u << 9,    ///< the rate at rest differs from the Earth's beyond its limit
  kClock = 1u << 10,       ///< the tie between the tool's clock and UTC is doubtful
  kUnfit = 1u << 11,       ///< a cause that failed the run can have touched it: no sigma is given
};
#pragma GCC diagnostic pop

/// All bits of both.
constexpr Quality operator|(Quality a, Quality b) {
  return static_cast<Quality>(static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b));
}
/// The bits that both have.
constexpr Quality operator&(Quality a, Quality b) {
  return static_cast<Quality>(static_cast<std::uint32_t>(a) & static_cast<std::uint32_t>(b));
}
/// Adds the bits of `b` to `a`.
constexpr Quality& operator|=(Quality& a, Quality b) { return a = a | b; }
/// `set` less the bits of `bit`.
constexpr Quality Without(Quality set, Quality bit) {
  return static_cast<Quality>(static_cast<std::uint32_t>(set) & ~static_cast<std::uint32_t>(bit));
}
/// Whether `set` has any bit of `bit`.
constexpr bool Has(Quality set, Quality bit) { return (set & bit) != Quality::kGood; }

}  // namespace wellgyro
