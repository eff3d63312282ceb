#pragma once

#include <vector>

#include "wellgyro/base/export.h"

namespace wellgyro {

/// The middle of `values` by size, of an even number the upper one of the two; 0 of none. Orders by
/// <, so that a value that is no number gives an answer without meaning.
WELLGYRO_EXPORT double Median(std::vector<double> values);

}  // namespace wellgyro
