#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "wellgyro/base/result.h"
#include "wellgyro/uncertainty/error_model.h"
#include "wellgyro/uncertainty/formula_weight.h"

namespace wellgyro {

inline constexpr std::size_t kMostTerms = 1000;  ///< of a model from outside; published have dozens

/// Carries a Fault to the door of a model reader. Never leaves io/exchange.
struct ModelError {
  Fault fault;
};
[[noreturn]] void RefuseModel(const std::string& source, const std::string& text, int line = 0);

/// SI units a unit of these files is: "deg", "deg/hr", "nT", "rad.nT", "-"; none: not known.
std::optional<double> ModelUnit(std::string_view unit);

/// "Random", "systematic", "within_pad", or Compass's r s w g; none: not known.
std::optional<Propagation> ModelPropagation(std::string_view word);

/// Whether a code is more than a formula of one station in the survey's own frame, and so taken
/// from weight.h.
bool IsStateful(std::string_view code);

/// What every model needs beside its terms: the definition's values where none were given; and the
/// check that it can be used.
void FinishModel(ErrorModel& model, const std::string& source);

/// A term with its own formulas. Refuses formulas that do not compile, naming the term.
ErrorTerm FormulaTerm(const std::string& name, double magnitude, Propagation propagation,
                      const FormulaTexts& formulas, const std::string& source);

}  // namespace wellgyro
