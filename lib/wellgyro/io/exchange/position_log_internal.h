#pragma once

#include <optional>
#include <string>

#include "wellgyro/record/survey_table.h"

namespace wellgyro {

/// Gives the stations of a position log (MD and positions, without angles) the directions of the
/// chords that end there, with status back-calculated, and says so in the notes; the first station
/// gets that of the chord that begins there. Directions count from the grid's north where the
/// positions are map coordinates, else from that of the offsets.
///
/// Gives what is wrong where chords are longer than the measured depth between their ends, by more
/// than 0.2 %, or less than half as long: lengths in different units, or another column.
std::optional<std::string> BackCalculate(SurveyTable& table);

}  // namespace wellgyro
