#pragma once

#include <string>
#include <vector>

#include "wellgyro/record/station.h"
#include "wellgyro/survey/job.h"

namespace wellgyro {

/// Puts the position covariance of the job's error model, where it has one, in place of the run's
/// own. Gives a sentence where the model cannot serve these stations; then they are left alone.
std::string TakeModelCovariance(const Job& job, std::vector<Station>& chosen);

}  // namespace wellgyro
