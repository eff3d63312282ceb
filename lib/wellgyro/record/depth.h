#pragma once

#include <cstdint>
#include <optional>

#include "wellgyro/base/time.h"

/// @file
/// What the depth system says, and what it is.
namespace wellgyro {

/// What measured a depth. A measured depth without its kind is half a number: wireline and
/// driller's depths of one bed differ by metres.
enum class DepthKind : std::int32_t {
  kIndicated = 0,
  kWireline = 1,
  kDrillPipe = 2,
  kTubing = 3,
  kOther = 4,
};

/// One reading of the depth system: along-hole depth of the tool string's reference point.
struct DepthMark {
  UtcTime utc;
  std::int64_t seq = 0;
  std::int32_t session = 0;
  std::int32_t run = 0;
  DepthKind kind = DepthKind::kIndicated;
  double md = 0;                  ///< [m], positive down
  std::optional<double> speed;    ///< [m/s], positive down
  std::optional<double> tension;  ///< [N]
  std::optional<double> sigma;    ///< [m]
  bool stopped = false;
  bool corrected = false;      ///< corrections are already in `md`
  bool manual = false;         ///< typed by a person
  bool magnetic_mark = false;  ///< a magnetic mark passed the counter
};

/// Marks of a string at rest lie within it: two counts of an encoder of 1 cm [m].
inline constexpr double kRestsWithin = 0.02;

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
