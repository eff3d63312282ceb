#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "wellgyro/uncertainty/propagate.h"

namespace wellgyro::apps {

/// An option whose number, in a unit of the trade, is held in SI.
template <class T>
CLI::Option* AddNumber(CLI::App& command, const std::string& name, T& held, double unit,
                       const std::string& help) {
  return command.add_option_function<double>(
      name, [&held, unit](const double& value) { held = value * unit; }, help);
}

/// --latitude-deg, --convergence-deg, --gravity-mps2, --field-nt, --dip-deg, --declination-deg.
void AddPlace(CLI::App& command, Surroundings& place, std::optional<double>& convergence);

}  // namespace wellgyro::apps
