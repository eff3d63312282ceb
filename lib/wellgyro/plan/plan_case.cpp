#include "wellgyro/plan/plan_case.h"

#include <cmath>
#include <stdexcept>
#include <string_view>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"

namespace wellgyro {
namespace {

constexpr double kLeastWay = 10;     // [m] that there is something to plan
constexpr double kLongest = 20'000;  // [m], past the longest well drilled
// [m/s]: slower, a kilometre takes more than 5.6 h; faster, a jump to DepthTrack (speed_limit).
constexpr double kSlowest = 0.05, kFastest = 10;
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
  Need(way.end_md - way.begin_md <= kLongest, "end_md", way.end_md,
       fmt::format("must be {:g} m below begin_md at most", kLongest));
  Need(way.speed_in >= kSlowest && way.speed_in <= kFastest, "speed_in", way.speed_in,
       "must be 0.05 to 10 m/s");
  Need(way.speed_out == 0 || (way.speed_out >= kSlowest && way.speed_out <= kFastest), "speed_out",
       way.speed_out, "must be 0.05 to 10 m/s, or 0");
  Need(std::abs(way.roll_rate) <= kTwoPi, "roll_rate", way.roll_rate,
       "must be 60 rpm at most [rad/s]");
  Need(std::abs(way.swing) <= kTwoPi, "swing", way.swing, "must be one turn at most [rad]");
  Need(way.swing_period >= 60, "swing_period", way.swing_period, "must be 60 s at least");
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
    Need(stop.seconds >= 0 && stop.seconds <= 86'400, "stop.seconds", stop.seconds,
         "must be a day at most");
    Need(!stop.out || c.way.speed_out > 0, "stop.md", stop.md,
         "is on the way up, which is not surveyed");
  }
}

}  // namespace wellgyro
