#include "wellgyro/io/toml/model_catalogue.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <utility>

#include "wellgyro/io/exchange/model_files.h"
#include "wellgyro/io/sha256.h"
#include "wellgyro/io/toml/error_model_file.h"
#include "wellgyro/io/toml/own_models_internal.h"

namespace wellgyro {
namespace {

constexpr std::string_view kFloating = "_Fl";

std::string EndingOf(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  for (char& c : ending) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return ending;
}

const ErrorModel* Own(std::string_view name) {
  const auto& all = OwnModels();
  const auto found = std::ranges::find(all, name, &ErrorModel::name);
  return found == all.end() ? nullptr : &*found;
}

std::string KnownNames() {
  std::string names;
  for (const ErrorModel& model : OwnModels()) {
    names += (names.empty() ? "" : ", ") + model.name;
  }
  return names;
}

}  // namespace

const std::vector<ErrorModel>& OwnModels() {
  static const std::vector<ErrorModel> models = [] {
    std::vector<ErrorModel> all;
    for (const OwnModelText& own : OwnModelTexts()) {
      Result<ErrorModel> model = ReadErrorModel(own.text, std::string(own.file));
      if (model) all.push_back(*std::move(model));
    }
    std::ranges::sort(all, {}, &ErrorModel::name);
    return all;
  }();
  return models;
}

ErrorModel OnFloatingRig(const ErrorModel& model) {
  ErrorModel floating = model;
  floating.name += kFloating;
  if (!floating.description.empty()) floating.description += " [Floating Rig]";
  std::erase_if(floating.terms, [](const ErrorTerm& term) {
    return term.name == "DRFR" || term.name == "DRFS" || term.weight == FindWeight("DREF");
  });
  ErrorTerm random{"DRFR", FindWeight("DREF"), 2.2, Propagation::kRandom, nullptr, "m"};
  ErrorTerm run{"DRFS", FindWeight("DREF"), 1.0, Propagation::kSystematic, nullptr, "m"};
  floating.terms.insert(floating.terms.begin(), {random, run});
  floating.notes.emplace_back("depth reference of a floating rig: 2.2 m random, 1.0 m systematic");
  return floating;
}

Result<ErrorModel> ParseModel(std::string_view text, const std::string& path) {
  const std::size_t hash = path.find('#');
  const std::string file = path.substr(0, hash);
  const std::string ending = EndingOf(file);
  if (ending == ".json" || ending == ".jsonc") return ParseModelJson(text, file, OwnModels());
  if (ending == ".yaml" || ending == ".yml") return ParseModelYaml(text, file);
  if (ending == ".ipm") return ParseModelIpm(text, file);
  if (ending == ".xml") {
    return ParseModelEdm(text, file, hash == std::string::npos ? "" : path.substr(hash + 1));
  }
  Result<ErrorModel> model = ReadErrorModel(text, file);
  if (model || ending == ".toml") return model;
  Fault fault = model.fault();
  fault.text =
      "no error model: those are wellgyro's .toml, the ISCWSA's .json, welleng's .yaml, "
      "Compass .ipm or an EDM export .xml";
  fault.line = fault.column = 0;
  return fault;
}

std::optional<ErrorModel> OwnModel(const std::string& name) {
  if (const ErrorModel* own = Own(name)) return *own;
  if (!name.ends_with(kFloating)) return std::nullopt;
  const std::string_view fixed = std::string_view(name).substr(0, name.size() - kFloating.size());
  const ErrorModel* const own = Own(fixed);
  return own ? std::optional(OnFloatingRig(*own)) : std::nullopt;
}

Result<ErrorModel> FindModel(const std::string& name, InputFile* input) {
  if (auto own = OwnModel(name)) {
    if (input) *input = {"model", name, {}, {}, {}};
    return *std::move(own);
  }
  const std::string file = name.substr(0, name.find('#'));
  constexpr std::string_view kEndings[] = {".toml", ".json", ".jsonc", ".yaml",
                                           ".yml",  ".ipm",  ".xml"};
  const bool is_file = std::ranges::find(kEndings, EndingOf(file)) != std::end(kEndings);
  if (!std::filesystem::exists(file) && !is_file) {
    Fault fault;
    fault.code = FaultCode::kRange;
    fault.source = name;
    fault.text = "no error model has this name, and no file; there are " + KnownNames() +
                 ", each also with _Fl for a floating rig";
    return fault;
  }
  const Result<std::string> text = ReadTextFile(file);
  if (!text) return text.fault();
  if (input) *input = {"model", name, file, Sha256Hex(*text), {}};
  return ParseModel(*text, name);
}

}  // namespace wellgyro
