#include "wellgyro/io/result/survey_json.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/exchange/exchange.h"
#include "wellgyro/io/exchange/losses.h"
#include "wellgyro/io/formats.h"
#include "wellgyro/io/result/json_columns_internal.h"
#include "wellgyro/io/result/json_table_internal.h"
#include "wellgyro/io/result/other_well_internal.h"
#include "wellgyro/io/sha256.h"
#include "wellgyro/io/text_file.h"
#include "wellgyro/uncertainty/ellipse.h"

namespace wellgyro {
namespace {

constexpr std::int64_t kLargest = std::int64_t{1} << 28;  // bytes of one file

/// Carries a Fault out of the parts of the document, to SurveyJson.
struct Refused {
  Fault fault;
};

template <class T>
T Taken(Result<T> result) {
  if (!result) throw Refused{result.fault()};
  return std::move(result).value();
}

Json TableIn(const ResultTexts& texts, const char* name) {
  const auto text = texts.find(name);
  return text == texts.end() ? Json() : Taken(JsonTable(text->second, name));
}

/// The parsed text of the input of `role`, as run.toml has it whole; null where there is none.
Json InputOf(const Json& run, const char* role) {
  const auto inputs = run.find("input");
  if (inputs == run.end() || !inputs->is_array()) return nullptr;
  for (const Json& input : *inputs) {
    if (!input.is_object() || input.value("role", Json()) != role) continue;
    const auto text = input.find("text");
    if (text == input.end() || !text->is_string()) continue;
    const auto parsed = JsonOfToml(text->get<std::string>(), role);
    if (parsed) return *parsed;
  }
  return nullptr;
}

Json MemberOf(const Json& table, const char* key) {
  return table.is_object() ? table.value(key, Json()) : Json();
}

/// The plan that the run was made by, with which others may be compared.
Json PlanIn(const ResultTexts& texts) {
  const auto text = texts.find(kPlanFile);
  if (text == texts.end()) return nullptr;
  Json plan = Taken(JsonOfToml(text->second, kPlanFile));
  if (MemberOf(plan, "format") == formats::kPlan) return plan;
  throw Refused{{.code = FaultCode::kForeign,
                 .text = "its format is not wellgyro.plan/1",
                 .source = kPlanFile}};
}

/// What azimuths count from: the grid's convergence at the first station, and whose word it is.
Json NorthOf(const Json& job, const Json& stations) {
  Json north{{"azimuths", "true"}, {"grid", nullptr}, {"convergence_deg", nullptr}};
  north["convergence_source"] = nullptr;
  const Json grid = MemberOf(job, "grid");
  const Columns columns(stations);
  if (!grid.is_object() || columns.rows() == 0) return north;
  const Json zone = MemberOf(grid, "utm_zone"), name = MemberOf(grid, "name");
  north["grid"] = name.is_string()   ? name
                  : zone.is_string() ? Json("UTM " + zone.get<std::string>())
                                     : MemberOf(grid, "projection");
  north["epsg"] = MemberOf(grid, "epsg");
  const auto azimuth = columns.Number(0, "AZI_TRUE[deg]"),
             on_grid = columns.Number(0, "AZI_GRID[deg]");
  if (azimuth && on_grid) {
    const double convergence = std::remainder(*azimuth - *on_grid, 360.0);
    north["convergence_deg"] = std::round(convergence * 1e6) / 1e6;  // of differences of 6 decimals
    north["convergence_source"] =
        MemberOf(grid, "convergence_deg").is_number() ? "stated" : "projection";
  }
  return north;
}

/// Figures of the last station; without an ellipse where the station has no covariance.
Json EndOf(const Json& stations) {
  const Columns columns(stations);
  if (columns.rows() == 0) return nullptr;
  const std::size_t last = columns.rows() - 1;
  Json end = Json::object();
  for (const char* name : {"MD[m]", "INC[deg]", "AZI_TRUE[deg]", "TVD[m]", "N[m]", "E[m]"}) {
    const auto value = columns.Number(last, name);
    end[name] = value ? Json(*value) : Json();
  }
  end["ellipse"] = nullptr;
  const std::optional<Eigen::Matrix3d> cov = columns.Covariance(last);
  if (!cov) return end;
  const ErrorEllipse ellipse = HorizontalEllipse(*cov, kConfidence);
  end["ellipse"] = {
      {"confidence", kConfidence},
      {"semi_major_m", ellipse.semi_major},
      {"semi_minor_m", ellipse.semi_minor},
      {"azimuth_major_deg", ToDegrees(ellipse.azimuth_major)},
      {"vertical_half_m", ConfidenceFactor(kConfidence, 1) * std::sqrt((*cov)(2, 2))}};
  return end;
}

/// What the exported files beside survey.csv could not hold of it.
Json LossesIn(const Json& run, const ResultTexts& texts) {
  Json losses = Json::array();
  const Json outputs = MemberOf(run, "output");
  if (!outputs.is_array() || !texts.contains("survey.csv")) return losses;
  std::optional<SurveyTable> table;
  for (const Json& output : outputs) {
    const Json name = MemberOf(output, "name");
    for (const char* word : {"las", "p717", "witsml", "witsml21", "petrel", "compass", "osdu"}) {
      const SurveyFormat format = *SurveyFormatOf(word);
      if (name != FileNameOf(format, "survey")) continue;
      if (!table) table = Taken(ParseSurvey(texts.at("survey.csv"), "survey.csv"));
      losses.push_back({{"file", name}, {"losses", LossesOf(*table, format)}});
    }
  }
  return losses;
}

/// run.toml of a result that has its survey too.
Json RunIn(const ResultTexts& texts) {
  for (const char* needed : {"run.toml", "survey.csv"}) {
    if (texts.contains(needed)) continue;
    throw Refused{
        {.code = FaultCode::kForeign, .text = "no such file in the result", .source = needed}};
  }
  Json run = Taken(JsonOfToml(texts.at("run.toml"), "run.toml"));
  if (MemberOf(run, "format") != formats::kRun) {
    throw Refused{{.code = FaultCode::kForeign,
                   .text = "its format is not wellgyro.run/1",
                   .source = "run.toml"}};
  }
  return run;
}

Json Document(const ResultTexts& texts, std::span<const OtherWell> others) {
  Json run = RunIn(texts);
  Json document = Json::object();
  document["format"] = formats::kSurvey;
  document["job"] = InputOf(run, "job");
  document["noise"] = InputOf(run, "noise");
  document["tool_file"] = InputOf(run, "tool");
  document["stations"] = TableIn(texts, "survey.csv");
  document["north"] = NorthOf(document["job"], document["stations"]);
  document["end"] = EndOf(document["stations"]);
  document["passes"] = TableIn(texts, "passes.csv");
  document["pass_differences"] = PassDifferences(document["passes"]);
  document["checks"] = TableIn(texts, "checks.csv");
  document["diagnosis"] = TableIn(texts, "diagnosis.csv");
  document["reliability"] = TableIn(texts, "reliability.csv");
  document["stretches"] = TableIn(texts, "stretches.csv");
  document["plan"] = PlanIn(texts);
  document["losses"] = LossesIn(run, texts);
  document["source"] = texts.contains("source.toml")
                           ? Taken(JsonOfToml(texts.at("source.toml"), "source.toml"))
                           : Json();
  if (run.contains("input") && run["input"].is_array()) {
    for (Json& input : run["input"]) {
      if (input.is_object()) input.erase("text");
    }
  }
  document["run"] = std::move(run);
  document["others"] = Json::array();
  for (const OtherWell& other : others) document["others"].push_back(Taken(WellJson(other)));
  return document;
}

}  // namespace

Result<ResultTexts> ReadResultTexts(const std::filesystem::path& folder) {
  std::error_code ignored;
  if (!std::filesystem::exists(folder / "run.toml", ignored) &&
      std::filesystem::is_directory(folder / "tool-0", ignored)) {
    return Fault{.code = FaultCode::kForeign,
                 .text = "holds a result a tool: name one of them, as tool-0",
                 .source = folder.string()};
  }
  ResultTexts texts;
  for (const char* name : {"run.toml", "survey.csv", "passes.csv", "checks.csv", "diagnosis.csv",
                           "reliability.csv", "stretches.csv", "source.toml"}) {
    const bool needed = texts.size() < 2;  // the first two
    if (!needed && !std::filesystem::exists(folder / name, ignored)) continue;
    Result<std::string> text = ReadTextFile(folder / name, kLargest);
    if (!text) return text.fault();
    texts[name] = *std::move(text);
  }
  return texts;
}

std::optional<Fault> AlteredSince(const ResultTexts& texts) {
  const auto text = texts.find("run.toml");
  if (text == texts.end()) return std::nullopt;
  const Result<Json> run = JsonOfToml(text->second, "run.toml");
  if (!run) return std::nullopt;
  const Json outputs = MemberOf(*run, "output");
  for (const Json& output : outputs.is_array() ? outputs : Json::array()) {
    const Json name = MemberOf(output, "name"), sha256 = MemberOf(output, "sha256");
    if (!name.is_string() || !sha256.is_string()) continue;
    const auto file = texts.find(name.get<std::string>());
    if (file == texts.end() || Sha256Hex(file->second) == sha256.get<std::string>()) continue;
    return Fault{.code = FaultCode::kConflict,
                 .text =
                     "is not the file that run.toml has the SHA-256 of: it was changed since, or "
                     "is of another survey",
                 .source = file->first};
  }
  return std::nullopt;
}

Result<std::string> SurveyJson(const ResultTexts& texts, std::span<const OtherWell> others) {
  try {
    // What is no UTF-8 shows as the sign for it, and no name can make the document unreadable.
    return Document(texts, others).dump(1, ' ', true, Json::error_handler_t::replace) + "\n";
  } catch (const Refused& refused) {
    return refused.fault;
  }
}

}  // namespace wellgyro
