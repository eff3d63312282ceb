#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/base/time.h"
#include "wellgyro/earth/grid.h"
#include "wellgyro/record/channels.h"
#include "wellgyro/record/depth.h"
#include "wellgyro/record/noise.h"
#include "wellgyro/record/operations.h"
#include "wellgyro/record/tool_calibration.h"

/// @file
/// The job: everything that, with the messages, makes a survey.
namespace wellgyro {

struct ErrorModel;

/// Where the survey is tied on: its first row.
struct TieIn {
  double md = 0, north = 0, east = 0;                    ///< [m]
  std::optional<double> tvd;                             ///< [m]; needed where md is not 0, else 0
  std::optional<double> inclination, azimuth;            ///< true [rad]; both or none
  Eigen::Matrix3d cov_p_WT_W = Eigen::Matrix3d::Zero();  ///< of the position [m^2]
  bool place_stated = true;  ///< false: nobody said, and north and east are taken as 0
};

/// Where a run's azimuth comes from: north found at its stops, or an azimuth that was told.
struct AlignmentSpec {
  enum class Method { kGyrocompass, kExternal };
  /// What an external azimuth is the azimuth of.
  enum class Of { kAxis, kMark };
  Method method = Method::kGyrocompass;
  Of of = Of::kAxis;
  double azimuth = 0;             ///< true [rad]
  double sigma_azimuth = 0;       ///< [rad]
  std::optional<double> at_md;    ///< holds at this depth [m] ...
  std::optional<UtcTime> at_utc;  ///< ... or this time; neither: the begin of the first sample
  bool use_fixes = true;          ///< of later north fixes, with an external azimuth
  double min_still = 60;          ///< shortest stop that is gyrocompassed [s]
};

/// How samples are summed on the run.
struct AttitudeSpec {
  /// Order of the form that sums samples: its error falls with this power of the sample's period.
  enum class Order { kSecond, kThird };
  Order order = Order::kThird;  ///< the second is cheaper, not better
};

/// What the job says of the magnetic azimuths of a tool that has magnetometers.
struct MagneticSpec {
  double declination = 0;  ///< true azimuth less magnetic [rad]
  /// 1-sigma of an azimuth made true by it: tool, string and declination, alike at all stops [rad].
  double sigma = 0;
  bool tie = false;  ///< the first of each run ties the run's azimuth; else they are only compared
};

/// Where along the hole there are to be stations.
struct StationSpec {
  double every = 10;       ///< spacing [m]; 0: none
  std::vector<double> at;  ///< depths asked for [m]
  bool at_stops = false;   ///< the gyrocompass stations too
};

/// What measured the depth, and how its marks are used.
struct DepthSpec {
  DepthKind kind = DepthKind::kIndicated;
  double latency = 5;  ///< how late a depth mark may come, against the samples [s]
  Cable cable;         ///< of a wireline
  double max_gap = 5;  ///< between marks of a moving tool, above which depth is unknown [s]
  /// (measured depth, what to add to it) [m], linear between; empty: none.
  std::vector<std::pair<double, double>> corrections;
};

/// R_TH: how the tool lies in the hole, and where its sensors are.
struct StringSpec {
  double sensor_below_reference = 0;  ///< along hole [m]
  double sag = 0;             ///< of the tool axis below the hole axis, in a horizontal hole [rad]
  double sigma_sag = 0;       ///< [rad]
  double misalignment_x = 0;  ///< tool axis against hole axis, towards Tx [rad]
  double misalignment_y = 0;  ///< likewise, towards Ty [rad]
  double sigma_misalignment = 0;  ///< of each [rad]
};

/// Limits of checks, where they do not follow from the error model. Absent: 3 sigma.
struct Acceptance {
  std::optional<double> gravity;                 ///< [m/s^2]
  std::optional<double> earth_rate;              ///< [rad/s]
  std::optional<double> inclination_difference;  ///< in-run against out-run [rad]
  std::optional<double> azimuth_difference;      ///< [rad]
  std::optional<double> foresight;               ///< [rad]
  std::optional<double> depth_closure;           ///< return to zero [m]
};

/// What the job says of one run, where it is not on the wire.
struct RunSpec {
  std::int32_t number = 1;
  std::optional<UtcTime> begin, end;
  bool misrun = false;
  std::string remark;
};

/// One survey job: everything that, with the messages, makes the result. One job serves live and
/// log. Made by io/ from TOML, or by the vendor's own program.
struct Job {
  /// The well head: its name and its place.
  struct Well {
    std::string name;
    double latitude = 0;         ///< geodetic [rad]
    double longitude = 0;        ///< [rad]
    double datum_elevation = 0;  ///< of the depth datum above mean sea level [m]
  };
  Well well;
  std::vector<std::pair<std::string, std::string>> identity;  ///< free keys, in the file's order
  std::optional<GridSpec> grid;
  TieIn tie_in;
  std::optional<ToolCalibration> tool;  ///< absent: samples come in SI units
  NoiseCoefficients noise;
  bool noise_stated = true;  ///< false: nobody said, and `noise` is a guess
  ErrorPriors errors;
  /// By which covariances are found; null: from the run itself alone.
  std::shared_ptr<const ErrorModel> error_model;
  Channels channels;
  AlignmentSpec alignment;
  std::optional<MagneticSpec> magnetic;
  AttitudeSpec attitude;
  StationSpec stations;
  DepthSpec depth;
  StringSpec string;
  Acceptance acceptance;
  std::vector<RunSpec> runs;
  std::vector<Event> events;
};

/// Throws std::invalid_argument with the field and the value when `job` makes no sense.
WELLGYRO_EXPORT void CheckJob(const Job& job);

}  // namespace wellgyro
