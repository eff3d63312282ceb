#include "wellgyro/calibration/tool_update.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include <Eigen/Geometry>
#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/calibration/error_sources.h"
#include "wellgyro/math/so3.h"
#include "wellgyro/record/sample.h"

namespace wellgyro {
namespace {

std::vector<int> FreeChannels(const ToolCalibration& tool, const SensorGroup& but, int n) {
  std::set<int> taken;
  for (const SensorGroup* group : {&tool.gyro, &tool.accel, &tool.mag}) {
    if (group == &but) continue;
    for (int c = 0; c < group->n_channels; ++c) {
      taken.insert(group->channel[static_cast<std::size_t>(c)]);
    }
  }
  std::vector<int> free;
  for (int place = 0; static_cast<int>(free.size()) < n && place < RawSample::kChannelsMax;
       ++place) {
    if (taken.count(place) == 0) free.push_back(place);
  }
  return free;
}

template <class T>
void RequireLength(const std::vector<T>& list, int n, std::string_view what) {
  if (static_cast<int>(list.size()) != n) {
    throw std::invalid_argument(
        fmt::format("{} names {}, the calibration has {} channels", what, list.size(), n));
  }
}

void TakeGroup(const ToolCalibration& tool, const SensorGroup& found, const FitReport& report,
               const ToolUpdate& update, SensorGroup& group) {
  const int n = found.n_channels;
  if (n == 0) return;
  const SensorGroup before = group;
  group = found;
  if (update.channels) {
    RequireLength(*update.channels, n, "--channels");
    std::copy(update.channels->begin(), update.channels->end(), group.channel.begin());
  } else if (before.n_channels == n) {
    group.channel = before.channel;
  } else {
    const std::vector<int> free = FreeChannels(tool, group, n);
    RequireLength(free, n, "the list of free channels");
    std::copy(free.begin(), free.end(), group.channel.begin());
  }
  if (update.unit_per_count) {
    std::vector<double> units = *update.unit_per_count;
    if (units.size() == 1) units.assign(static_cast<std::size_t>(n), units.front());
    RequireLength(units, n, "--unit-per-count");
    for (int c = 0; c < n; ++c) group.unit_per_count[c] = units[static_cast<std::size_t>(c)];
  } else if (before.n_channels == n) {
    group.unit_per_count = before.unit_per_count;
  }
  if (group.thermometer >= 0) group.thermometer = update.thermometer;
  if (update.R_TS) group.R_TS = *update.R_TS;
  if (report.cov.size() > 0) group.covariance = ParameterCovariance{report.parameters, report.cov};
}

void TakeThermometer(const BenchCalibration& bench, const ToolUpdate& update,
                     ToolCalibration& tool) {
  const bool wanted =
      bench.thermometer || bench.accel.thermometer >= 0 || bench.gyro.thermometer >= 0;
  const auto place = static_cast<std::size_t>(update.thermometer);
  if (wanted && tool.thermometers.size() <= place) tool.thermometers.resize(place + 1);
  if (wanted && update.thermometer_channel) {
    tool.thermometers[place].channel = *update.thermometer_channel;
  }
  if (!bench.thermometer) return;
  ThermometerCalibration& t = tool.thermometers[place];
  const ThermometerCalibration before = t;
  t = *bench.thermometer;
  t.channel = before.channel;
  t.offset = before.offset;
  t.gain = before.gain;
}

// Half a turn about x for what points against z.
Eigen::Matrix3d LeastTurnToZ(const Eigen::Vector3d& unit) {
  const Eigen::Vector3d across = unit.cross(Eigen::Vector3d::UnitZ());
  const double sine = across.norm(), angle = std::atan2(sine, unit.z());
  return Exp(angle * (sine > 0 ? Eigen::Vector3d(across / sine) : Eigen::Vector3d::UnitX()));
}

// The housing's axis becomes z of the tool, by the least turn.
void TakeAxis(const Eigen::Vector3d& axis, BenchAxes axes, ToolCalibration& tool) {
  if (tool.accel.n_channels == 0) {
    throw std::invalid_argument(
        "the roll test turns the accelerometers' axes: calibrate them first, into the same tool "
        "file");
  }
  const Eigen::Vector3d in_tool = ToolFromBench(axes) * axis.normalized();
  const Eigen::Matrix3d R = LeastTurnToZ(in_tool);
  tool.accel.R_TS = R * tool.accel.R_TS;
  if (tool.mag.n_channels > 0) tool.mag.R_TS = R * tool.mag.R_TS;
}

// Largest sigma of a quantity; of a matrix's diagonal, or of what lies beside it.
enum class Part { kAll, kDiagonal, kBeside };
double Largest(const FitReport& report, std::string_view name, Part part = Part::kAll) {
  double largest = 0;
  for (const FitQuantity& quantity : report.result) {
    if (quantity.name != name) continue;
    for (Eigen::Index i = 0; i < quantity.sigma.rows(); ++i) {
      for (Eigen::Index j = 0; j < quantity.sigma.cols(); ++j) {
        // Of a gyro's channels the nominal axis is where the sensitivity is about one.
        const bool own = std::abs(quantity.value(i, j)) > 0.5;
        if (part == Part::kAll || (part == Part::kDiagonal) == own) {
          largest = std::max(largest, quantity.sigma(i, j));
        }
      }
    }
  }
  return largest;
}

// Largest sigma of a matrix of sensitivities over their size, of the axes' own or of what they see
// of each other.
double LargestRelative(const FitReport& report, std::string_view name, bool own) {
  double largest = 0;
  for (const FitQuantity& quantity : report.result) {
    if (quantity.name != name) continue;
    const double size = quantity.value.cwiseAbs().maxCoeff();
    for (Eigen::Index i = 0; i < quantity.sigma.rows(); ++i) {
      for (Eigen::Index j = 0; j < quantity.sigma.cols(); ++j) {
        if ((std::abs(quantity.value(i, j)) > 0.5 * size) != own) continue;
        largest = std::max(largest, quantity.sigma(i, j) / size);
      }
    }
  }
  return largest;
}

// Second order counts with the bias, by its mean over all attitudes.
void TakeAccelErrors(const BenchCalibration& bench, ErrorPriors& errors) {
  const FitReport& report = bench.report;
  const double S = bench.accel.sensitivity[0].topRows<3>().cwiseAbs().maxCoeff();
  double bias = Largest(report, "a0_mps2");
  for (const char* name : {"Vb_V", "b_G", "ba"}) bias = std::max(bias, Largest(report, name) / S);
  const double square = std::max(Largest(report, "K2_V_per_g2"), Largest(report, "K2_G")) / S / 3;
  errors.accel_bias_sigma = std::hypot(bias, square);
  errors.accel_scale_sigma = 0;
  errors.accel_misalignment_sigma = std::max(Largest(report, "E_G"), Largest(report, "E_rad"));
  for (const char* name : {"S_V_per_g", "S_G", "Ka", "k_pulse_per_s_per_mps2"}) {
    errors.accel_scale_sigma =
        std::max(errors.accel_scale_sigma, LargestRelative(report, name, true));
    errors.accel_misalignment_sigma =
        std::max(errors.accel_misalignment_sigma, LargestRelative(report, name, false));
  }
}

void TakeErrors(const BenchCalibration& bench, ToolCalibration& tool) {
  const FitReport& report = bench.report;
  ErrorPriors errors = tool.errors.value_or(ErrorPriors{});
  if (bench.accel.n_channels > 0) TakeAccelErrors(bench, errors);
  if (bench.gyro.n_channels > 0) {
    // The priors have no anisoelasticity: it goes with the bias, a half of it at 45 deg.
    errors.gyro_bias_sigma =
        std::hypot(Largest(report, "b_degh"), Largest(report, "aniso_degh_per_g2") / 2) *
        units::kDegPerHour;
    errors.gyro_scale_sigma = Largest(report, "U", Part::kDiagonal);
    errors.gyro_misalignment_sigma = Largest(report, "U", Part::kBeside);
    const double force = Largest(report, "G_degh_per_g") * units::kDegPerHourPerG;
    errors.mass_unbalance_sigma = force;
    errors.quadrature_sigma = force;
  }
  if (bench.accel.n_channels > 0 || bench.gyro.n_channels > 0) tool.errors = errors;
}

}  // namespace

ToolCalibration Updated(ToolCalibration tool, const BenchCalibration& bench,
                        const ToolUpdate& update) {
  TakeThermometer(bench, update, tool);
  TakeGroup(tool, bench.gyro, bench.report, update, tool.gyro);
  TakeGroup(tool, bench.accel, bench.report, update, tool.accel);
  // Lists of channels are those of one group: with two, of the accelerometers.
  ToolUpdate of_mag = update;
  if (bench.accel.n_channels > 0) {
    of_mag.channels.reset();
    of_mag.unit_per_count.reset();
    of_mag.R_TS.reset();
  }
  TakeGroup(tool, bench.mag, bench.report, of_mag, tool.mag);
  if (bench.axis_B) TakeAxis(*bench.axis_B, update.axes, tool);
  TakeErrors(bench, tool);
  if (update.asset_serial) tool.asset_serial = *update.asset_serial;
  if (update.sensor_serials) tool.sensor_serials = *update.sensor_serials;
  if (update.calibrated) tool.calibrated = update.calibrated;
  if (update.expires) tool.expires = update.expires;
  return tool;
}

}  // namespace wellgyro
