#pragma once

#include <optional>

namespace wellgyro {

/// A logging cable, as far as its length depends on pull and warmth, and its magnetic marks.
struct Cable {
  double stretch = 0;            ///< elastic, of its length for each newton [1/N]
  double weight = 0;             ///< in the well's fluid [N/m]
  double tool_weight = 0;        ///< in the well's fluid [N]
  double measuring_tension = 0;  ///< at which the counter, or who laid the marks, measured [N]
  double expansion = 0;          ///< thermal [1/K]
  double measuring_temperature = 15, surface_temperature = 15;  ///< [degC]
  double gradient = 0;               ///< of temperature along the hole [K/m]
  double ratio_sigma = 0.1;          ///< of the stretch, 1-sigma of what is not known of it [1]
  double mark_spacing = 0;           ///< between magnetic marks [m]; 0: there are none
  std::optional<double> first_mark;  ///< depth of one of them [m]; else the first that passes
  double sigma_mark = 0.05;          ///< of one mark's place [m]
};

}  // namespace wellgyro
