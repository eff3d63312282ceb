#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "wellgyro/math/variance_components.h"
#include "wellgyro/survey/wells/empirical_model.h"

namespace wellgyro {

/// What one hole's surveys tell of a model: contrasts of their directions at common depths. The
/// component of a term is its index; that of what no term speaks of comes after the last.
struct RepeatContrasts {
  VarianceCluster cluster;  ///< no rows: no two surveys have a depth in common
  std::size_t places = 0;
  std::vector<std::string> notes;
};

/// Magnitudes are in units of `model`'s, what is local in `local_sigma`; terms that `known` marks
/// have their magnitude by assumption.
RepeatContrasts ContrastsOf(const RepeatedHole& hole, const ErrorModel& model,
                            const std::vector<bool>& known, double local_sigma);

}  // namespace wellgyro
