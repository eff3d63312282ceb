#pragma once

#include <optional>
#include <span>

#include "wellgyro/base/export.h"
#include "wellgyro/record/check.h"
#include "wellgyro/record/diagnosis.h"
#include "wellgyro/record/station.h"
#include "wellgyro/survey/job.h"

namespace wellgyro {

/// A wheel that slips on the way, fast or slowly: from some depth on marks are off by a length that
/// no accelerometer feels. A run that comes back through the same hole shows it where the hole
/// bends: inclinations at one depth, out less in, are off by the length times dI/ds above that
/// depth, and not below it, whether it slipped there on the way in or out.
///
/// Differences d = s g [md < t] + o g + c + e, g = dI/ds, with the offset o of the passes' depths
/// as the job's depth_sigma allows it, twice, a common error c of the inclinations as large as one
/// of e, and in e what a station's own depth is unsure by: its variance less those of depth_sigma
/// and of `sigma_scale`, times g^2. Size and onset are integrated out as in Diagnose(); `begin_md`
/// is t at its likeliest, a slow slip's middle, `size` [m] is positive where marks came out too
/// small. `shift_W`: of a slip on the way in; one on the way out moves no station of it. Without
/// two passes, or in a hole that does not bend, nothing tells it: `ln_bayes` is absent.
///
/// `reliability`: the smallest that would be noticed four times in five at half of the depths. In a
/// straight part above all bends none is, see RunSlip::unseen_W.
WELLGYRO_EXPORT RunSlip FindSlip(const Job& job, double sigma_scale,
                                 std::span<const Station> passes, std::int32_t run);

/// The check `depth_slip`: fails where a slip is noticed.
Check CheckSlip(const RunSlip& slip, std::int32_t run);

}  // namespace wellgyro
