#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "wellgyro/base/time.h"
#include "wellgyro/base/units.h"
#include "wellgyro/io/toml/toml_internal.h"
#include "wellgyro/record/sample.h"
#include "wellgyro/record/tool_calibration.h"

namespace wellgyro {

/// How a group of sensors stands in files: the name of its table and the unit its sensitivity is
/// per.
struct GroupWords {
  std::string_view table;
  std::string_view kind;        ///< the vector it senses, for comments
  std::string_view per;         ///< suffix of sensitivity keys
  std::string_view per_square;  ///< suffix of second_order
  double unit;                  ///< of `per` [SI]
};
inline constexpr GroupWords kGyroWords{"gyro", "angular rate, deg/h", "per_deg_per_h",
                                       "per_deg_per_h_squared", units::kDegPerHour};
inline constexpr GroupWords kAccelWords{"accel", "specific force, m/s2", "per_mps2",
                                        "per_mps2_squared", 1};
inline constexpr GroupWords kMagWords{"mag", "flux density, nT", "per_nt", "per_nt_squared",
                                      units::kNanotesla};

/// Endings of the keys of polynomials, power by power.
inline constexpr std::string_view kPowerWords[] = {"", "_tau", "_tau2", "_tau3"};

SensorGroup ReadGroup(TomlTable& table, const GroupWords& words);

std::string DateText(UtcTime time);

}  // namespace wellgyro
