#include "wellgyro/io/result/uncertainty_files.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/io/exchange/well_stations.h"
#include "wellgyro/io/formats.h"
#include "wellgyro/io/plot/well_plot.h"
#include "wellgyro/io/result/covariance_csv.h"
#include "wellgyro/io/toml/model_catalogue.h"
#include "wellgyro/io/toml/named_file_internal.h"
#include "wellgyro/io/toml/program_file.h"
#include "wellgyro/io/toml/toml_internal.h"
#include "wellgyro/io/toml/toml_writer_internal.h"
#include "wellgyro/uncertainty/ellipse.h"

namespace wellgyro {
namespace {

/// A survey as read, with what its uncertainty rests on.
struct Case {
  SurveyedWell well;
  std::vector<std::unique_ptr<const ErrorModel>> models;
  WellStations place;  ///< without its stations
  UncertaintyBasis basis;
  Eigen::Matrix3d cov_tie_in_W = Eigen::Matrix3d::Zero();
  std::vector<InputFile> inputs;
  std::vector<std::string> notes;
  PositionUncertainty errors;
};

void CheckNorth(const WellStations& table, const std::optional<double>& convergence,
                std::vector<std::string>& notes) {
  if (table.north == North::kGrid && !convergence) {
    throw std::invalid_argument("the survey's azimuths are grid: the convergence is needed");
  }
  if (table.north == North::kTrue && convergence && *convergence != 0) {
    throw std::invalid_argument(
        "the survey's azimuths are true by its header; with a convergence they would be grid");
  }
  if (table.north == North::kUnknown) {
    notes.emplace_back(convergence ? "azimuths taken as grid" : "azimuths taken as true");
  }
  if (!table.depth_unit_stated) notes.emplace_back("the header names no unit of depth: metres");
}

void Place(Case& c, WellStations table) {
  Eigen::Vector3d start(0, 0, 0);
  const double md = table.stations.front().md;
  if (table.start_stated) {
    start = table.start_W;
  } else {
    if (table.offsets) start.head<2>() = *table.offsets;
    start.z() = md;
    if (md != 0) c.notes.emplace_back("no TVD for the first station: taken to be its MD");
  }
  c.well = SurveyWell(std::move(table.stations), start);
  c.place = std::move(table);
}

North Wanted(const UncertaintyRequest& request) {
  return request.convergence ? North::kGrid : North::kTrue;
}

void ReadProgram(Case& c, const std::filesystem::path& path, const UncertaintyRequest& request) {
  Result<SurveyProgram> read = ReadSurveyProgram(path, Wanted(request));
  if (!read) throw TomlError{read.fault()};
  SurveyProgram program = *std::move(read);
  CheckNorth(program.survey, request.convergence, c.notes);
  c.models = std::move(program.models);
  c.basis.legs = std::move(program.legs);
  c.cov_tie_in_W = program.cov_tie_in_W;
  c.inputs = std::move(program.inputs);
  Place(c, std::move(program.survey));
}

/// Of coefficients that a log could not show there is a bound only; what is left out is said.
void NoteUnobserved(std::string_view noise_file, std::vector<std::string>& notes) {
  constexpr std::string_view kBound = "_upper95";
  const toml::table file = toml::parse(noise_file);  // read before: it is sound
  const toml::table* const coefficients = file["coefficients"].as_table();
  if (!coefficients) return;
  for (const auto& [key, node] : *coefficients) {
    const std::string_view name = key.str();
    if (!name.ends_with(kBound) || !node.is_number()) continue;
    notes.push_back(fmt::format("{} was not observed, at most {:g} at 95 %: left out",
                                name.substr(0, name.size() - kBound.size()),
                                *node.value<double>()));
  }
}

/// From a file, which is noted; a name that is neither is refused with those that there are.
Result<ErrorModel> FindModelOf(const std::string& name, NamedFiles& files) {
  const std::string file = name.substr(0, name.find('#'));
  if (!std::filesystem::exists(file)) return FindModel(name);
  return ParseModel(files.Take("model", file), name);
}

void ReadSingle(Case& c, const UncertaintySources& sources, const UncertaintyRequest& request) {
  NamedFiles files{std::filesystem::path()};
  const std::string survey = sources.survey->string();
  Result<WellStations> table =
      ParseWellStations(files.Take("survey", survey), survey, Wanted(request));
  if (!table) throw TomlError{table.fault()};
  CheckNorth(*table, request.convergence, c.notes);
  if (sources.model) {
    const std::string name = sources.model->string();
    std::optional<ErrorModel> own = OwnModel(name);
    Result<ErrorModel> model = own ? Result<ErrorModel>(*std::move(own)) : FindModelOf(name, files);
    if (!model) throw TomlError{model.fault()};
    c.models.push_back(std::make_unique<const ErrorModel>(*std::move(model)));
    c.basis.legs = {{c.models.back().get(), 0, table->stations.size(), 1}};
  }
  if (sources.noise) {
    c.basis.noise = NoiseOfFile(sources.noise->string(), files);
    NoteUnobserved(files.all().back().text, c.notes);
  }
  c.inputs = files.all();
  Place(c, *std::move(table));
}

Case ReadCase(const UncertaintySources& sources, const UncertaintyRequest& request) {
  Case c;
  if (sources.program) {
    if (sources.survey || sources.model || sources.noise) {
      throw std::invalid_argument("a program names surveys and models itself");
    }
    ReadProgram(c, *sources.program, request);
  } else {
    if (!sources.survey) throw std::invalid_argument("a survey or a program is needed");
    if (!sources.model && !sources.noise) {
      throw std::invalid_argument("an error model, the noise of a gyro or a program is needed");
    }
    ReadSingle(c, sources, request);
    c.cov_tie_in_W = request.sigma_tie_in.cwiseAbs2().asDiagonal();
  }
  c.basis.form = request.form;
  c.basis.speed = request.speed;
  c.basis.initialise = request.initialise;
  c.basis.sigma_azimuth = request.sigma_azimuth;
  Surroundings surroundings = request.surroundings;
  surroundings.convergence = request.convergence.value_or(0);
  c.errors = WellUncertainty(c.well, surroundings, c.basis, {c.cov_tie_in_W, request.terms});
  for (const std::string& note : c.errors.notes) c.notes.push_back(note);
  return c;
}

std::string AboutEnd(const Case& c, double confidence) {
  if (c.errors.cov_p_W.empty()) return "no station has a covariance";
  const std::size_t k = c.errors.cov_p_W.size() - 1;
  const Eigen::Matrix3d& cov = c.errors.cov_p_W[k];
  const ErrorEllipse e = HorizontalEllipse(cov, confidence);
  return fmt::format(
      "MD {:.2f} m: {:g} % ellipse {:.2f} x {:.2f} m, azimuth {:.1f} deg; vertical 1 sigma {:.2f} "
      "m",
      c.well.survey[k].md, 100 * confidence, e.semi_major, e.semi_minor, ToDegrees(e.azimuth_major),
      std::sqrt(std::max(0.0, cov(2, 2))));
}

/// Without the last digits that a unit's conversion leaves.
double Tidy(double value) { return std::round(value * 1e9) / 1e9; }
double TidyDegrees(double angle) { return Tidy(ToDegrees(angle)); }

std::string SummaryToml(const UncertaintyRequest& request, const std::vector<InputFile>& inputs,
                        const UncertaintyAnswer& answer, bool allan) {
  TomlWriter toml;
  toml.Text("format", formats::kUncertainty);
  toml.Number("confidence", request.confidence);
  if (allan) toml.Text("allan", request.form == AllanForm::kExact ? "exact" : "printed");
  const Surroundings& place = request.surroundings;
  if (place.latitude) toml.Number("latitude_deg", TidyDegrees(*place.latitude));
  toml.Number("gravity_mps2", place.gravity);
  if (request.convergence) toml.Number("convergence_deg", TidyDegrees(*request.convergence));
  if (place.field) toml.Number("field_nt", Tidy(*place.field / units::kNanotesla));
  if (place.dip) toml.Number("dip_deg", TidyDegrees(*place.dip));
  if (place.declination) toml.Number("declination_deg", TidyDegrees(*place.declination));
  if (!request.sigma_tie_in.isZero(0)) {
    toml.Number("tie_in_sigma_north_m", request.sigma_tie_in.x());
    toml.Number("tie_in_sigma_east_m", request.sigma_tie_in.y());
    toml.Number("tie_in_sigma_tvd_m", request.sigma_tie_in.z());
  }
  if (request.speed) toml.Number("speed_mps", *request.speed);
  if (request.initialise) toml.Number("initialise_deg", TidyDegrees(*request.initialise));
  for (const std::string& note : answer.notes) toml.Element("note"), toml.Text("text", note);
  for (const std::string& why : answer.refusals) toml.Element("refusal"), toml.Text("text", why);
  WriteInputs(toml, inputs);
  return toml.text();
}

/// Where the two wells are closest; nothing where there is no row.
std::optional<Separation> NearestOf(const std::vector<Separation>& separations) {
  const auto nearest = std::ranges::min_element(separations, {}, &Separation::distance);
  if (nearest == separations.end()) return std::nullopt;
  return *nearest;
}

/// A survey that begins down its hole, in no stated place.
bool IsNowhere(const Case& c) {
  return !c.place.start_stated && !c.place.offsets && c.well.survey.front().md != 0;
}

/// Draws the other well on the picture too, where one is asked for.
void AddSeparation(const UncertaintyRequest& request, const Case& c, UncertaintyAnswer& answer,
                   std::vector<InputFile>& inputs, std::optional<SurveyedWell>& beside,
                   WellPlotLabels& labels) {
  UncertaintySources sources = request.sources;
  sources.survey = request.other;
  if (request.other_model) sources.model = request.other_model;
  if (sources.program && !request.other_model) {
    throw std::invalid_argument("beside a program the other survey needs a model of its own");
  }
  sources.program.reset();
  Case other = ReadCase(sources, request);
  if (const auto apart = PlacesContradict(c.place, other.place)) {
    throw std::invalid_argument("the two surveys are " + *apart +
                                ": wellgyro clearance takes the place of each from a policy");
  }
  if (request.pairing == Pairing::kTwoWells && (IsNowhere(c) || IsNowhere(other))) {
    throw std::invalid_argument(
        "one of the surveys does not begin at MD 0 and its file has no place for that: --same-hole "
        "where both are of one hole; else wellgyro clearance takes the place of each from a "
        "policy");
  }
  SeparationRule rule;
  rule.correlation = request.correlation;
  const auto separations =
      Separations(HoleLine({&c.well, &c.errors}), HoleLine({&other.well, &other.errors}),
                  request.pairing, rule);
  answer.files.push_back({"separation.csv", SeparationCsv(separations)});
  if (other.errors.refusal) {
    answer.refusals.push_back("other survey: " + other.errors.refusal->text);
  }
  for (InputFile input : other.inputs) {
    input.role = "other " + input.role;
    inputs.push_back(std::move(input));
  }
  labels.nearest = NearestOf(separations);
  labels.other_name = request.other->filename().string();
  beside = std::move(other.well);
  labels.other = &*beside;
}

/// What the picture says of the well: its file, its tools, north, datum.
WellPlotLabels LabelsOf(const UncertaintyRequest& request, const Case& c) {
  const UncertaintySources& sources = request.sources;
  WellPlotLabels labels;
  labels.title = (sources.program ? sources.program : sources.survey)->filename().string();
  std::string tools;
  for (const auto& model : c.models) tools += (tools.empty() ? "" : ", ") + model->name;
  if (c.basis.noise) {
    tools += (tools.empty() ? "" : ", ") + ("noise of " + sources.noise->filename().string());
  }
  labels.facts = {
      "tool: " + tools,
      fmt::format("azimuths from {} north; metres, TVD from the survey's own depth datum",
                  request.convergence ? "grid" : "true")};
  return labels;
}

UncertaintyAnswer Answer(const UncertaintyRequest& request) {
  const Case c = ReadCase(request.sources, request);
  UncertaintyAnswer answer;
  std::vector<InputFile> inputs = c.inputs;
  answer.notes = c.notes;
  if (c.errors.refusal) answer.refusals.push_back(c.errors.refusal->text);
  answer.files.push_back({"covariance.csv", CovarianceCsv(c.well, c.errors, request.confidence)});
  if (request.terms) answer.files.push_back({"terms.csv", TermsCsv(c.well, c.errors)});
  WellPlotLabels labels = LabelsOf(request, c);
  std::optional<SurveyedWell> beside;
  if (request.other) AddSeparation(request, c, answer, inputs, beside, labels);
  answer.inputs = PathsOf(inputs);
  for (const auto& path : {request.sources.program, request.other}) {
    if (path) answer.inputs.push_back(*path);
  }
  if (request.plot) {
    answer.files.push_back(
        {"uncertainty.svg", WellPlotSvg(c.well, c.errors, request.confidence, labels)});
  }
  answer.summary = AboutEnd(c, request.confidence);
  answer.files.push_back(
      {"uncertainty.toml", SummaryToml(request, inputs, answer, c.basis.noise.has_value())});
  return answer;
}

}  // namespace

Result<UncertaintyAnswer> AnswerUncertainty(const UncertaintyRequest& request) {
  try {
    return Answer(request);
  } catch (const TomlError& error) {
    return error.fault;
  }
}

}  // namespace wellgyro
