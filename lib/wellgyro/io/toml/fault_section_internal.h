#pragma once

#include "wellgyro/io/toml/toml_internal.h"
#include "wellgyro/simulate/fault.h"

namespace wellgyro {

/// A `[[fault]]` of a simulation: `cause`, its size under a key that has the unit, `axis` where the
/// cause has one, `begin_s`, `end_s`, `every_s` of what repeats.
SimulatedFault ReadFault(TomlTable table);

}  // namespace wellgyro
