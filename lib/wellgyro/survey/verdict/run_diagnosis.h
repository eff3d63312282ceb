#pragma once

#include <span>
#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/estimate/diagnosis.h"
#include "wellgyro/record/check.h"
#include "wellgyro/record/diagnosis.h"
#include "wellgyro/record/run_knot.h"
#include "wellgyro/survey/job.h"
#include "wellgyro/survey/survey.h"

namespace wellgyro {

/// Of runs without fault the share in which a fault is taken as found, at the most. Part of what
/// all checks of a run share, see kFalseAlarmRate.
inline constexpr double kDiagnosisFalseAlarms = 1e-3;

/// The faults that are looked for, in the order of their codes' table.
std::vector<CauseSpec> CausesLookedFor(const Site& site);

/// What the estimator's tests of CausesLookedFor() come to, in words and where it was.
RunDiagnosis DiagnosisOf(const Diagnosis& tests, std::span<const RunKnot> knots);

/// Root of the second moment of the depth scale's error, by what the accelerometers feel of the way
/// and the job's prior together: depth is not corrected, so that what is found of it counts. 0
/// where nothing tells it, and where it is named as the run's fault.
double DepthScaleFound(const Job& job, const RunDiagnosis& diagnosis);

/// The check `diagnosis`, naming the likeliest fault, or several that together have 95 %. It warns
/// where a fault is found, and fails where one of those named has moved the end of the run by more
/// than a sigma of its deepest station among `passes`: ends beyond their 95 % region are then more
/// than twice as many as stated. And `depth_scale_felt`: depth against the way that the
/// accelerometers feel, as other errors against their priors.
void CheckDiagnosis(const RunSummary& run, std::span<const Station> passes,
                    std::vector<Check>& checks);

/// The causes of a run with those that its samples alone tell, by `checks` that fail, in front: a
/// dead, stuck or swapped axis leaves nothing that the adjustment could judge. What is seen in the
/// samples and only warned of, as spikes that were replaced and motion at a stop, is in front where
/// nothing else is found or, of motion, where the likeliest cause begins at that stop; else it
/// stands last, without a share of the probability.
WELLGYRO_EXPORT std::vector<RunCause> CausesOf(const RunSummary& run,
                                               std::span<const Check> checks);

}  // namespace wellgyro
