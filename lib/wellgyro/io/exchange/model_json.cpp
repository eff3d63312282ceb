#include <algorithm>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/io/exchange/model_files.h"
#include "wellgyro/io/exchange/model_terms_internal.h"

namespace wellgyro {
namespace {

using nlohmann::json;

constexpr std::size_t kJsonBytes = 1 << 22;  // bytes

class JsonModel {
 public:
  JsonModel(const json& root, std::string source, const std::vector<ErrorModel>& elsewhere)
      : root_(root), source_(std::move(source)), elsewhere_(elsewhere) {}

  ErrorModel Read();

 private:
  std::string Text(const json& object, const char* key) const;
  double Number(const json& object, const char* key) const;
  std::optional<double> Parameter(const char* key) const;
  ErrorTerm Term(const json& term);
  ErrorTerm Weighted(const json& term) const;
  ErrorTerm Published(const std::string& name, const std::string& code, double value,
                      Propagation propagation) const;
  void AddMode();
  void AddContinuous(GyroAxes axes, const char* speed_key);
  const ErrorModel* Sheet() const;

  const json& root_;
  std::string source_;
  const std::vector<ErrorModel>& elsewhere_;
  ErrorModel model_;
};

std::string JsonModel::Text(const json& object, const char* key) const {
  const auto found = object.find(key);
  if (found == object.end() || found->is_null()) return {};
  if (found->is_string()) return found->get<std::string>();
  if (found->is_number()) return found->dump();
  RefuseModel(source_, std::string("'") + key + "' is neither text nor a number");
}

double JsonModel::Number(const json& object, const char* key) const {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number()) {
    RefuseModel(source_, std::string("'") + key + "' is not a number");
  }
  return found->get<double>();
}

std::optional<double> JsonModel::Parameter(const char* key) const {
  const auto parameters = root_.find("parameters");
  if (parameters == root_.end() || !parameters->is_object() || !parameters->contains(key)) {
    return std::nullopt;
  }
  return Number(*parameters, key);
}

ErrorTerm JsonModel::Published(const std::string& name, const std::string& code, double value,
                               Propagation propagation) const {
  ErrorTerm term;
  term.name = name;
  term.weight = FindWeight(code);
  term.magnitude = std::abs(value);
  term.propagation = propagation;
  return term;
}

ErrorTerm JsonModel::Term(const json& term) {
  ErrorTerm made = Weighted(term);
  made.unit = Text(term, "units");
  made.unit_si = *ModelUnit(made.unit);
  return made;
}

ErrorTerm JsonModel::Weighted(const json& term) const {
  if (!term.is_object()) RefuseModel(source_, "a term is no object");
  const std::string name = Text(term, "name");
  if (name.empty()) RefuseModel(source_, "a term has no name");
  const std::string unit = Text(term, "units"), mode = Text(term, "propagation_mode");
  if (unit.empty()) RefuseModel(source_, "term " + name + " lacks 'units'");
  const auto si = ModelUnit(unit);
  if (!si) RefuseModel(source_, "term " + name + ": the unit '" + unit + "' is not known");
  const auto propagation = ModelPropagation(mode);
  if (!propagation) RefuseModel(source_, "term " + name + ": no propagation is called " + mode);
  const double value = Number(term, "value") * *si;
  const std::string code = Text(term, "x_owsg_weight_function");
  for (const std::string& known : {code, name}) {
    if (IsStateful(known)) return Published(name, known, value, *propagation);
  }
  // A misspelt key would make the term weigh nothing without a word.
  const auto needed = [&](const char* key) {
    std::string formula = Text(term, key);
    if (!formula.empty()) return formula;
    RefuseModel(source_, "term " + name + " lacks '" + key + "': write \"0\" where it has none");
  };
  FormulaTexts texts;
  texts.md = needed("depth_formula");
  texts.inclination = needed("inclination_formula");
  texts.azimuth = needed("azimuth_formula");
  texts.north = Text(term, "north_singularity");
  texts.east = Text(term, "east_singularity");
  texts.vertical = Text(term, "vertical_singularity");
  return FormulaTerm(name, value, *propagation, texts, source_);
}

const ErrorModel* JsonModel::Sheet() const {
  std::string name = model_.name;
  if (name.ends_with("_Fl")) name.resize(name.size() - 3);
  const auto found = std::ranges::find(elsewhere_, name, &ErrorModel::name);
  return found == elsewhere_.end() ? nullptr : &*found;
}

void JsonModel::AddContinuous(GyroAxes axes, const char* speed_key) {
  ContinuousZone zone;
  zone.axes = axes;
  zone.end = model_.max_inclination;
  if (model_.stationary) zone.begin = *model_.stationary->initialise;
  if (const auto speed = Parameter(speed_key)) {
    zone.speed = *speed / 3600;
  } else if (const ErrorModel* sheet = Sheet(); sheet && !sheet->continuous.empty()) {
    zone = sheet->continuous.front();
    model_.notes.push_back(std::string("the file lacks ") + speed_key +
                           ": taken from the published sheet of " + sheet->name);
  } else {
    RefuseModel(source_, std::string("a continuous gyro needs the parameter ") + speed_key);
  }
  model_.continuous.push_back(zone);
}

void JsonModel::AddMode() {
  const auto has = [&](auto test) {
    return std::ranges::any_of(model_.terms, [&](const ErrorTerm& t) { return test(*t.weight); });
  };
  const auto at_rest = [](const WeightFunction& w) {
    return w.role == WeightRole::kStationary || w.role == WeightRole::kStationaryNoise;
  };
  const auto integrated = [](GyroAxes axes) {
    return [axes](const WeightFunction& w) {
      return (w.role == WeightRole::kDrift || w.role == WeightRole::kWalk) && w.axes == axes;
    };
  };
  const bool xy = has(integrated(GyroAxes::kXy)), z = has(integrated(GyroAxes::kZ));
  if (has(at_rest)) {
    StationaryMode mode;
    mode.axes = has([&](const auto& w) { return at_rest(w) && w.axes == GyroAxes::kXyz; })
                    ? GyroAxes::kXyz
                    : GyroAxes::kXy;
    mode.end = std::min(Parameter("xy_static_gyro_end_inc").value_or(kPi), kPi);
    mode.noise_reduction = Parameter("noise_reduction_factor").value_or(1);
    mode.noise_reduction_at_stations = true;
    if (xy) mode.initialise = mode.end;
    if (const auto distance = Parameter("min_dist_between_initialisations")) {
      mode.min_distance = *distance;
    }
    model_.stationary = mode;
  }
  if (z) AddContinuous(GyroAxes::kZ, "gz_running_speed");
  if (xy) AddContinuous(GyroAxes::kXy, "gxy_running_speed");
}

ErrorModel JsonModel::Read() {
  if (!root_.is_object()) RefuseModel(source_, "is no JSON object");
  const json metadata = root_.value("metadata", json::object());
  if (!metadata.is_object()) RefuseModel(source_, "'metadata' is no object");
  model_.name = Text(metadata, "short_name");
  if (model_.name.empty()) model_.name = Text(metadata, "model_id");
  if (model_.name.empty()) model_.name = source_;
  model_.revision = Text(metadata, "revision_number");
  model_.description = Text(metadata, "long_name");
  model_.source = Text(metadata, "source");
  const std::string framework = Text(metadata, "framework");
  model_.doubled_tie_on = framework.find("Rev4") == std::string::npos;
  model_.max_inclination = Parameter("inc_max").value_or(180) * units::kDeg;
  model_.tortuosity = Parameter("XCLTortuosity");
  const auto terms = root_.find("terms");
  if (terms == root_.end() || !terms->is_array()) RefuseModel(source_, "has no list of terms");
  if (terms->size() > kMostTerms) RefuseModel(source_, "has more than 1000 terms");
  for (const json& term : *terms) model_.terms.push_back(Term(term));
  AddMode();
  FinishModel(model_, source_);
  return std::move(model_);
}

}  // namespace

Result<ErrorModel> ParseModelJson(std::string_view text, const std::string& source,
                                  const std::vector<ErrorModel>& elsewhere) {
  try {
    if (text.size() > kJsonBytes) RefuseModel(source, "is larger than 4 MiB");
    const json root = json::parse(text, nullptr, true, true);
    return JsonModel(root, source, elsewhere).Read();
  } catch (const ModelError& error) {
    return error.fault;
  } catch (const json::exception& error) {
    Fault fault;
    fault.code = FaultCode::kSyntax;
    fault.source = source;
    const std::string what = error.what();  // "[json.exception.parse_error.101] parse error at ..."
    const std::size_t bracket = what.find("] ");
    fault.text = "is not JSON: " + what.substr(bracket == what.npos ? 0 : bracket + 2);
    return fault;
  }
}

}  // namespace wellgyro
