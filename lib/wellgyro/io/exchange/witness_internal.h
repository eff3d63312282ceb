#pragma once

#include <string>

#include "wellgyro/io/exchange/claims_internal.h"
#include "wellgyro/record/survey_table.h"

namespace wellgyro {

/// Holds the positions and the dogleg severity of a survey against what its measured depth,
/// inclination and azimuth give, under each hypothesis of length unit, north, datum, axes and
/// method of calculation.
///
/// What the file left open is settled where one hypothesis fits, and said in the head's notes.
/// Throws TextError, kConflict, where none or two do or where what the file says is not what fits,
/// with the option that decides. A file in which nothing can be checked gets a note that says so.
/// Hypotheses are told apart by 0.4 % in length and by 4 sigma of the turn, 0.02 deg at least.
void Witness(SurveyTable& table, const Claims& claims, const std::string& source);

}  // namespace wellgyro
