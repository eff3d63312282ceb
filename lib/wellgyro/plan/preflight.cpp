#include "wellgyro/plan/preflight.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/uncertainty/ellipse.h"

namespace wellgyro {
namespace {

// cos 75 deg = 0.26: a north is four times as vague as at the equator.
constexpr double kPoorLatitude = 75 * units::kDeg;
// Of the Earth's horizontal rate that is across the tool: below it five times as vague.
constexpr double kPoorNorth = 0.2;
// Inclination at which an accelerometer error of 0.5 mg still turns the roll by 0.5e-3 / sin 1 deg
// = 1.6 deg.
constexpr double kNoHold = units::kDeg;
constexpr double kStep = units::kStand / 3;  // [m] by which the well is looked at
constexpr double kDepthShare = 0.5;  // of the ellipse; less adds 12 % at most, sqrt(1 + 0.5^2)

/// Length of the way on which `holds` [m].
template <class Condition>
double LengthWhere(const PlanCase& c, const Condition& holds) {
  double sum = 0;
  for (double md = c.way.begin_md; md < c.way.end_md; md += kStep) {
    const double at = std::clamp(md, c.well.md_begin(), c.well.md_end());
    if (holds(c.well.AtMd(at))) sum += std::min(kStep, c.way.end_md - md);
  }
  return sum;
}

void AddNorth(const PlanCase& c, std::vector<std::string>& said) {
  if (std::abs(c.site.latitude) > kPoorLatitude) {
    said.push_back(fmt::format(
        "latitude {:.1f} deg: of the Earth's rate {:.1f} deg/h are horizontal, and only they show "
        "north",
        ToDegrees(c.site.latitude), kEarthRate * std::cos(c.site.latitude) / units::kDegPerHour));
  }
  const double poor = LengthWhere(c, [](const TrajectoryPoint& p) {
    return std::hypot(std::cos(p.azimuth), std::sin(p.azimuth) * std::cos(p.inclination)) <
           kPoorNorth;
  });
  if (poor > 0) {
    said.push_back(fmt::format(
        "{:.0f} m of the well are near horizontal east-west, where a stop shows no north: azimuth "
        "is carried there by the gyros",
        poor));
  }
  const double vertical =
      LengthWhere(c, [](const TrajectoryPoint& p) { return p.inclination < kNoHold; });
  if (vertical > 0) {
    said.push_back(
        fmt::format("{:.0f} m of the well are within 1 deg of vertical, where gravity hardly shows "
                    "the tool's roll{}",
                    vertical, c.third_axis ? "; the third gyro axis does" : ""));
  }
}

void AddDrift(const PlanCase& c, double seconds, std::vector<std::string>& said) {
  const double walk = c.gyro.rate_random_walk * std::sqrt(seconds);
  if (walk > c.errors.gyro_bias_sigma) {
    said.push_back(fmt::format(
        "the gyros' rate walks by {:.2g} deg/h in the {:.1f} h of the run, more than the {:.2g} "
        "deg/h of its bias",
        walk / units::kDegPerHour, seconds / units::kHour,
        c.errors.gyro_bias_sigma / units::kDegPerHour));
  }
  const ErrorPriors& e = c.errors;
  const std::pair<const char*, double> sigmas[] = {
      {"mass unbalance", e.mass_unbalance_sigma},
      {"quadrature", e.quadrature_sigma},
      {"gyro scale", e.gyro_scale_sigma},
      {"gyro misalignment", e.gyro_misalignment_sigma},
      {"accelerometer bias", e.accel_bias_sigma},
      {"accelerometer noise", e.accel_noise},
      {"toolface offset", e.roll_offset_sigma},
      {"time skew", e.time_skew_sigma},
      {"depth", e.depth_sigma},
      {"depth scale", e.depth_scale_sigma},
  };
  std::string none;
  for (const auto& [name, sigma] : sigmas) {
    if (sigma == 0) none += (none.empty() ? "" : ", ") + std::string(name);
  }
  if (!none.empty()) said.push_back("the tool is taken to have no error of " + none);
}

void AddDates(const PreflightDates& dates, std::vector<std::string>& said) {
  if (!dates.run) {
    if (dates.expires) {
      said.push_back("the tool's calibration has an end: --date of the run tells whether it holds");
    }
    return;
  }
  if (dates.expires && *dates.run > *dates.expires) {
    said.push_back(fmt::format("the tool's calibration runs out {:.0f} days before the run",
                               (*dates.run - *dates.expires).seconds() / units::kDay));
  }
  if (!dates.calibrated) return;
  const double age = (*dates.run - *dates.calibrated).seconds() / units::kDay;
  if (age < 0) {
    said.push_back(fmt::format("the tool is calibrated {:.0f} days after the run", -age));
  } else if (!dates.expires) {
    said.push_back(fmt::format("the tool's calibration is {:.0f} days old and states no end", age));
  }
}

}  // namespace

std::vector<std::string> Preflight(const PlanCase& c, const ExpectedEnd& expected,
                                   const PreflightHeat& heat, const PreflightDates& dates) {
  std::vector<std::string> said;
  AddNorth(c, said);
  AddDrift(c, expected.seconds, said);
  const double depth = HorizontalEllipse(DepthCovariance(c), kConfidence).semi_major;
  if (depth > kDepthShare * expected.semi_major) {
    said.push_back(fmt::format(
        "errors of depth alone make {:.2f} m of the ellipse, which no stop makes less", depth));
  }
  if (heat.gradient != 0) {
    double tvd = 0;
    LengthWhere(c, [&tvd](const TrajectoryPoint& p) {
      tvd = std::max(tvd, p.position_W.z());
      return false;
    });
    const double at = heat.at_surface + heat.gradient * tvd;
    if (at > heat.calibrated_to) {
      said.push_back(
          fmt::format("{:.0f} degC at {:.0f} m TVD, and the tool is calibrated to {:.0f}", at, tvd,
                      heat.calibrated_to));
    }
  }
  AddDates(dates, said);
  return said;
}

}  // namespace wellgyro
