#include "wellgyro/io/exchange/model_terms_internal.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"

namespace wellgyro {
namespace {

constexpr double kMinCourse = 10;                 // [m], Definition 5.1.2
constexpr double kVertical = 1e-4 * units::kDeg;  // what rounding of listings leaves of 0

}  // namespace

void RefuseModel(const std::string& source, const std::string& text, int line) {
  Fault fault;
  fault.code = FaultCode::kRange;
  fault.text = text;
  fault.source = source;
  fault.line = line;
  throw ModelError{std::move(fault)};
}

std::optional<double> ModelUnit(std::string_view unit) {
  constexpr double kPerHour = units::kDegPerHour;
  const std::pair<std::string_view, double> known[] = {{"m", 1},
                                                       {"ft", units::kFoot},
                                                       {"1/m", 1},
                                                       {"im", 1},
                                                       {"1/ft", 1 / units::kFoot},
                                                       {"m/s2", 1},
                                                       {"rad", 1},
                                                       {"deg", units::kDeg},
                                                       {"d", units::kDeg},
                                                       {"nT", units::kNanotesla},
                                                       {"nt", units::kNanotesla},
                                                       {"deg.nT", units::kDeg * units::kNanotesla},
                                                       {"rad.nT", units::kNanotesla},
                                                       {"dnt", units::kDeg * units::kNanotesla},
                                                       {"deg/hr", kPerHour},
                                                       {"deg/h", kPerHour},
                                                       {"dph", kPerHour},
                                                       {"deg/sqr(hr)", units::kDegPerSqrtHour},
                                                       {"-", 1},
                                                       {"", 1}};
  for (const auto& [name, si] : known) {
    if (name == unit) return si;
  }
  return std::nullopt;
}

std::optional<Propagation> ModelPropagation(std::string_view word) {
  std::string lower(word);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) {
    return static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  });
  if (lower == "random" || lower == "r") return Propagation::kRandom;
  if (lower == "systematic" || lower == "s") return Propagation::kSystematic;
  if (lower == "well" || lower == "w" || lower == "within_pad") return Propagation::kWell;
  if (lower == "global" || lower == "g") return Propagation::kGlobal;
  return std::nullopt;
}

bool IsStateful(std::string_view code) {
  if (code == "XYM3" || code == "XYM4") return true;  // towards true north and east
  const WeightFunction* const weight = FindWeight(code);
  if (!weight) return false;
  switch (weight->role) {
    case WeightRole::kShortCourse:
    case WeightRole::kCourse:
    case WeightRole::kStationary:
    case WeightRole::kStationaryNoise:
    case WeightRole::kDrift:
    case WeightRole::kWalk:
    case WeightRole::kRateWalk:
    case WeightRole::kRamp:
    case WeightRole::kExternal:
    case WeightRole::kExternalAtTie:
      return true;
    default:
      return false;
  }
}

void FinishModel(ErrorModel& model, const std::string& source) {
  if (!model.min_course_length) model.min_course_length = kMinCourse;
  if (!model.tortuosity) model.tortuosity = kLeastTortuosity;
  if (model.max_inclination == 0) model.max_inclination = kPi;
  model.vertical_limit = kVertical;
  if (const auto complaint = FindComplaint(model)) RefuseModel(source, complaint->text);
}

ErrorTerm FormulaTerm(const std::string& name, double magnitude, Propagation propagation,
                      const FormulaTexts& formulas, const std::string& source) {
  ErrorTerm term;
  term.name = name;
  term.weight = &OwnFormula();
  term.magnitude = std::abs(magnitude);
  term.propagation = propagation;
  auto compiled = FormulaWeight::Compile(formulas);
  if (!compiled) RefuseModel(source, "term " + name + ": " + compiled.fault().text);
  term.formula = *std::move(compiled);
  return term;
}

}  // namespace wellgyro
