#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/calibration/error_sources.h"
#include "wellgyro/fit/tool_fit.h"

namespace wellgyro {
namespace {

// The part of a list that is one group's.
template <class T>
std::optional<std::vector<T>> PartOf(const std::optional<std::vector<T>>& list, int first, int n,
                                     int all, const char* option) {
  if (!list || list->size() == 1) return list;
  if (static_cast<int>(list->size()) != all) {
    throw std::invalid_argument(
        fmt::format("{} names {}, the calibration has {} channels, the accelerometers' first",
                    option, list->size(), all));
  }
  return std::vector<T>(list->begin() + first, list->begin() + first + n);
}

}  // namespace

ToolCalibration Updated(ToolCalibration tool, const ToolFit& fit, const ToolUpdate& update) {
  const SensorGroup &accel = fit.calibration.accel, &gyro = fit.calibration.gyro;
  const int all = accel.n_channels + gyro.n_channels;
  int first = 0;
  for (const SensorGroup* found : {&accel, &gyro}) {
    if (found->n_channels == 0) continue;
    ToolUpdate part = update;
    part.channels = PartOf(update.channels, first, found->n_channels, all, "--channels");
    part.unit_per_count =
        PartOf(update.unit_per_count, first, found->n_channels, all, "--unit-per-count");
    BenchCalibration one;
    (found == &accel ? one.accel : one.gyro) = *found;
    tool = Updated(std::move(tool), one, part);
    first += found->n_channels;
  }
  (gyro.n_channels > 0 ? tool.gyro : tool.accel).covariance = fit.members;
  if (gyro.n_channels > 0 && accel.n_channels > 0) tool.accel.covariance.reset();
  tool.errors = ErrorsLeft(tool, tool.errors.value_or(ErrorPriors{}));
  return tool;
}

}  // namespace wellgyro
