#pragma once

#include <span>
#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/survey/wells/separation.h"

namespace wellgyro {

/// One offset well on a plot.
struct ClearanceSeries {
  std::string name;
  const std::vector<Separation>* rows = nullptr;  ///< not empty
};

/// The ladder plot: distance of each offset, and the distance allowed, against the reference's MD;
/// beside it the separation factor, with `stop` and `alert` as lines. An SVG picture.
WELLGYRO_EXPORT std::string LadderSvg(const std::string& reference,
                                      std::span<const ClearanceSeries> series, double stop,
                                      double alert);

/// The travelling cylinder: each offset as it is seen down the reference well, its distance against
/// its direction, which is its toolface plus the azimuth of the high side: north is up, in a hole
/// of any inclination without a jump. An SVG picture.
WELLGYRO_EXPORT std::string TravellingCylinderSvg(const std::string& reference,
                                                  std::span<const ClearanceSeries> series);

}  // namespace wellgyro
