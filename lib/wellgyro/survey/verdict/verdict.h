#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/record/check.h"
#include "wellgyro/record/station.h"
#include "wellgyro/survey/survey.h"

namespace wellgyro {

/// Of runs without fault, the share of which chance alone fails some check; ten times as many warn.
inline constexpr double kFalseAlarmRate = 0.01;

/// Gives the checks whose limit is one of chance (Check::looks > 0) a limit and a verdict such that
/// all of one run together fail with kFalseAlarmRate: each kind, by its code, has the same share of
/// that rate, and within it each of its `looks` comparisons (Bonferroni; where comparisons depend
/// on each other the rate is lower). Checks of no run (0) are a family of their own. value / sigma
/// is taken as standard normal, or value freedom as chi-square. Squares of so many rows that chance
/// keeps them within what is known of noise fail beyond that, and have no share.
WELLGYRO_EXPORT void ShareFalseAlarms(std::vector<Check>& checks);

/// The worst of the checks of `run`, and of those of no run; not_done counts as pass.
WELLGYRO_EXPORT RunVerdict VerdictOfRun(std::span<const Check> checks, std::int32_t run);

/// All that can be said of where a station lies whose run failed: its direction is any, and it is
/// as far from `tie_in` as the hole between them is long, which is its sigma along each axis. So
/// whoever reads its covariance without its quality is not misled.
WELLGYRO_EXPORT void MakeUnfit(const Station& tie_in, Station& station);

/// Judges the runs of `survey` by its checks, and the survey by the runs that its chosen stations
/// are from. Every station of a run that fails is made unfit: what failed has touched all that was
/// adjusted with it.
WELLGYRO_EXPORT void GiveVerdict(Survey& survey);

/// What `check` found, in words: "gyros at rest do not read the Earth's rate (earth_rate, MD 900 m:
/// 2.1 deg/h, limit 1.4)".
WELLGYRO_EXPORT std::string CauseOf(const Check& check);

/// In words: so many digits, and all before the point where these are more, below 1e9.
WELLGYRO_EXPORT std::string ShortNumber(double value, int digits);

}  // namespace wellgyro
