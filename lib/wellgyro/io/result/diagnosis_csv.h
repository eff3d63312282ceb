#pragma once

#include <string>

#include "wellgyro/base/export.h"
#include "wellgyro/survey/survey.h"

namespace wellgyro {

/// diagnosis.csv: RUN,CODE,BEGIN_UTC,BEGIN_MD[m],SIZE,SIGMA,UNIT,LN_BAYES,POSTERIOR,DN[m],DE[m],
/// DV[m],ALIKE,REMEDY. The causes of every run, the likeliest first; `none`: no fault, `other`:
/// none of these. SIZE and SIGMA are in UNIT; DN, DE, DV: the end of the run as given less where it
/// is, if this is the cause; ALIKE: codes joined by +. What is not known is empty.
WELLGYRO_EXPORT std::string DiagnosisCsv(const Survey& survey);

/// reliability.csv: RUN,CODE,SMALLEST,UNIT,AT_MD[m],DN[m],DE[m],DV[m]. Of every cause the smallest
/// that is noticed four times in five, beginning where it does most, and what it then does to the
/// end. SMALLEST empty: not even five times the usual size would be, and the shift is that of five
/// times.
WELLGYRO_EXPORT std::string ReliabilityCsv(const Survey& survey);

}  // namespace wellgyro
