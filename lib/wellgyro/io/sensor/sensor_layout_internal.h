#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "wellgyro/io/sensor/sensor_csv.h"

/// The columns of tables of sensor data.
namespace wellgyro::sensors {

/// Columns by their names in a header, see sensor_csv.h; the three of an axis follow each other.
enum SensorColumn : std::uint8_t {
  kUtc,         ///< UTC: when it begins, or the depth was read
  kEndUtc,      ///< END_UTC: of a rest
  kTool,        ///< TOOL: on the tool's own clock
  kGx,          ///< GX: angular rate about x
  kGy,          ///< GY
  kGz,          ///< GZ, where there is a third gyro
  kAx,          ///< AX: specific force along x
  kAy,          ///< AY
  kAz,          ///< AZ
  kMx,          ///< MX: flux density along x
  kMy,          ///< MY
  kMz,          ///< MZ
  kSigGx,       ///< SIG_GX: 1 sigma of the average
  kSigGy,       ///< SIG_GY
  kSigGz,       ///< SIG_GZ
  kSigAx,       ///< SIG_AX: likewise
  kSigAy,       ///< SIG_AY
  kSigAz,       ///< SIG_AZ
  kTemp,        ///< TEMP: of the tool
  kDuration,    ///< DURATION: of an average
  kMd,          ///< MD: of the depth reference
  kLengthOf,    ///< LENGTH: of the pipe run since the row before
  kSigMd,       ///< SIG_MD: 1 sigma
  kTensionOf,   ///< TENSION: of cable or hook
  kStopped,     ///< STOPPED: 1 at rest
  kMark,        ///< MARK: 1 at a magnetic mark
  kCorrected,   ///< CORRECTED: 1 where the depth is corrected already
  kIndex,       ///< INDEX: position of an index drive
  kRun,         ///< RUN
  kToolNumber,  ///< TOOL_NUMBER: in the string
  kColumns      ///< how many there are
};
/// Where each column stands, and its unit.
struct Layout {
  struct Place {
    int field = -1;     ///< number of the column from 0; -1: it is not there
    double factor = 1;  ///< SI units that one of its units is
  };
  std::array<Place, kColumns> places;
  bool meant = false;     ///< a heading has a name that is known, be its unit so or not
  std::string complaint;  ///< about a heading
  int complaint_field = 0;

  bool Has(SensorColumn column) const { return places[column].field >= 0; }
  bool HasAll(std::initializer_list<SensorColumn> columns) const {
    for (const SensorColumn column : columns) {
      if (!Has(column)) return false;
    }
    return true;
  }
  /// Places one heading; a name that is not known, stands twice or has no known unit is the
  /// complaint.
  void Take(std::string_view heading, int field);
  /// What such columns make together; nothing where one is missing.
  std::optional<SensorTable> Kind() const;
  /// Where that is none: the columns that are missing, in words.
  std::string Lacking() const;
};

/// A heading taken apart: name, and of a unit in brackets what it measures and its SI value (a
/// clock's in ns); nothing of a unit that is not known.
struct HeadedUnit {
  std::string_view name;
  std::string_view unit;
  bool clock = false, rate = false, force = false;
  double factor = 1;
};
std::optional<HeadedUnit> HeadedUnitOf(std::string_view heading);

/// Of a header line, a byte order mark before it or not.
Layout LayoutOf(std::string_view header);

}  // namespace wellgyro::sensors
