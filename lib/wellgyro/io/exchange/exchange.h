#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/earth/grid.h"
#include "wellgyro/record/station.h"
#include "wellgyro/record/survey_table.h"
#include "wellgyro/survey/job.h"

/// @file
/// Surveys in the files that people exchange. Every format reads into a SurveyTable and writes from
/// one; what the format can hold comes back to the last bit.
namespace wellgyro {

/// The formats; WordOf and SurveyFormatOf have the word of each.
enum class SurveyFormat {
  kCsv,         ///< one header line, as survey.csv; read: any table, by the names of its columns
  kLas,         ///< CWLS LAS 2.0; step fixed where the depths allow it, else 0
  kP717,        ///< IOGP P7/17 v1.0 with G7 records
  kWitsml1411,  ///< WITSML 1.4.1.1 trajectory
  kWitsml20,    ///< read only
  kWitsml21,
  kPetrel,   ///< "WELL TRACE FROM PETREL"
  kCompass,  ///< text report in the manner of Landmark Compass
  kOsdu,     ///< manifest WellboreTrajectory 1.4.0; write only: its stations go by CSV
  kGeoJson,  ///< path, stations and 95 % ellipses on WGS 84; write only, as the two below
  kKml,
  kGeoPackage,  ///< an SQLite database with the layers path, stations and ellipses
};

/// The format of a word: csv, las, p717, witsml (1.4.1.1), witsml20, witsml21, petrel, compass,
/// osdu, geojson, kml, gpkg; nothing of another.
WELLGYRO_EXPORT std::optional<SurveyFormat> SurveyFormatOf(std::string_view word);
/// The word of a format. Throws std::invalid_argument, as all that take a format, when there is no
/// such one.
WELLGYRO_EXPORT std::string_view WordOf(SurveyFormat format);
/// The words of all that are not read only.
WELLGYRO_EXPORT std::vector<std::string> WrittenFormats();
/// File name for `stem`, as "survey.las" or "survey-1411.xml".
WELLGYRO_EXPORT std::string FileNameOf(SurveyFormat format, const std::string& stem);

/// What the caller knows and the file may not say. Where both say different things, the caller's
/// holds and the head's notes say so.
struct ReadOptions {
  std::optional<SurveyFormat> format;  ///< else by the file's own first lines
  /// Columns of a table: canonical name (MD, INC, AZI_TRUE, TVD ...) and the file's heading or its
  /// number from 1. Those named here win over what the headings look like.
  std::vector<std::pair<std::string, std::string>> columns;
  std::optional<LengthUnit> depth_unit;
  std::optional<North> north;         ///< from which azimuths count
  std::optional<double> convergence;  ///< [rad]
  std::optional<double> declination;  ///< [rad]
  std::string declination_source, declination_date;
  std::string datum;
  std::optional<double> datum_elevation;      ///< above mean sea level [m]
  std::string well;                           ///< which, where a file has several
  std::string trajectory;                     ///< which, by name or uid, where a file has several
  std::optional<double> latitude, longitude;  ///< of the well head, on WGS 84 [rad]
  /// Whether commas inside numbers are decimal ones; else as the numbers show it.
  std::optional<bool> decimal_comma;
};

/// Reads a survey, as a stream where the format is text by lines, and holds its positions against
/// its angles: what the file leaves open (units, norths, datum, axes, method) is settled where
/// exactly one reading fits. SurveyHead::notes tells what was settled, repaired or could not be
/// checked. Faults name the file with line or element: kForeign when it is none of the formats,
/// kSyntax, kRange, kOrder when depth goes both ways, kConflict where numbers contradict what the
/// file says or several readings fit, with the option that decides, kSize beyond 2^27 numbers or,
/// for XML, 2^28 bytes.
WELLGYRO_EXPORT Result<SurveyTable> ReadSurvey(const std::filesystem::path& path,
                                               const ReadOptions& options = {});
/// The same of text in memory; `source` names it.
WELLGYRO_EXPORT Result<SurveyTable> ParseSurvey(std::string_view text, const std::string& source,
                                                const ReadOptions& options = {});

/// What single formats leave to the writer.
struct WriteOptions {
  /// CSV: a preamble of "# key: value" lines with what its header cannot say. pandas reads past it
  /// when told, wellpathpy does not.
  bool preamble = false;
  bool variable_step = false;  ///< LAS: step 0 even where the depths are even
};

/// The text of a file. Numbers have as many digits as give them back. Throws std::invalid_argument
/// saying what the format needs and the table lacks, or which number of which row is not finite or
/// by which depth the rows of the path go back; north is never guessed.
WELLGYRO_EXPORT std::string WriteSurvey(const SurveyTable& table, SurveyFormat format,
                                        const WriteOptions& options = {});

/// A survey of ours for exchange: `stations` of `job`, azimuths true, positions in W, with
/// covariances; northing, easting, grid azimuth and scale where `grid` is not null.
WELLGYRO_EXPORT SurveyTable TableOfSurvey(const Job& job, std::span<const Station> stations,
                                          const WellGrid* grid);

/// Metric or field units for MD, TVD, offsets and curvature; grid coordinates keep their own.
/// Throws std::invalid_argument when there is no such unit.
WELLGYRO_EXPORT void SetUnits(SurveyTable& table, LengthUnit unit);

/// Turns every direction of the survey to count from `north`: azimuths, offsets, covariances,
/// biases, closure, the plane of the vertical section and raw records. Throws std::invalid_argument
/// as AzimuthFrom.
WELLGYRO_EXPORT void TurnTo(SurveyTable& table, North north);

/// Sums what the table lacks of TVD, north, east and dogleg severity by minimum curvature, over the
/// rows that belong to the path, to 1e-6 m. The first row must lie at depth zero or have a
/// position: else nothing is done and false given. Throws std::invalid_argument, naming the
/// station, when two of them point opposite ways.
WELLGYRO_EXPORT bool FillPositions(SurveyTable& table);

/// How far positions part from minimum curvature of the listed stations, at most [m]; nothing
/// where there are none to compare. Positions of ours are summed between the stations too.
WELLGYRO_EXPORT std::optional<double> DepartureFromListed(const SurveyTable& table);

/// Sums TVD, north, east and dogleg severity afresh from the listed stations alone, from the first
/// row's own position; map coordinates, latitudes and what follows from positions are taken away.
WELLGYRO_EXPORT void SumAsListed(SurveyTable& table);

/// Closure, its azimuth, TVD below sea level and vertical section, from positions and head.
WELLGYRO_EXPORT void FillDerived(SurveyTable& table);

/// Lengths to 1e-4, angles to 1e-6 deg, the rest to 9 digits, in the units of its head.
WELLGYRO_EXPORT SurveyTable Rounded(const SurveyTable& table);

}  // namespace wellgyro
