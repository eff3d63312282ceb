#include "wellgyro/simulate/raw_counts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace wellgyro {
namespace {

double Quadratic(const Eigen::Matrix<double, 1, 6>& k, const Eigen::Vector3d& a) {
  return (k[0] * a.x() + k[3] * a.y()) * a.x() + (k[1] * a.y() + k[4] * a.z()) * a.y() +
         (k[2] * a.z() + k[5] * a.x()) * a.z();
}

std::int32_t Clip(double count) {
  constexpr double kMost = std::numeric_limits<std::int32_t>::max();
  return static_cast<std::int32_t>(std::clamp(count, -kMost, kMost));
}

}  // namespace

double RawTemperature(const ThermometerCalibration& thermometer, double temperature) {
  const ThermometerCalibration& m = thermometer;
  // Below the knee the correction is a line; above it a parabola, solved by Newton's method.
  double t = (temperature - m.c0) / (1 + m.c1);
  for (int turn = 0; turn < 50 && t > m.knee; ++turn) {
    const double h = t - m.knee;
    const double step =
        (t + m.c0 + m.c1 * t + m.c2 * h * h - temperature) / (1 + m.c1 + 2 * m.c2 * h);
    t -= step;
    if (std::abs(step) < 1e-12) break;
  }
  return (t - m.offset) / m.gain;
}

void RawCounter::CountGroup(const SensorGroup& group, const Eigen::Vector3d& u_T,
                            const ImuSample& truth, double temperature, double heating_rate,
                            RawSample& raw) {
  const Eigen::Vector3d u = group.R_TS.transpose() * u_T;
  const Eigen::Vector3d f = group.R_TS.transpose() * truth.f_T;
  const double tau = group.thermometer < 0 ? 0 : (temperature - group.reference) / group.half_range;
  for (int c = 0; c < group.n_channels; ++c) {
    double v = group.heating[c] * heating_rate + Quadratic(group.second_order.row(c), u) +
               Quadratic(group.g_squared.row(c), f);
    double power = 1;
    for (std::size_t n = 0; n < SensorGroup::kPowers; ++n) {
      v += power * (group.bias[n][c] + group.sensitivity[n].row(c).dot(u) +
                    group.g_dependence[n].row(c).dot(f));
      power *= tau;
    }
    const auto place = static_cast<std::size_t>(group.channel[static_cast<std::size_t>(c)]);
    double count = v / group.unit_per_count[c];
    if (group.per_second) count = count * truth.stamp.period_ns * 1e-9 + remainder_[place];
    raw.counts[place] = Clip(std::nearbyint(count));
    if (group.per_second) remainder_[place] = count - static_cast<double>(raw.counts[place]);
    raw.n_channels = std::max(raw.n_channels, static_cast<std::int32_t>(place) + 1);
  }
}

RawSample RawCounter::Count(const ImuSample& truth, double temperature, double heating_rate) {
  RawSample raw;
  raw.stamp = truth.stamp;
  CountGroup(tool_.gyro, truth.w_IT_T, truth, temperature, heating_rate, raw);
  CountGroup(tool_.accel, truth.f_T, truth, temperature, heating_rate, raw);
  CountGroup(tool_.mag, truth.b_T, truth, temperature, heating_rate, raw);
  for (const ThermometerCalibration& thermometer : tool_.thermometers) {
    raw.n_temperatures = std::max(raw.n_temperatures, thermometer.channel + 1);
    raw.temperature_raw[static_cast<std::size_t>(thermometer.channel)] =
        static_cast<float>(RawTemperature(thermometer, temperature));
  }
  return raw;
}

}  // namespace wellgyro
