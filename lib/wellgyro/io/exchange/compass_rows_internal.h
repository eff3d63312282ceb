#pragma once

#include <string>
#include <vector>

#include "wellgyro/uncertainty/error_model.h"

namespace wellgyro {

/// One row of a Compass error model: a component of an error source, or a value that formulas name.
/// Words are in lower case.
struct CompassRow {
  std::string name;     ///< of the source; rows of one name and tie-on make it together
  std::string vector;   ///< a b: azimuth, i j: inclination, e d: depth, l: lateral, m: misalignment
  std::string tie_on;   ///< r s w g: how its errors add up; n: a value that later formulas name
  std::string unit;     ///< of the value
  std::string formula;  ///< of the weight
  double value = 0;     ///< 1-sigma
  double min_deg = 0, max_deg = 0;  ///< of inclination; equal: everywhere
  double order = 0;                 ///< by which rows are sorted
  int line = 0;                     ///< 0: the file has no lines
};

/// The number in a cell; refuses what is none, naming `what` it was to be.
double NumberOrRefuse(const std::string& text, const std::string& what, const std::string& source,
                      int line);

/// Makes a source of each name and tie-on, with the values that its formulas name put in. Refuses,
/// by RefuseModel(), what is not known, naming the term.
void TermsOfRows(std::vector<CompassRow> rows, const std::string& source, ErrorModel& model);

}  // namespace wellgyro
