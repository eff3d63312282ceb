#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"

namespace wellgyro {

/// Text files of one result folder, by name; under kPlanFile the plan of its stops
/// (`wellgyro.plan/1`), which the folder does not hold.
using ResultTexts = std::map<std::string, std::string>;
inline constexpr const char* kPlanFile = "plan.toml";

/// A well to be drawn beside the survey: a survey in any format that ReadSurvey knows.
struct OtherWell {
  std::string name;
  std::string text;
};

/// What SurveyJson reads of the result in `folder`: run.toml and survey.csv, without which there is
/// none, and passes.csv, checks.csv, diagnosis.csv, reliability.csv, stretches.csv and source.toml
/// where they are.
/// Fault as ReadTextFile; where the folder holds one folder a tool it says so.
WELLGYRO_EXPORT Result<ResultTexts> ReadResultTexts(const std::filesystem::path& folder);

/// A file that is not as run.toml has it by its SHA-256: changed, or of another survey. Absent
/// where all are, or where run.toml cannot be read.
WELLGYRO_EXPORT std::optional<Fault> AlteredSince(const ResultTexts& texts);

/// survey.json, `wellgyro.survey/1`: all of a result in one document, for pages and programs; its
/// members stand in lib/docs/survey-json.md. What the files do not hold is null. Numbers are those
/// of the files to the last digit; computed here are only the figures of the end (95 % ellipse),
/// the grid's convergence at the first station and the differences between the passes of a run at
/// the depths that both have. The same texts give the same bytes. Faults name file and line.
WELLGYRO_EXPORT Result<std::string> SurveyJson(const ResultTexts& texts,
                                               std::span<const OtherWell> others = {});

}  // namespace wellgyro
