#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include <yaml-cpp/yaml.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/exchange/model_files.h"
#include "wellgyro/io/exchange/model_terms_internal.h"

namespace wellgyro {
namespace {

constexpr std::size_t kYamlBytes = 1 << 20;  // bytes

std::string Text(const YAML::Node& map, const char* key) {
  const YAML::Node node = map[key];
  return node && node.IsScalar() ? node.Scalar() : std::string();
}

/// The number that a text begins with: "180 deg", "10 m".
std::optional<double> Leading(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
  return value;
}

ErrorTerm Term(const std::string& name, const YAML::Node& node, const std::string& source) {
  if (!node.IsMap()) RefuseModel(source, "term " + name + " is no table");
  std::string code = Text(node, "function");
  std::ranges::replace(code, '_', '-');
  if (code == "XCL") code = name;  // of both course length terms
  if (code == "XYM3L") code = "XYM3E";
  if (code == "XYM4L") code = "XYM4E";
  ErrorTerm term;
  term.name = name;
  term.weight = FindWeight(code);
  if (!term.weight) {
    RefuseModel(source, "term " + name + ": no weighting function has the code " + code);
  }
  const auto propagation = ModelPropagation(Text(node, "propagation"));
  if (!propagation) RefuseModel(source, "term " + name + ": its propagation is not known");
  const auto si = ModelUnit(Text(node, "unit"));
  const auto magnitude = Leading(Text(node, "magnitude"));
  if (!si || !magnitude) RefuseModel(source, "term " + name + ": its magnitude or unit is none");
  term.magnitude = std::abs(*magnitude) * *si;
  term.unit = Text(node, "unit");
  term.unit_si = *si;
  term.propagation = *propagation;
  return term;
}

ErrorModel Read(const YAML::Node& root, const std::string& source) {
  if (!root.IsMap() || !root["codes"] || !root["codes"].IsMap()) {
    RefuseModel(source, "has no table of codes");
  }
  const YAML::Node header = root["header"];
  ErrorModel model;
  if (header && header.IsMap()) {
    model.name = Text(header, "Short Name");
    model.revision = Text(header, "Revision No");
    model.description = Text(header, "Long Name");
    model.source = Text(header, "Source");
    if (const auto most = Leading(Text(header, "Inclination Range Max"))) {
      model.max_inclination = *most * units::kDeg;
    }
    model.min_course_length = Leading(Text(header, "Misalignment Min Course Length"));
    model.tortuosity = Leading(Text(header, "Default Tortusity (rad/m)"));
  }
  if (model.name.empty()) model.name = source;
  model.doubled_tie_on = model.name.find("Rev4") == std::string::npos;
  if (root["codes"].size() > kMostTerms) RefuseModel(source, "has more than 1000 terms");
  for (const auto& entry : root["codes"]) {
    model.terms.push_back(Term(entry.first.Scalar(), entry.second, source));
  }
  FinishModel(model, source);
  return model;
}

}  // namespace

Result<ErrorModel> ParseModelYaml(std::string_view text, const std::string& source) {
  try {
    if (text.size() > kYamlBytes) RefuseModel(source, "is larger than 1 MiB");
    return Read(YAML::Load(std::string(text)), source);
  } catch (const ModelError& error) {
    return error.fault;
  } catch (const YAML::Exception& error) {
    Fault fault;
    fault.code = FaultCode::kSyntax;
    fault.source = source;
    fault.line = error.mark.line + 1;
    fault.text = "is not YAML: " + error.msg;
    return fault;
  }
}

}  // namespace wellgyro
