#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/exchange/exchange.h"
#include "wellgyro/io/exchange/losses.h"
#include "wellgyro/io/exchange/survey_files.h"
#include "wellgyro/io/result/allan_answer.h"

#include "binding.h"

namespace wellgyro::python {
namespace {

std::optional<North> NorthOf(const std::string& argument, const std::string& word) {
  if (word.empty()) return std::nullopt;
  if (word == "true") return North::kTrue;
  if (word == "grid") return North::kGrid;
  if (word == "magnetic") return North::kMagnetic;
  throw std::invalid_argument(argument + ": true, grid or magnetic is expected, not " + word);
}

std::optional<LengthUnit> LengthOf(const std::string& word) {
  if (word.empty()) return std::nullopt;
  if (word == "m") return LengthUnit::kMetre;
  if (word == "ft") return LengthUnit::kFoot;
  if (word == "ftUS") return LengthUnit::kUsFoot;
  throw std::invalid_argument("depth_unit: m, ft or ftUS is expected, not " + word);
}

SurveyFormat FormatOf(const std::string& word) {
  const auto format = SurveyFormatOf(word);
  if (!format) {
    throw std::invalid_argument(
        "format: csv, las, p717, witsml, witsml21, petrel, compass, osdu, geojson, kml or gpkg is "
        "expected, not " +
        word);
  }
  return *format;
}

/// A survey file as CSV with a preamble, which has every digit, and the notes of its reading.
nb::tuple ReadAsCsv(const std::string& path, const std::string& format,
                    const std::vector<std::pair<std::string, std::string>>& columns,
                    const std::string& depth_unit, const std::string& north,
                    std::optional<double> convergence_deg, std::optional<double> declination_deg,
                    const std::string& well) {
  std::string text;
  std::vector<std::string> notes;
  {
    const nb::gil_scoped_release released;
    ReadOptions options;
    if (!format.empty()) options.format = FormatOf(format);
    options.columns = columns;
    options.depth_unit = LengthOf(depth_unit);
    options.north = NorthOf("north", north);
    if (convergence_deg) options.convergence = FromDegrees(*convergence_deg);
    if (declination_deg) options.declination = FromDegrees(*declination_deg);
    options.well = well;
    SurveyTable table = Taken(ReadSurvey(path, options));
    FillPositions(table);
    SetUnits(table, LengthUnit::kMetre);
    notes = table.head.notes;
    text = WriteSurvey(table, SurveyFormat::kCsv, {.preamble = true});
  }
  return nb::make_tuple(text, notes);
}

/// CSV text as files of another format, and what that cannot hold.
nb::tuple FilesOfCsv(const std::string& text, const std::string& format, const std::string& name) {
  nb::dict files;
  std::vector<OutputFile> made;
  std::vector<std::string> losses;
  {
    const nb::gil_scoped_release released;
    const SurveyTable table = Taken(ParseSurvey(text, "the table"));
    const SurveyFormat to = FormatOf(format);
    losses = LossesOf(table, to);
    made = SurveyFiles(table, to, name);
  }
  for (const OutputFile& file : made) {
    files[file.name.c_str()] = nb::bytes(file.bytes.data(), file.bytes.size());
  }
  return nb::make_tuple(files, losses);
}

nb::dict AllanOf(const Input<double, 1>& values, double rate_hz, const std::string& unit,
                 double scale, const std::string& deviation, const std::vector<double>& taus,
                 bool fit) {
  AllanAnswer answer;
  {
    const nb::gil_scoped_release released;
    AllanRequest request;
    if (deviation == "adev") {
      request.deviation = Deviation::kAllan;
    } else if (deviation == "mdev") {
      request.deviation = Deviation::kModified;
    } else if (deviation != "oadev") {
      throw std::invalid_argument("deviation: adev, oadev or mdev is expected, not " + deviation);
    }
    const std::vector<std::string> units = AllanUnits();
    if (!unit.empty() && std::find(units.begin(), units.end(), unit) == units.end()) {
      throw std::invalid_argument(
          fmt::format("unit: one of {} is expected, not {}", fmt::join(units, ", "), unit));
    }
    request.unit = unit;
    request.scale = scale;
    request.unitless = !fit;
    request.source = "array";
    if (!taus.empty()) {
      request.taus = AllanRequest::Taus::kList;
      request.tau_list = taus;
    }
    SampleSeries series;
    series.values.assign(values.data(), values.data() + values.size());
    series.period = 1 / rate_hz;
    answer = Taken(AnswerAllan(std::move(series), request));
  }
  nb::dict all;
  all["table"] = answer.table;
  all["noise"] = answer.noise ? nb::object(nb::cast(*answer.noise)) : nb::none();
  all["summary"] = answer.summary;
  all["notes"] = answer.notes;
  all["unfit"] = answer.unfit ? nb::object(nb::cast(answer.unfit->text)) : nb::none();
  return all;
}

}  // namespace

void AddFiles(nb::module_& m) {
  m.def("read_as_csv", &ReadAsCsv, nb::arg("path"), nb::arg("format"), nb::arg("columns"),
        nb::arg("depth_unit"), nb::arg("north"), nb::arg("convergence_deg").none(),
        nb::arg("declination_deg").none(), nb::arg("well"));
  m.def("files_of_csv", &FilesOfCsv);
  m.def("allan", &AllanOf, nb::arg("values").noconvert(), nb::arg("rate_hz"), nb::arg("unit"),
        nb::arg("scale"), nb::arg("deviation"), nb::arg("taus"), nb::arg("fit"));
}

}  // namespace wellgyro::python
