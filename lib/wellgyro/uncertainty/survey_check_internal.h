#pragma once

#include <cstddef>
#include <span>

#include "wellgyro/uncertainty/propagate.h"

namespace wellgyro {

/// Throw std::invalid_argument naming what is wrong and where.
void CheckSurvey(std::span<const SurveyPoint> survey);
void CheckSurroundings(const Surroundings& place);
void CheckLegs(std::span<const ToolLeg> legs, std::size_t stations, const Surroundings& place);

}  // namespace wellgyro
