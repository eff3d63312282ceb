#pragma once

#include <optional>
#include <span>

#include "wellgyro/base/export.h"
#include "wellgyro/record/sample.h"

namespace wellgyro {

/// Azimuth of the tool's axis at rest, clockwise from magnetic north as the tool's magnetometers
/// see it, in [0, 2 pi): the field's and the axis' directions in the plane that the accelerometers
/// call level. Of several windows the mean direction. Absent where no window has magnetometers, the
/// field or the axis is vertical, or there is no force.
WELLGYRO_EXPORT std::optional<double> MagneticAzimuth(std::span<const StillWindow> windows);

}  // namespace wellgyro
