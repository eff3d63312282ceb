#pragma once

#include <string>

#include "wellgyro/base/export.h"
#include "wellgyro/survey/survey.h"

namespace wellgyro {

/// stretches.csv: RUN,END_UTC,T[s],MD[m],SPEED[m/s],ROTATION[rpm],TEMPERATURE[degC],SAMPLES_LOST,
/// RES_GYRO,RES_ACCEL. Every run in stretches of some twenty seconds, see RunStretch; T is their
/// end since the begin of the first. What is not known is empty.
WELLGYRO_EXPORT std::string StretchesCsv(const Survey& survey);

}  // namespace wellgyro
