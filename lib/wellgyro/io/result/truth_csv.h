#pragma once

#include <string>

#include "wellgyro/base/export.h"
#include "wellgyro/simulate/truth.h"

namespace wellgyro {

/// The truth of a simulated run every `step` seconds and at its end:
/// T[s],MD[m],INC[deg],AZI_TRUE[deg],GTF[deg],TVD[m],N[m],E[m]. MD and position are the sensor
/// point's, T counts from the begin of the run.
WELLGYRO_EXPORT std::string TruthCsv(const Truth& truth, double step);

}  // namespace wellgyro
