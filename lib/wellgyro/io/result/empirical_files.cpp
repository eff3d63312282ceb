#include "wellgyro/io/result/empirical_files.h"

#include <string>
#include <string_view>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/toml/error_model_file.h"
#include "wellgyro/io/words.h"

namespace wellgyro {
namespace {

struct InUnit {
  std::string name;
  double si = 1;
};

InUnit UnitOf(const ErrorTerm& term) {
  if (term.unit.empty()) return {"SI", 1};
  return {term.unit, term.unit_si};
}

std::string Quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + '"';
}

std::string Remark(const TermEstimate& e, const InUnit& unit) {
  if (!e.kept.empty()) return "as assumed: " + e.kept;
  const std::string upper =
      e.upper ? fmt::format("to {:.4g}", *e.upper / unit.si) : std::string("without upper bound");
  return fmt::format("assumed {:.6g}; 95 % interval {:.4g} {} {}", e.assumed / unit.si,
                     e.lower / unit.si, upper, unit.name);
}

std::string Row(const TermEstimate& e, std::string_view weight, std::string_view reach,
                const InUnit& unit) {
  std::string row = fmt::format("{},{},{},{},{:.9g},{:.9g},", e.term, weight, reach, unit.name,
                                e.assumed / unit.si, e.magnitude / unit.si);
  if (e.kept.empty()) row += fmt::format("{:.9g}", e.lower / unit.si);
  row += ',';
  if (e.upper) row += fmt::format("{:.9g}", *e.upper / unit.si);
  return row + ',' + (e.kept.empty() ? std::string() : Quoted(e.kept)) + '\n';
}

std::string Estimates(const EmpiricalModel& made) {
  std::string csv = "TERM,WEIGHT,PROPAGATION,UNIT,ASSUMED,MAGNITUDE,LOWER95,UPPER95,KEPT\n";
  for (std::size_t j = 0; j < made.terms.size(); ++j) {
    const ErrorTerm& term = made.model.terms[j];
    csv += Row(made.terms[j], term.weight->code, WordOf(term.propagation), UnitOf(term));
  }
  TermEstimate local = made.local;
  local.term = "LOCAL";
  return csv + Row(local, "", "random", {"deg", units::kDeg});
}

std::string Holes(const EmpiricalModel& made) {
  std::string csv = "HOLE,SURVEYS,PLACES,FREEDOM,CHI_SQUARE\n";
  for (const HoleFit& hole : made.holes) {
    csv += fmt::format("{},{},{},{:.0f},{:.6g}\n", Quoted(hole.name), hole.surveys, hole.places,
                       hole.freedom, hole.chi_square);
  }
  return csv;
}

}  // namespace

Result<std::vector<OutputFile>> EmpiricalFiles(const EmpiricalModel& made) {
  std::vector<std::string> remarks;
  for (std::size_t j = 0; j < made.terms.size(); ++j) {
    remarks.push_back(Remark(made.terms[j], UnitOf(made.model.terms[j])));
  }
  Result<std::string> model = WriteErrorModel(made.model, remarks);
  if (!model) return model.fault();
  return std::vector<OutputFile>{{"model.toml", *std::move(model)},
                                 {"estimates.csv", Estimates(made)},
                                 {"holes.csv", Holes(made)}};
}

}  // namespace wellgyro
