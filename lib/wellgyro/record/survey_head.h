#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/earth/grid.h"
#include "wellgyro/record/depth.h"

/// @file
/// What surveys say about themselves in the files that people exchange. Text that a file does not
/// give is empty.
namespace wellgyro {

/// Unit of lengths in a file.
enum class LengthUnit { kMetre, kFoot, kUsFoot };
/// Unit of dogleg severity, build and turn in a file.
enum class CurvatureUnit { kDegPer30m, kDegPer100ft, kDegPerMetre, kDegPerFoot, kRadPerMetre };

/// The tool, as the exchange formats class it.
enum class SurveyTool {
  kUnknown,
  kGyroContinuous,
  kGyroNorthSeeking,
  kGyroMwd,
  kMagneticMwd,
  kMagneticMultishot,
  kMagneticSingleShot,
  kInclinationOnly,
};

/// The names of things, and who did what when.
struct SurveyIdentity {
  std::string field, region, country, country_code;
  std::string structure, structure_kind;
  std::string well, uwi, wellbore, uwi_wellbore, rig;
  std::string survey;  ///< name of the survey itself
  std::string operator_name, contractor, job;
  std::string author;
  std::string uid_well, uid_wellbore, uid_survey;
  std::string created;     ///< when the file was written, ISO 8601 UTC
  std::string begin, end;  ///< of the survey, ISO 8601: a day or an instant
};

/// A coordinate reference system or transformation that a file names; nothing is looked up.
struct CrsEntry {
  int number = 0;  ///< the file's own
  std::string code, name, version, date, source, text;
};

/// A point that a file names: structure, well and zero-depth reference points, tie-in points.
struct PositionObject {
  int number = 0;  ///< the file's own
  std::string kind, name, text;
  std::optional<double> md;                                ///< [m]
  std::optional<double> northing, easting, down;           ///< [m]
  std::optional<double> latitude, longitude;               ///< of the survey's own datum [rad]
  std::optional<double> latitude_wgs84, longitude_wgs84;   ///< [rad]
  std::optional<double> sigma_horizontal, sigma_vertical;  ///< [m]
};

/// One of the surveys of which a file is composed.
struct SurveyRun {
  int number = 1;  ///< the file's own; rows refer to it
  std::string name, begin, end, contractor, job, operator_name;
  SurveyTool tool = SurveyTool::kUnknown;
  DepthKind md_kind = DepthKind::kIndicated;
  int md_status = 1;  ///< 0 planned, 1 indicated, 2 calibrated, 3 corrected, 4 true along-hole
  AzimuthReference azimuth;
};

/// One record of raw gyro data, IOGP P7/17 G7. Axes and signs are the file's: any frame.
struct GyroRawRecord {
  int survey = 1, number = 0, tool = 0;
  std::string time;  ///< as the file has it
  bool used = true;
  double md = 0;                                          ///< [m]
  double inclination = 0, azimuth = 0;                    ///< [rad]
  std::optional<double> north, east, down;                ///< [m]
  Eigen::Vector3d f = Eigen::Vector3d::Zero();            ///< [m/s^2]
  Eigen::Vector3d w = Eigen::Vector3d::Zero();            ///< [rad/s]
  std::optional<double> gravity;                          ///< measured [m/s^2]
  std::optional<double> latitude;                         ///< measured [rad]
  std::optional<double> earth_rate;                       ///< measured [rad/s]
  std::optional<double> gyro_toolface, gravity_toolface;  ///< [rad]
  std::optional<double> gravity_ref;     ///< of the Earth model at the place [m/s^2]
  std::optional<double> latitude_ref;    ///< of the place [rad]
  std::optional<double> earth_rate_ref;  ///< of the Earth model at the place [rad/s]
  std::optional<double> convergence;     ///< [rad]
};

/// Everything a survey file says besides its stations.
struct SurveyHead {
  SurveyIdentity names;
  AzimuthReference azimuth;               ///< of column kAzimuth
  North offsets = North::kUnknown;        ///< of columns kNorth and kEast
  std::string datum;                      ///< of MD and TVD, as "RT"
  std::optional<double> datum_elevation;  ///< above `vertical_reference` [m]
  std::string vertical_reference;         ///< as "MSL"
  DepthKind md_kind = DepthKind::kIndicated;
  LengthUnit md_unit = LengthUnit::kMetre;    ///< of MD, TVD and offsets, in the file
  LengthUnit grid_unit = LengthUnit::kMetre;  ///< of the CRS: northing, easting, down
  CurvatureUnit curvature_unit = CurvatureUnit::kDegPer30m;
  std::string crs;                             ///< of northing and easting, as "EPSG:23031"
  std::optional<double> scale;                 ///< of the grid, at the well head
  std::string method;                          ///< by which positions were summed
  std::optional<double> section_azimuth;       ///< plane of the vertical section [rad]
  double section_north = 0, section_east = 0;  ///< its origin [m]
  SurveyTool tool = SurveyTool::kUnknown;
  std::string error_model, error_model_uid;
  std::optional<bool> definitive, memory, final_survey;
  std::optional<bool> planned;            ///< a plan, not a survey
  std::optional<double> grid_correction;  ///< WITSML 1.4's gridCorUsed, kept uninterpreted
  std::vector<CrsEntry> crs_entries, transformations;
  std::vector<PositionObject> objects;
  std::vector<SurveyRun> runs;
  std::vector<GyroRawRecord> gyro_raw;
  std::vector<std::string> remarks;
  std::vector<std::string> notes;  ///< what reading the file settled, changed or could not check
};

}  // namespace wellgyro
