#include "wellgyro/plan/plan_case.h"

#include <cmath>
#include <stdexcept>
#include <string_view>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"

namespace wellgyro {
namespace {

namespace range = plan_range;

// [m] that there is something to plan: one knot of kAdviceKnots at 0.8 m/s is 9.6 m.
constexpr double kLeastWay = 10;
constexpr double kSlack = 1e-6;  // [m], rounding of files

void Need(bool holds, std::string_view name, double value, std::string_view what) {
  if (holds) return;
  throw std::invalid_argument(fmt::format("{} {}, is {:g}", name, what, value));
}

void CheckWay(const PlanCase& c) {
  const PlannedWay& way = c.way;
  const double begin = c.well.md_begin(), end = c.well.md_end();
  const auto within = fmt::format("must lie in the well, {:g} to {:g} m", begin, end);
  Need(way.begin_md >= begin - kSlack && way.begin_md <= end, "begin_md", way.begin_md, within);
  Need(way.end_md >= begin && way.end_md <= end + kSlack, "end_md", way.end_md, within);
  Need(way.end_md - way.begin_md >= kLeastWay, "end_md", way.end_md,
       fmt::format("must be {:g} m below begin_md, {:g} m, at least", kLeastWay, way.begin_md));
  Need(way.end_md - way.begin_md <= range::kWayMost, "end_md", way.end_md,
       fmt::format("must be {:g} m below begin_md at most", range::kWayMost));
  const auto surveyed = [](double v) { return v >= range::kSlowest && v <= range::kFastest; };
  const auto speeds = fmt::format("must be {:g} to {:g} m/s", range::kSlowest, range::kFastest);
  Need(surveyed(way.speed_in), "speed_in", way.speed_in, speeds);
  Need(way.speed_out == 0 || surveyed(way.speed_out), "speed_out", way.speed_out,
       speeds + ", or 0");
  Need(std::abs(way.roll_rate) <= range::kRollMostRpm * (kTwoPi / 60), "roll_rate", way.roll_rate,
       fmt::format("must be {:g} rpm at most [rad/s]", range::kRollMostRpm));
  Need(std::abs(way.swing) <= FromDegrees(range::kSwingMostDeg), "swing", way.swing,
       "must be one turn at most [rad]");
  Need(way.swing_period >= range::kSwingPeriodLeast, "swing_period", way.swing_period,
       fmt::format("must be {:g} s at least", range::kSwingPeriodLeast));
  Need(std::isfinite(way.toolface), "toolface", way.toolface, "must be finite");
}

}  // namespace

std::vector<PlannedStop> Practice(const PlannedWay& way, double spacing, double seconds) {
  Need(spacing > 0, "spacing", spacing, "must be positive");
  Need(seconds > 0, "seconds", seconds, "must be positive");
  std::vector<PlannedStop> stops;
  for (int i = 0; way.begin_md + i * spacing < way.end_md - 0.5 * spacing; ++i) {
    stops.push_back({false, way.begin_md + i * spacing, seconds, {}});
  }
  stops.push_back({false, way.end_md, seconds, {}});
  return stops;
}

void CheckPlanCase(const PlanCase& c, std::span<const PlannedStop> stops) {
  CheckWay(c);
  Need(c.gyro.angle_random_walk > 0, "angle_random_walk", c.gyro.angle_random_walk,
       "must be positive");
  Need(c.errors.gyro_bias_sigma > 0, "gyro_bias_sigma", c.errors.gyro_bias_sigma,
       "must be positive");
  if (c.sigma_start_azimuth) {
    Need(*c.sigma_start_azimuth > 0, "sigma_start_azimuth", *c.sigma_start_azimuth,
         "must be positive");
  }
  for (const PlannedStop& stop : stops) {
    Need(stop.md >= c.way.begin_md - kSlack && stop.md <= c.way.end_md + kSlack, "stop.md", stop.md,
         "must lie on the way");
    Need(stop.seconds >= 0 && stop.seconds <= range::kStandMost, "stop.seconds", stop.seconds,
         "must be a day at most");
    Need(!stop.out || c.way.speed_out > 0, "stop.md", stop.md,
         "is on the way up, which is not surveyed");
  }
}

}  // namespace wellgyro
