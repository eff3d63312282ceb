#include "wellgyro/io/toml/error_model_file.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/formats.h"
#include "wellgyro/io/text_file.h"
#include "wellgyro/io/toml/toml_internal.h"
#include "wellgyro/io/toml/toml_writer_internal.h"
#include "wellgyro/io/words.h"

namespace wellgyro {
namespace {

struct Unit {
  Dimension dimension;
  std::string_view name;
  double si;
};

constexpr Unit kUnits[] = {
    {Dimension::kLength, "m", 1},
    {Dimension::kLength, "ft", units::kFoot},
    {Dimension::kRatio, "1", 1},
    {Dimension::kPerLength, "1/m", 1},
    {Dimension::kPerLength, "1/ft", 1 / units::kFoot},
    {Dimension::kAcceleration, "m/s2", 1},
    {Dimension::kAcceleration, "mg", units::kMilliG},
    {Dimension::kAccelerationPerG, "m/s2/g", 1},
    {Dimension::kAngle, "deg", units::kDeg},
    {Dimension::kAngle, "rad", 1},
    {Dimension::kRate, "deg/h", units::kDegPerHour},
    {Dimension::kRatePerG, "deg/h/g", units::kDegPerHour},
    {Dimension::kAngleWalk, "deg/sqrt(h)", units::kDegPerSqrtHour},
    {Dimension::kRateWalk, "deg/h/sqrt(h)", units::kDegPerHourSqrtHour},
    {Dimension::kRateRamp, "deg/h2", units::kDegPerHour2},
    {Dimension::kField, "nT", units::kNanotesla},
    {Dimension::kAngleField, "deg*nT", units::kDeg* units::kNanotesla},
};

const TomlWords<GyroAxes> kAxes = {
    {"xyz", GyroAxes::kXyz}, {"xy", GyroAxes::kXy}, {"z", GyroAxes::kZ}};

std::pair<std::string_view, Propagation> Worded(Propagation reach) {
  return {WordOf(reach), reach};
}

double SiPer(TomlTable& table, const ErrorTerm& term, const std::string& unit) {
  std::vector<std::string_view> fitting;
  for (const Unit& known : kUnits) {
    if (known.dimension != term.weight->dimension) continue;
    if (known.name == unit) return known.si;
    fitting.push_back(known.name);
  }
  table.Refuse("unit", fmt::format("\"{}\" does not fit weight {}, whose magnitude is in {}", unit,
                                   term.weight->code, fmt::join(fitting, " or ")));
}

void ReadRest(TomlTable& table, ErrorTerm& term) {
  const std::string code = table.Need("weight", table.FindString("weight"));
  term.weight = FindWeight(code);
  if (!term.weight) {
    table.Refuse("weight", fmt::format("no weighting function has the code \"{}\"", code));
  }
  const double magnitude = table.Need("magnitude", table.FindNumber("magnitude", kNotNegative));
  const auto unit = table.FindString("unit");
  if (!unit) table.Refuse("magnitude", "stands without its 'unit'");
  term.unit = *unit;
  term.unit_si = SiPer(table, term, *unit);
  term.magnitude = magnitude * term.unit_si;
  term.propagation =
      table.Need("propagation",
                 table.FindWord<Propagation>(
                     "propagation", {Worded(Propagation::kRandom), Worded(Propagation::kSystematic),
                                     Worded(Propagation::kWell), Worded(Propagation::kGlobal)}));
}

/// Every complaint about a term names it.
ErrorTerm ReadTerm(TomlTable& table) {
  ErrorTerm term;
  term.name = table.Need("name", table.FindString("name"));
  const auto foreign = [](unsigned char c) { return c <= ' ' || c == ',' || c == '"' || c >= 127; };
  if (term.name.empty() || std::ranges::any_of(term.name, foreign)) {
    table.Refuse("name", "must be plain characters without blanks, commas and quotes");
  }
  try {
    ReadRest(table, term);
  } catch (TomlError& error) {
    error.fault.text = fmt::format("term {}: {}", term.name, error.fault.text);
    throw;
  }
  return term;
}

std::optional<double> FindDegrees(TomlTable& table, std::string_view key, TomlRange range) {
  const auto degrees = table.FindNumber(key, range);
  return degrees ? std::optional(*degrees * units::kDeg) : std::nullopt;
}

StationaryMode ReadStationary(TomlTable& table) {
  StationaryMode mode;
  mode.axes = table.Need("axes", table.FindWord("axes", kAxes));
  mode.end = table.Need("end_deg", FindDegrees(table, "end_deg", kInclinationDeg));
  mode.initialise = FindDegrees(table, "initialise_deg", {.min = -1, .max = 180});
  mode.min_distance = table.FindNumber("min_distance_m", kNotNegative);
  mode.noise_reduction = table.FindNumber("noise_reduction", kPositive);
  mode.noise_reduction_at_stations =
      table.FindWord<bool>("noise_reduction_at", {{"initialisation", false}, {"every_fix", true}})
          .value_or(false);
  return mode;
}

ContinuousZone ReadZone(TomlTable& table) {
  ContinuousZone zone;
  zone.axes = table.Need("axes", table.FindWord("axes", kAxes));
  zone.begin = table.Need("begin_deg", FindDegrees(table, "begin_deg", kInclinationDeg));
  zone.end = table.Need("end_deg", FindDegrees(table, "end_deg", kInclinationDeg));
  zone.speed = table.Need("speed_m_per_h", table.FindNumber("speed_m_per_h", kPositive));
  zone.speed /= units::kHour;
  return zone;
}

ErrorModel ReadModel(TomlTable& root) {
  ErrorModel model;
  model.name = root.Need("name", root.FindString("name"));
  model.revision = root.Need("revision", root.FindString("revision"));
  model.source = root.Need("source", root.FindString("source"));
  root.Read("description", model.description);
  model.max_inclination =
      root.Need("inclination_max_deg", FindDegrees(root, "inclination_max_deg", kInclinationDeg));
  model.vertical_limit =
      root.Need("vertical_limit_deg", FindDegrees(root, "vertical_limit_deg", kPositive));
  model.doubled_tie_on =
      root.Need("surface_tie_on",
                root.FindWord<bool>("surface_tie_on", {{"doubled", true}, {"single", false}}));
  model.cant = FindDegrees(root, "cant_deg", {.min = -90, .max = 90});
  model.min_course_length = root.FindNumber("min_course_length_m", kPositive);
  if (const auto t = root.FindNumber("tortuosity_deg_per_100ft", kPositive)) {
    model.tortuosity = *t * units::kDegPer100ft;
  }
  if (auto table = root.FindTable("stationary")) model.stationary = ReadStationary(*table);
  for (TomlTable& table : root.FindTables("continuous")) {
    model.continuous.push_back(ReadZone(table));
  }
  std::vector<TomlTable> terms = root.FindTables("term");
  for (TomlTable& table : terms) model.terms.push_back(ReadTerm(table));
  if (const auto complaint = FindComplaint(model)) {
    const TomlTable& at = complaint->term ? terms[*complaint->term] : root;
    at.Refuse("", complaint->text);
  }
  return model;
}

template <class T>
std::string_view WordIn(const TomlWords<T>& words, T value) {
  return std::ranges::find(words, value, [](const auto& word) { return word.second; })->first;
}

void WriteModes(const ErrorModel& model, TomlWriter& out) {
  if (model.stationary) {
    const StationaryMode& mode = *model.stationary;
    out.Table("stationary");
    out.Text("axes", WordIn(kAxes, mode.axes));
    out.Number("end_deg", mode.end / units::kDeg);
    if (mode.initialise) out.Number("initialise_deg", *mode.initialise / units::kDeg);
    if (mode.min_distance) out.Number("min_distance_m", *mode.min_distance);
    if (mode.noise_reduction) out.Number("noise_reduction", *mode.noise_reduction);
    out.Text("noise_reduction_at",
             mode.noise_reduction_at_stations ? "every_fix" : "initialisation");
  }
  for (const ContinuousZone& zone : model.continuous) {
    out.Element("continuous");
    out.Text("axes", WordIn(kAxes, zone.axes));
    out.Number("begin_deg", zone.begin / units::kDeg);
    out.Number("end_deg", zone.end / units::kDeg);
    out.Number("speed_m_per_h", zone.speed * units::kHour);
  }
}

/// In the unit in which it was published; else the first that fits.
void WriteTerm(const ErrorTerm& term, TomlWriter& out) {
  const auto fits = [&](const Unit& unit) {
    return unit.dimension == term.weight->dimension &&
           (term.unit.empty() || unit.name == term.unit);
  };
  auto unit = std::ranges::find_if(kUnits, fits);
  if (unit == std::end(kUnits)) {
    unit = std::ranges::find(kUnits, term.weight->dimension, &Unit::dimension);
  }
  out.Text("name", term.name);
  out.Text("weight", term.weight->code);
  out.Number("magnitude", term.magnitude / unit->si);
  out.Text("unit", unit->name);
  out.Text("propagation", WordOf(term.propagation));
}

}  // namespace

Result<ErrorModel> ReadErrorModel(std::string_view text, const std::string& source) {
  return ReadTomlText<ErrorModel>(text, source, formats::kErrorModel, ReadModel);
}

Result<ErrorModel> ReadErrorModelFile(const std::filesystem::path& path) {
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return text.fault();
  return ReadErrorModel(*text, path.string());
}

Result<std::string> WriteErrorModel(const ErrorModel& model, std::span<const std::string> remarks) {
  TomlWriter out;
  out.Text("format", formats::kErrorModel);
  out.Text("name", model.name);
  out.Text("revision", model.revision);
  out.Text("source", model.source);
  if (!model.description.empty()) out.Text("description", model.description);
  out.Number("inclination_max_deg", model.max_inclination / units::kDeg);
  out.Number("vertical_limit_deg", model.vertical_limit / units::kDeg);
  out.Text("surface_tie_on", model.doubled_tie_on ? "doubled" : "single");
  if (model.cant) out.Number("cant_deg", *model.cant / units::kDeg);
  if (model.min_course_length) out.Number("min_course_length_m", *model.min_course_length);
  if (model.tortuosity) {
    out.Number("tortuosity_deg_per_100ft", *model.tortuosity / units::kDegPer100ft);
  }
  WriteModes(model, out);
  for (std::size_t i = 0; i < model.terms.size(); ++i) {
    if (model.terms[i].formula) {
      return Fault{FaultCode::kRange,
                   "model " + model.name + ": term " + model.terms[i].name +
                       " has a formula of its own, for which wellgyro.error-model/1 has no word"};
    }
    out.Element("term");
    if (i < remarks.size() && !remarks[i].empty()) out.Comment(remarks[i]);
    WriteTerm(model.terms[i], out);
  }
  return out.text();
}

}  // namespace wellgyro
