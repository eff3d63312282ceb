#pragma once

#include <memory>

#include "wellgyro/base/export.h"

namespace wellgyro {

class RunAdjuster;

/// The least-squares adjustment of a run as a whole, for a Surveyor or SurveyLog: with it the last
/// revision of every station rests on all that the run measured, before it and after. Stateless;
/// one may serve any number of surveyors, in any thread.
WELLGYRO_EXPORT std::shared_ptr<const RunAdjuster> MakeAdjuster();

}  // namespace wellgyro
