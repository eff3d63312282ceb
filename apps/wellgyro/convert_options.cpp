#include "convert_options.h"

#include <stdexcept>

#include "choice.h"

namespace wellgyro::apps {

std::optional<North> NorthOf(const std::string& word) {
  if (word == "true") return North::kTrue;
  if (word == "grid") return North::kGrid;
  if (word == "magnetic") return North::kMagnetic;
  return std::nullopt;
}

std::optional<LengthUnit> LengthOf(const std::string& word) {
  if (word == "m" || word == "metric") return LengthUnit::kMetre;
  if (word == "ft" || word == "field") return LengthUnit::kFoot;
  if (word == "ftUS") return LengthUnit::kUsFoot;
  return std::nullopt;
}

ReadOptions ReadingOf(const ConvertOptions& o) {
  ReadOptions reading;
  if (!o.from.empty()) reading.format = SurveyFormatOf(o.from);
  for (const std::string& pair : o.columns) {
    const std::size_t equals = pair.find('=');
    if (equals == std::string::npos) {
      throw std::invalid_argument("--columns " + pair + ": write NAME=HEADING or NAME=NUMBER");
    }
    reading.columns.emplace_back(pair.substr(0, equals), pair.substr(equals + 1));
  }
  reading.depth_unit = LengthOf(o.depth_unit);
  reading.north = NorthOf(o.azimuth_reference);
  reading.convergence = Radians(o.convergence_deg);
  reading.declination = Radians(o.declination_deg);
  reading.declination_source = o.declination_source;
  reading.declination_date = o.declination_date;
  reading.datum = o.datum;
  reading.datum_elevation = o.datum_elevation_m;
  reading.well = o.well;
  reading.latitude = Radians(o.latitude_deg);
  reading.longitude = Radians(o.longitude_deg);
  reading.trajectory = o.trajectory;
  if (!o.decimal.empty()) reading.decimal_comma = o.decimal == "comma";
  return reading;
}

void AddReading(CLI::App& command, ConvertOptions& o) {
  TakeWord(command.add_option("--from", o.from,
                              "Format of IN, where its first lines do not tell: csv, las, p717, "
                              "witsml, witsml20, witsml21, petrel or compass"),
           {"csv", "las", "p717", "witsml", "witsml20", "witsml21", "petrel", "compass"})
      ->type_name("FORMAT");
  command.add_option("--columns", o.columns, "Columns of a table: MD=1 or INC=Neigung ...")
      ->delimiter(',');
  TakeWord(command.add_option("--depth-unit", o.depth_unit,
                              "Unit of IN's depths; wins over what it says"),
           {"m", "ft", "ftUS"});
  TakeWord(command.add_option("--azimuth-reference", o.azimuth_reference,
                              "North of IN's azimuths; wins over what it says"),
           {"true", "grid", "magnetic"});
  command.add_option("--convergence-deg", o.convergence_deg, "True less grid azimuth")
      ->check(CLI::Range(-180.0, 180.0));
  command.add_option("--latitude-deg", o.latitude_deg, "Of the well head, on WGS 84")
      ->check(CLI::Range(-90.0, 90.0));
  command.add_option("--longitude-deg", o.longitude_deg, "Of the well head, on WGS 84")
      ->check(CLI::Range(-180.0, 360.0));
  command.add_option(
      "--crs", o.crs,
      "Projected system, as EPSG:23031: the convergence at the well's position, by the two "
      "above or IN's own coordinates");
  command.add_option("--declination-deg", o.declination_deg, "True less magnetic azimuth")
      ->check(CLI::Range(-180.0, 180.0));
  command.add_option("--declination-source", o.declination_source, "Its model");
  command.add_option("--declination-date", o.declination_date, "Day it holds for, YYYY-MM-DD");
  command.add_option("--datum", o.datum, "Name of the depth datum, as RT");
  command.add_option("--datum-elevation-m", o.datum_elevation_m, "Above mean sea level")
      ->check(CLI::Range(-12000.0, 12000.0));
  command.add_option("--well", o.well, "Name of the well; which, where IN has several");
  command.add_option("--trajectory", o.trajectory, "Name or uid, where IN has several");
  TakeWord(command.add_option("--decimal", o.decimal,
                              "What a comma inside IN's numbers is, where unclear"),
           {"comma", "point"});
}

void AddWriting(CLI::App& command, ConvertOptions& o) {
  TakeWord(
      command.add_option("--to", o.to, "Format of OUT, where its name does not tell; see below"),
      WrittenFormats())
      ->type_name("FORMAT");
  TakeWord(command.add_option("--units", o.units, "Units of OUT; those of IN unless given"),
           {"metric", "field"});
  TakeWord(command.add_option("--north", o.north,
                              "Turn azimuths, offsets and covariances to this north"),
           {"true", "grid", "magnetic"});
  command.add_option("--section-azimuth-deg", o.section_azimuth_deg, "Plane of vertical section")
      ->check(CLI::Range(-360.0, 360.0));
  command.add_flag("--derived", o.derived, "Add closure, TVD sub-sea and vertical section");
  command.add_flag("--as-it-is", o.keep, "Do not sum positions where IN has none");
  command.add_flag("--as-listed", o.as_listed,
                   "Sum positions afresh from the listed stations alone");
  command.add_flag("--strict", o.strict, "Refuse where OUT cannot hold all that IN says");
  command.add_flag("--preamble", o.preamble, "CSV: lines of '# key: value' before the header");
  command.add_flag("--variable-step", o.variable_step, "LAS: step 0 even where depths are even");
}

}  // namespace wellgyro::apps
