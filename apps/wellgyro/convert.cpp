#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/bus/log_tables.h"
#include "wellgyro/earth/crs.h"
#include "wellgyro/earth/magnetic.h"
#include "wellgyro/io/exchange/exchange.h"
#include "wellgyro/io/exchange/losses.h"
#include "wellgyro/io/exchange/survey_files.h"
#include "wellgyro/io/file_in_pieces.h"
#include "wellgyro/io/sensor/file_kind.h"

#include "commands.h"
#include "convert_options.h"
#include "distinct.h"
#include "on_call.h"
#include "report.h"

namespace wellgyro::apps {
namespace {

/// What the file's ending means where --to does not say it.
std::optional<SurveyFormat> FormatByName(const std::string& name) {
  const std::string ending = std::filesystem::path(name).extension().string();
  if (ending == ".csv") return SurveyFormat::kCsv;
  if (ending == ".las") return SurveyFormat::kLas;
  if (ending == ".p717" || ending == ".p7") return SurveyFormat::kP717;
  if (ending == ".xml") return SurveyFormat::kWitsml1411;
  if (ending == ".dev") return SurveyFormat::kPetrel;
  if (ending == ".txt") return SurveyFormat::kCompass;
  if (ending == ".json") return SurveyFormat::kOsdu;
  if (ending == ".geojson") return SurveyFormat::kGeoJson;
  if (ending == ".kml") return SurveyFormat::kKml;
  if (ending == ".gpkg") return SurveyFormat::kGeoPackage;
  return std::nullopt;
}

void Prepare(SurveyTable& table, const ConvertOptions& o) {
  if (!o.well.empty()) table.head.names.well = o.well;
  if (const auto azimuth = Radians(o.section_azimuth_deg)) table.head.section_azimuth = azimuth;
  if (!o.keep && !FillPositions(table) && table.rows() > 0) {
    Complain(
        fmt::format("{}: note: no positions are summed: the first station, at MD {:.2f} m, has no "
                    "place; give it TVD, north and east, or begin at MD 0",
                    o.in, table.md(0)));
  }
  if (o.as_listed) SumAsListed(table);
  const auto north = NorthOf(o.north);
  const auto unit = LengthOf(o.units);
  // What is computed anew has no more digits than make sense.
  const bool turned = north && (*north != table.head.azimuth.north || *north != table.head.offsets);
  const bool rescaled = unit && *unit != table.head.md_unit;
  if (north) TurnTo(table, *north);
  if (unit) SetUnits(table, *unit);
  if (o.derived) FillDerived(table);
  if (turned || rescaled) table = Rounded(table);
  SayDeparture(table);
}

/// Says what the format cannot hold, in the file too where that may have remarks; true where
/// --strict forbids to write.
bool Loses(SurveyTable& table, SurveyFormat format, const ConvertOptions& o,
           const WriteOptions& writing) {
  const std::vector<std::string> losses = LossesOf(table, format, writing);
  for (const std::string& loss : losses) {
    Complain(fmt::format("{}: {}: {}", o.out, o.strict ? "refused" : "note", loss));
    const std::string remark = "not in this file, " + loss;
    auto& remarks = table.head.remarks;
    if (std::find(remarks.begin(), remarks.end(), remark) == remarks.end()) {
      remarks.push_back(remark);
    }
  }
  return o.strict && !losses.empty();
}

/// An LCM log into tables of samples and of depths, OUT and beside it OUT's stem with .depth.csv.
int ConvertLog(const ConvertOptions& o) {
  const std::filesystem::path out(o.out);
  if (out.extension() != ".csv") {
    return Misused(fmt::format("{} is an LCM log, which becomes CSV: name OUT with .csv", o.in));
  }
  const std::filesystem::path depths = out.parent_path() / (out.stem().string() + ".depth.csv");
  RequireDistinct(std::array{NamedFile{"IN", o.in}, NamedFile{"OUT", depths.string()}});
  FileInPieces sample_file(out), depth_file(depths);
  const Result<LogTables> tables = WriteLogTables(
      o.in, Channels{}, [&](std::string_view lines) { return sample_file.Append(lines); },
      [&](std::string_view lines) { return depth_file.Append(lines); });
  std::optional<Fault> fault = tables ? sample_file.Finish() : tables.fault();
  if (!fault && tables->marks > 0) fault = depth_file.Finish();
  if (fault) return Unusable(*fault);
  for (const Fault& damage : tables->damage) Complain(damage);
  if (tables->left_out > 0) {
    Complain(
        fmt::format("{}: {} samples of other tools or sensors, or damaged messages, are left out",
                    o.in, tables->left_out));
  }
  return tables->left_out > 0 || !tables->damage.empty() ? kDoneWithLosses : kDone;
}

/// From map coordinates in metres, which the system may count in feet.
Result<GeodeticPoint> PlaceOnMap(const std::string& crs, double easting, double northing) {
  const auto place = GeodeticOfCrs(crs, {easting, northing, 0});
  if (!place) return place;
  const auto grid = ProjectToCrs(crs, *place);
  if (!grid) return grid.fault();
  if (grid->unit == 1) return place;
  return GeodeticOfCrs(crs, {easting / grid->unit, northing / grid->unit, 0});
}

/// Where the well is: by the options, or by the first station of IN that has a place.
Result<GeodeticPoint> PlaceOf(const ConvertOptions& o) {
  if (o.latitude_deg && o.longitude_deg) {
    return GeodeticPoint{FromDegrees(*o.latitude_deg), FromDegrees(*o.longitude_deg)};
  }
  const Result<SurveyTable> table = ReadSurvey(o.in, ReadingOf(o));
  if (!table) return table.fault();
  for (std::size_t row = 0; row < table->rows(); ++row) {
    const auto latitude = table->Get(Column::kLatitude, row);
    const auto longitude = table->Get(Column::kLongitude, row);
    if (latitude && longitude) return GeodeticPoint{*latitude, *longitude};
    const auto northing = table->Get(Column::kNorthing, row);
    const auto easting = table->Get(Column::kEasting, row);
    if (northing && easting) return PlaceOnMap(o.crs, *easting, *northing);
  }
  Fault fault;
  fault.source = o.in;
  fault.text = "it has no position for --crs: say --latitude-deg and --longitude-deg";
  return fault;
}

/// The convergence at the well's position, where none is stated; where one is, ours is the check.
std::optional<Fault> FindConvergence(ConvertOptions& o) {
  if (o.crs.empty()) return std::nullopt;
  if (o.crs.find_first_not_of("0123456789") == std::string::npos) o.crs = "EPSG:" + o.crs;
  const auto place = PlaceOf(o);
  if (!place) return place.fault();
  const auto grid = ProjectToCrs(o.crs, *place);
  if (!grid) return grid.fault();
  if (!grid->outside.empty()) {
    Complain(fmt::format("note: the position is outside the area of {}, {}", o.crs, grid->outside));
  }
  const double ours = ToDegrees(grid->point.convergence);
  if (!o.convergence_deg) {
    o.convergence_deg = ours;
    fmt::print(stderr, "note: convergence {:+.6f} deg, from {} at the position\n", ours, o.crs);
  } else if (std::abs(*o.convergence_deg - ours) > 0.01) {
    Complain(fmt::format("the stated convergence, {:+.4f} deg, holds; {} has {:+.4f} deg there",
                         *o.convergence_deg, o.crs, ours));
  }
  return std::nullopt;
}

/// What is wrong with the command line itself, in words.
std::string Mistake(const ConvertOptions& o) {
  if (o.latitude_deg.has_value() != o.longitude_deg.has_value()) {
    return "--latitude-deg and --longitude-deg go together";
  }
  if (o.declination_date.empty()) return {};
  const Result<double> date = DecimalYear(o.declination_date);
  return date ? std::string() : "--declination-date: " + date.fault().text;
}

/// Names what is written beside OUT, which the command line does not.
void SayBeside(std::span<const OutputFile> files, const std::filesystem::path& out) {
  for (const OutputFile& file : files) {
    if (file.name == out.filename()) continue;
    fmt::print("wrote {} too\n", (out.parent_path() / file.name).string());
  }
}

int WriteAs(SurveyFormat format, ConvertOptions& o) {
  const std::filesystem::path out(o.out);
  std::vector<OutputFile> files;
  try {
    Result<SurveyTable> table = ReadSurvey(o.in, ReadingOf(o));
    if (!table) return Unusable(table.fault());
    for (const std::string& note : table->head.notes) Complain(o.in + ": note: " + note);
    Prepare(*table, o);
    const WriteOptions writing{.preamble = o.preamble, .variable_step = o.variable_step};
    if (Loses(*table, format, o, writing)) return kUnusable;
    files = SurveyFiles(*table, format, out.filename().string(), writing);
  } catch (const std::invalid_argument& error) {
    std::string text = error.what();
    if (text.starts_with("AzimuthFrom: ")) {
      text = text.substr(13) + ": say --azimuth-reference, --convergence-deg or --declination-deg";
    }
    return Unusable(fmt::format("{}: {}", o.in, text));
  }
  RequireUnread(std::array{std::filesystem::path(o.in)}, out.parent_path(), files);
  if (const auto fault = WriteFiles(out.parent_path(), files)) return Unusable(*fault);
  SayBeside(files, out);
  return kDone;
}

int Convert(ConvertOptions& o) {
  if (const std::string mistake = Mistake(o); !mistake.empty()) return Misused(mistake);
  if (o.out == "-") {
    Complain("OUT is a file's name; /dev/stdout with --to writes to the terminal or a pipe");
    return kUsage;
  }
  RequireDistinct(std::array{NamedFile{"IN", o.in}, NamedFile{"OUT", o.out}});
  const Result<FileIdentity> identity = IdentifyFile(o.in);
  if (!identity) return Unusable(identity.fault());
  if (identity->kind == FileKind::kLcmLog) return ConvertLog(o);
  const auto format = o.to.empty() ? FormatByName(o.out) : SurveyFormatOf(o.to);
  if (!format) {
    return Misused(fmt::format("{}: the name does not say which format: add --to, with one of {}",
                               o.out, fmt::join(WrittenFormats(), ", ")));
  }
  if (const auto fault = FindConvergence(o)) return Unusable(*fault);
  return WriteAs(*format, o);
}

}  // namespace

void AddConvert(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<ConvertOptions>();
  CLI::App* command = app.add_subcommand(
      "convert", "Between the survey formats; an LCM log to tables of samples and depths");
  command->add_option("in", options->in, "Survey or LCM log to read")->required();
  command->add_option("out", options->out, "File to write")->required();
  AddReading(*command, *options);
  AddWriting(*command, *options);
  command->footer(
      "Formats: csv, las, p717, witsml (1.4.1.1), witsml21, petrel, compass, osdu, geojson, kml,\n"
      "gpkg; by the ending of OUT .csv .las .p717 .xml .dev .txt .json .geojson .kml .gpkg. "
      "WITSML\n"
      "2.0 is read too; osdu, geojson, kml and gpkg are only written.\n\n"
      "Example:\n"
      "  wellgyro convert survey.csv survey.las\n"
      "  wellgyro convert raw.txt well.xml --columns MD[ft]=1,INC=2,AZI=3 \\\n"
      "      --azimuth-reference grid --well A-1\n"
      "  wellgyro convert run.lcm run.csv\n"
      "The last writes run.depth.csv too.");
  OnCall(command, exit_code, [options] { return Convert(*options); });
}

}  // namespace wellgyro::apps
