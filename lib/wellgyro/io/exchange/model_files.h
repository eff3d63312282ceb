#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/uncertainty/error_model.h"

namespace wellgyro {

/// Error models in the files of others. Terms carry the formulas that the file gives, compiled once
/// and bounded (uncertainty/expression.h); those whose weight is more than a formula of one station
/// (stationary and continuous gyro, course length, short-course misalignment) are the published
/// functions of weight.h under the code that the file names. Nothing is run and nothing left out: a
/// formula, code, unit or mode that is not known is a Fault that names its term. What had to be
/// assumed is in the model's notes.

/// The ISCWSA's JSON schema (github.com/iscwsa/error-models), as OWSG's sets A and B are published
/// in. `elsewhere` are models from which tool parameters that the file lacks are taken, by short
/// name without "_Fl".
WELLGYRO_EXPORT Result<ErrorModel> ParseModelJson(std::string_view text, const std::string& source,
                                                  const std::vector<ErrorModel>& elsewhere = {});

/// welleng's YAML: `codes` with function, magnitude, propagation, unit; and its `header`.
WELLGYRO_EXPORT Result<ErrorModel> ParseModelYaml(std::string_view text, const std::string& source);

/// A Compass instrument performance model, `.ipm`: lines "#Key:value", then rows of name, vector,
/// tie-on, unit, value, formula, parted by tabs or runs of blanks. Rows of one name and tie-on are
/// one source. Vectors a b azimuth, i j inclination, e d depth, l lateral, m misalignment; tie-on r
/// s w g, and n: a value that later formulas name.
WELLGYRO_EXPORT Result<ErrorModel> ParseModelIpm(std::string_view text, const std::string& source);

/// The tools of an EDM export (CD_SURVEY_TOOL and DP_TOOL_TERM); `tool` is the id or name of the
/// one that is wanted, and may be empty where there is only one.
WELLGYRO_EXPORT Result<ErrorModel> ParseModelEdm(std::string_view text, const std::string& source,
                                                 std::string_view tool);

}  // namespace wellgyro
