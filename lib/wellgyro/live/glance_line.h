#pragma once

#include <string>

#include "wellgyro/base/export.h"
#include "wellgyro/record/glance.h"

namespace wellgyro {

/// One line for a screen: depth, speed, inclination, azimuth with its sigma, the rest and what it
/// still needs for a north, samples lost, checks. In degrees and metres, without a newline.
WELLGYRO_EXPORT std::string LineOf(const Glance& glance);

}  // namespace wellgyro
