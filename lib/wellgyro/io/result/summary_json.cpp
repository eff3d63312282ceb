#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/result/json_columns_internal.h"
#include "wellgyro/io/result/summary.h"
#include "wellgyro/io/result/unseen_faults_internal.h"
#include "wellgyro/io/words.h"
#include "wellgyro/uncertainty/ellipse.h"

namespace wellgyro {
namespace {

using Json = nlohmann::ordered_json;

template <class T>
Json OrNull(const std::optional<T>& value) {
  return value ? Json(*value) : Json();
}

Json EllipseJson(const ErrorEllipse& ellipse) {
  return {{"semi_major_m", ellipse.semi_major},
          {"semi_minor_m", ellipse.semi_minor},
          {"azimuth_major_deg", ToDegrees(ellipse.azimuth_major)}};
}

Json EndJson(const Station& end) {
  Json json{{"md_m", end.md},
            {"inclination_deg", ToDegrees(end.inclination)},
            {"azimuth_true_deg", ToDegrees(end.azimuth)},
            {"north_m", end.p_WT_W.x()},
            {"east_m", end.p_WT_W.y()},
            {"tvd_m", end.p_WT_W.z()},
            {"quality", QualityText(end.quality)},
            {"ellipse_95", nullptr},
            {"tvd_95_m", nullptr}};
  if (Has(end.quality, Quality::kUnfit)) return json;
  json["ellipse_95"] = EllipseJson(HorizontalEllipse(end.cov_p_WT_W, kConfidence));
  json["tvd_95_m"] = ConfidenceFactor(kConfidence, 1) * std::sqrt(end.cov_p_WT_W(2, 2));
  return json;
}

Json UnseenJson(const Survey& survey) {
  const std::optional<UnseenFaults> unseen = UnseenFaultsOf(survey);
  if (!unseen) return nullptr;
  Json json = EllipseJson(unseen->bound);
  json["cause"] = unseen->cause;
  json["cause_shift_m"] = unseen->shift;
  json["tvd_m"] = unseen->tvd;
  json["not_shown"] = unseen->unshown;
  return json;
}

Json CheckJson(const Check& check) {
  return {{"code", check.code},
          {"verdict", WordOf(check.verdict)},
          {"run", check.run > 0 ? Json(check.run) : Json()},
          {"pass", check.pass ? Json(WordOf(*check.pass)) : Json()},
          {"md_m", OrNull(check.md)},
          {"value", OrNull(check.value)},
          {"sigma", OrNull(check.sigma)},
          {"limit", OrNull(check.limit)},
          {"unit", check.unit},
          {"limit_source", check.limit_source}};
}

Json ToolJson(const ToolSummary& tool) {
  const Survey& survey = *tool.survey;
  const auto good = std::count_if(survey.chosen.begin(), survey.chosen.end(),
                                  [](const Station& s) { return s.quality == Quality::kGood; });
  Json checks = Json::array();
  for (const Check& check : survey.checks) {
    if (check.verdict != Verdict::kPass) checks.push_back(CheckJson(check));
  }
  const bool any = !survey.chosen.empty();
  return {{"tool", tool.tool},
          {"folder", tool.folder.string()},
          {"files", tool.files},
          {"unusable", survey.unusable.empty() ? Json() : Json(survey.unusable)},
          {"stations", survey.chosen.size()},
          {"stations_good", good},
          {"pass_stations", survey.passes.size()},
          {"runs", survey.runs.size()},
          {"end", any ? EndJson(survey.chosen.back()) : Json()},
          {"unseen_faults", any ? UnseenJson(survey) : Json()},
          {"checks_not_passed", std::move(checks)}};
}

}  // namespace

std::string SummaryJson(std::span<const ToolSummary> tools, const RunVerdict& verdict,
                        int exit_code) {
  Json json{{"format", "wellgyro.summary/1"},
            {"verdict", WordOf(verdict.verdict)},
            {"causes", verdict.causes},
            {"exit_code", exit_code},
            {"tools", Json::array()}};
  for (const ToolSummary& tool : tools) json["tools"].push_back(ToolJson(tool));
  // Names of folders may be any bytes; what is no UTF-8 becomes U+FFFD.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace wellgyro
