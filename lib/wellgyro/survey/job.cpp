#include "wellgyro/survey/job.h"

#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/calibration/apply.h"
#include "wellgyro/record/limits.h"

namespace wellgyro {
namespace {

[[noreturn]] void Refuse(std::string_view field, double value, std::string_view why) {
  throw std::invalid_argument(fmt::format("job: {} = {} {}", field, value, why));
}

void RequireWithin(std::string_view field, double value, double low, double high) {
  if (!(value >= low && value <= high)) {
    Refuse(field, value, fmt::format("is outside [{}, {}]", low, high));
  }
}

void RequireFinite(std::string_view field, double value) {
  if (!std::isfinite(value)) Refuse(field, value, "is not a number");
}

void RequireSigmas(std::initializer_list<std::pair<std::string_view, double>> sigmas) {
  for (const auto& [field, value] : sigmas) {
    if (!(value >= 0) || !(value < 1e3)) Refuse(field, value, "is not a sigma (0 to 1000 SI)");
  }
}

void CheckTieIn(const TieIn& tie) {
  RequireWithin("tie_in.md_m", tie.md, -limits::kMd, limits::kMd);
  RequireWithin("tie_in.north_m", tie.north, -1e6, 1e6);
  RequireWithin("tie_in.east_m", tie.east, -1e6, 1e6);
  RequireWithin("tie_in.tvd_m", tie.tvd, -1e5, 1e5);
  if (tie.inclination.has_value() != tie.azimuth.has_value()) {
    throw std::invalid_argument(
        "job: tie_in has one of inclination_deg and azimuth_true_deg; give both or none");
  }
  if (tie.inclination) RequireWithin("tie_in inclination [rad]", *tie.inclination, 0, kPi);
  if (tie.azimuth) RequireFinite("tie_in azimuth [rad]", *tie.azimuth);
  for (int i = 0; i < 3; ++i) {
    if (!(tie.cov_p_WT_W(i, i) >= 0)) {
      Refuse("tie_in.covariance", tie.cov_p_WT_W(i, i), "is not a variance (>= 0)");
    }
  }
}

void CheckAlignment(const AlignmentSpec& alignment) {
  RequireWithin("alignment.min_still_s", alignment.min_still, 3, 86400);
  if (alignment.method != AlignmentSpec::Method::kExternal) return;
  RequireFinite("alignment.azimuth_true [rad]", alignment.azimuth);
  if (!(alignment.sigma_azimuth > 0) || !(alignment.sigma_azimuth < kPi)) {
    Refuse("alignment.sigma_azimuth [rad]", alignment.sigma_azimuth, "is not inside (0, pi)");
  }
  if (alignment.at_md && alignment.at_utc) {
    throw std::invalid_argument("job: alignment has at_md_m and at_utime_us; give one of them");
  }
}

void CheckMagnetic(const MagneticSpec& magnetic) {
  RequireWithin("magnetic.declination [rad]", magnetic.declination, -kPi, kPi);
  if (!(magnetic.sigma > 0) || !(magnetic.sigma < kPi)) {
    Refuse("magnetic.sigma [rad]", magnetic.sigma, "is not inside (0, pi)");
  }
}

void CheckDepth(const DepthSpec& depth) {
  RequireWithin("depth.latency_s", depth.latency, 0, 600);
  RequireWithin("depth.max_gap_s", depth.max_gap, 0.1, 600);
  const Cable& cable = depth.cable;
  RequireWithin("depth.cable stretch [1/N]", cable.stretch, 0, 1e-5);
  RequireWithin("depth.cable.weight_n_per_m", cable.weight, 0, 1e3);
  RequireWithin("depth.cable.tool_weight_n", cable.tool_weight, 0, 1e6);
  RequireWithin("depth.cable.measuring_tension_n", cable.measuring_tension, 0, 1e6);
  RequireWithin("depth.cable.expansion_per_degc", cable.expansion, 0, 1e-3);
  RequireWithin("depth.cable gradient [K/m]", cable.gradient, -1, 1);
  RequireWithin("depth.cable.measuring_temperature_degc", cable.measuring_temperature, -100, 300);
  RequireWithin("depth.cable.surface_temperature_degc", cable.surface_temperature, -100, 300);
  RequireWithin("depth.cable.stretch_sigma_ratio", cable.ratio_sigma, 0, 1);
  if (cable.mark_spacing != 0) {
    RequireWithin("depth.cable.mark_spacing_m", cable.mark_spacing, 1, 1e3);
  }
  RequireWithin("depth.cable.mark_sigma_m", cable.sigma_mark, 0, 10);
  if (cable.first_mark) RequireWithin("depth.cable.first_mark_m", *cable.first_mark, -1e5, 1e5);
  for (std::size_t i = 0; i < depth.corrections.size(); ++i) {
    RequireWithin("depth.corrections", depth.corrections[i].second, -1e4, 1e4);
    if (i > 0 && !(depth.corrections[i].first > depth.corrections[i - 1].first)) {
      Refuse("depth.corrections", depth.corrections[i].first, "m does not increase");
    }
  }
}

void CheckErrors(const NoiseCoefficients& noise, const ErrorPriors& errors) {
  RequireSigmas({{"noise.quantization", noise.quantization},
                 {"noise.angle_random_walk", noise.angle_random_walk},
                 {"noise.bias_instability", noise.bias_instability},
                 {"noise.rate_random_walk", noise.rate_random_walk},
                 {"noise.rate_ramp", noise.rate_ramp},
                 {"errors.gyro_bias_sigma", errors.gyro_bias_sigma},
                 {"errors.mass_unbalance_sigma", errors.mass_unbalance_sigma},
                 {"errors.quadrature_sigma", errors.quadrature_sigma},
                 {"errors.gyro_scale_sigma", errors.gyro_scale_sigma},
                 {"errors.gyro_misalignment_sigma", errors.gyro_misalignment_sigma},
                 {"errors.accel_bias_sigma", errors.accel_bias_sigma},
                 {"errors.accel_noise", errors.accel_noise},
                 {"errors.roll_offset_sigma", errors.roll_offset_sigma},
                 {"errors.time_skew_sigma", errors.time_skew_sigma},
                 {"errors.depth_sigma", errors.depth_sigma},
                 {"errors.latitude_sigma", errors.latitude_sigma}});
  const auto& correlation = noise.bias_instability_correlation_time;
  if (correlation && !(*correlation > 0)) {
    Refuse("noise.bias_instability_correlation_time", *correlation, "s is not a time (> 0)");
  }
}

void CheckRuns(const std::vector<RunSpec>& runs) {
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (runs[i].number < 1) Refuse("run.number", runs[i].number, "is not a run (from 1)");
    for (std::size_t j = 0; j < i; ++j) {
      if (runs[j].number == runs[i].number) Refuse("run.number", runs[i].number, "stands twice");
    }
    if (runs[i].begin && runs[i].end && !(*runs[i].begin < *runs[i].end)) {
      Refuse("run.number", runs[i].number, "ends before it begins");
    }
  }
}

}  // namespace

