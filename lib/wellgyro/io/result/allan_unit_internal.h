#pragma once

#include <string>
#include <string_view>

#include "wellgyro/noise/noise_model.h"

namespace wellgyro {

/// A unit of readings, and the one in which people read results.
struct AllanUnit {
  std::string word;
  double si = 1;  ///< of one
  bool accelerometer = false;
  bool plain = false;       ///< numbers without a unit
  std::string shown = {};   ///< of deviations, for people: "deg/h"
  std::string column = {};  ///< ending of a table's columns: "_deg_per_h"
  double shown_si = 1;      ///< of one shown
};

/// Throws std::invalid_argument for an unknown word.
AllanUnit UnitOf(std::string_view word, bool unitless);

/// How a term's coefficient is told: "angle random walk N", "deg/sqrt(h)", and one of it in SI.
struct TermText {
  std::string name;
  std::string letter;
  std::string unit;
  double unit_si = 1;
};
TermText TextOf(NoiseTerm term, const AllanUnit& unit);

/// "1.5 deg/h" with three significant digits of the value in shown units.
std::string Shown(double si, double unit_si, const std::string& unit);

/// "12.3 s", "4.56 h".
std::string DurationText(double seconds);

}  // namespace wellgyro
