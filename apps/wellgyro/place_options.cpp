#include "place_options.h"

#include "wellgyro/base/units.h"

namespace wellgyro::apps {

void AddPlace(CLI::App& command, Surroundings& place, std::optional<double>& convergence) {
  AddNumber(command, "--latitude-deg", place.latitude, units::kDeg, "of the well")
      ->check(CLI::Range(-90.0, 90.0));
  AddNumber(command, "--convergence-deg", convergence, units::kDeg,
            "the azimuths are grid; true = grid + this; results are in the grid's frame")
      ->check(CLI::Range(-180.0, 180.0));
  AddNumber(command, "--gravity-mps2", place.gravity, 1, "default 9.80665");
  AddNumber(command, "--field-nt", place.field, units::kNanotesla,
            "total field, for magnetic terms");
  AddNumber(command, "--dip-deg", place.dip, units::kDeg, "of the field");
  AddNumber(command, "--declination-deg", place.declination, units::kDeg, "of the field");
}

}  // namespace wellgyro::apps