void CheckJob(const Job& job) {
  // 89.9 deg: at the poles there is no azimuth to find and no meridian to carry it along.
  const double polar = FromDegrees(89.9);
  RequireWithin("well.latitude [rad]", job.well.latitude, -polar, polar);
  RequireWithin("well.longitude [rad]", job.well.longitude, -kTwoPi, kTwoPi);
  RequireWithin("well.datum_elevation_m", job.well.datum_elevation, -12000, 9000);
  CheckTieIn(job.tie_in);
  CheckAlignment(job.alignment);
  if (job.magnetic) CheckMagnetic(*job.magnetic);
  CheckDepth(job.depth);
  CheckErrors(job.noise, job.errors);
  if (job.tool) {
    if (const auto complaint = FindComplaint(*job.tool)) {
      throw std::invalid_argument("job: tool: " + *complaint);
    }
  }
  CheckRuns(job.runs);
  if (job.stations.every != 0) RequireWithin("stations.every_m", job.stations.every, 0.2, 1e5);
  for (double md : job.stations.at) RequireFinite("stations.at_m", md);
  if (job.stations.every == 0 && job.stations.at.empty() && !job.stations.at_stops) {
    throw std::invalid_argument(
        "job: [stations] asks for nothing; give every_m, at_m or at_stops = true");
  }
  const double tilt = FromDegrees(5);
  RequireWithin("string.sag [rad]", job.string.sag, -tilt, tilt);
  RequireWithin("string.misalignment_x [rad]", job.string.misalignment_x, -tilt, tilt);
  RequireWithin("string.misalignment_y [rad]", job.string.misalignment_y, -tilt, tilt);
  RequireWithin("string.sensor_below_reference_m", job.string.sensor_below_reference,
                -limits::kSensorBelowReference, limits::kSensorBelowReference);
  RequireSigmas({{"string.sag_sigma", job.string.sigma_sag},
                 {"string.misalignment_sigma", job.string.sigma_misalignment}});
}

}  // namespace wellgyro
