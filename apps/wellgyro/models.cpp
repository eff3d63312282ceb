#include <algorithm>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/toml/model_catalogue.h"
#include "wellgyro/io/words.h"

#include "commands.h"
#include "report.h"

namespace wellgyro::apps {
namespace {

struct ModelsOptions {
  std::string name;
};

void PrintList() {
  for (const ErrorModel& model : OwnModels()) {
    fmt::print("{:<22} rev {:<8} up to {:g} deg  {}\n", model.name, model.revision,
               ToDegrees(model.max_inclination), model.source);
  }
  fmt::print("each also as NAME_Fl, on a floating rig; 'wellgyro models NAME' says more\n");
}

void PrintModel(const ErrorModel& model) {
  fmt::print("{}\nrevision {}\nsource {}\n", model.name, model.revision, model.source);
  if (!model.description.empty()) fmt::print("description {}\n", model.description);
  fmt::print("inclination up to {:g} deg\n", ToDegrees(model.max_inclination));
  for (const std::string& note : model.notes) fmt::print("note: {}\n", note);
  fmt::print("  {:<14} {:<12} {:<12} {}\n", "term", "weight", "propagation", "1 sigma");
  for (const ErrorTerm& term : model.terms) {
    const std::string unit = term.unit.empty() ? "(SI)" : term.unit == "1" ? "-" : term.unit;
    fmt::print("  {:<14} {:<12} {:<12} {:g} {}\n", term.name,
               term.formula ? "formula" : std::string(term.weight->code), WordOf(term.propagation),
               term.magnitude / term.unit_si, unit);
  }
}

int RunModels(const ModelsOptions& o) {
  if (o.name.empty()) {
    PrintList();
    return kDone;
  }
  const Result<ErrorModel> model = FindModel(o.name);
  if (!model) return Unusable(model.fault());
  PrintModel(*model);
  return kDone;
}

}  // namespace

void AddModels(CLI::App& app, int& exit_code) {
  CLI::App* const command =
      app.add_subcommand("models", "Lists the error models there are, or says what one holds");
  const auto options = std::make_shared<ModelsOptions>();
  command->add_option("name", options->name,
                      "a model's name, or a file: .toml, .json (ISCWSA, OWSG), .yaml (welleng), "
                      ".ipm (Compass), export.xml#TOOL (EDM)");
  command->footer(
      "Examples:\n  wellgyro models\n  wellgyro models GYRO-NS-CT_Fl\n"
      "  wellgyro models MWD+IFR1+MS.json");
  command->callback([options, &exit_code] { exit_code = RunModels(*options); });
}

}  // namespace wellgyro::apps
