#pragma once

#include <filesystem>
#include <optional>
#include <utility>
#include <variant>

#include "wellgyro/base/result.h"
#include "wellgyro/io/sensor/sensor_csv.h"

namespace wellgyro::sensors {

/// Every row of a table, or the fault of one.
template <class Record, class Take>
std::optional<Fault> ForEach(SensorCsv& table, Take take) {
  SensorCsv::Row row;
  while (table.Next(row)) take(std::get<Record>(row));
  return table.fault();
}
template <class Record, class Take>
std::optional<Fault> ForEach(const std::filesystem::path& path, Take take) {
  Result<SensorCsv> table = SensorCsv::Open(path);
  if (!table) return table.fault();
  return ForEach<Record>(*table, take);
}

}  // namespace wellgyro::sensors
