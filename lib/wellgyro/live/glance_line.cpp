#include "wellgyro/live/glance_line.h"

#include <algorithm>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"

namespace wellgyro {

std::string LineOf(const Glance& glance) {
  std::string line = "MD ";
  line += glance.md ? fmt::format("{:.1f} m {:+.2f} m/s", *glance.md, glance.speed.value_or(0))
                    : std::string("not known");
  if (glance.inclination && glance.azimuth) {
    line += fmt::format("  inc {:.2f}  azi {:.2f} +- {:.2f} deg", ToDegrees(*glance.inclination),
                        ToDegrees(*glance.azimuth), ToDegrees(glance.sigma_azimuth));
  } else {
    line += "  no north yet";
  }
  if (glance.still) {
    const double more = glance.still_needed - *glance.still;
    line += fmt::format("  rests {:.0f} s", *glance.still);
    if (more > 0) line += fmt::format(", {:.0f} s more for a north", more);
  }
  line += fmt::format("  {} stations, {} samples lost", glance.stations, glance.samples_lost);
  if (glance.checks_warned + glance.checks_failed > 0) {
    line += fmt::format("  checks: {} warn, {} fail", glance.checks_warned, glance.checks_failed);
  }
  if (!glance.turned.empty()) line += fmt::format(" (last: {})", glance.turned);
  return line;
}

}  // namespace wellgyro
