#include "wellgyro/io/result/summary.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/number_text_internal.h"
#include "wellgyro/io/result/unseen_faults_internal.h"
#include "wellgyro/io/words.h"
#include "wellgyro/survey/verdict/verdict.h"
#include "wellgyro/uncertainty/ellipse.h"

namespace wellgyro {
namespace {

std::string EndText(const Station& end) {
  std::string text = fmt::format(
      "end of survey  MD {} m, inclination {} deg, azimuth {} deg true\n"
      "position       north {} m, east {} m, TVD {} m\n",
      Fixed(end.md, 2), Fixed(ToDegrees(end.inclination), 2), AzimuthText(end.azimuth, 2),
      Fixed(end.p_WT_W.x(), 2), Fixed(end.p_WT_W.y(), 2), Fixed(end.p_WT_W.z(), 2));
  if (Has(end.quality, Quality::kUnfit)) return text + "95 % ellipse   none: the end is unfit\n";
  const ErrorEllipse ellipse = HorizontalEllipse(end.cov_p_WT_W, kConfidence);
  const double tvd = ConfidenceFactor(kConfidence, 1) * std::sqrt(end.cov_p_WT_W(2, 2));
  return text + fmt::format(
                    "95 % ellipse   {} m by {} m (half axes), the long one towards {} deg; TVD +- "
                    "{} m\n",
                    Fixed(ellipse.semi_major, 2), Fixed(ellipse.semi_minor, 2),
                    Fixed(ToDegrees(ellipse.azimuth_major), 0), Fixed(tvd, 2));
}

/// How far off the end may be with a fault that passed unnoticed.
std::string UnseenText(const Survey& survey) {
  const std::optional<UnseenFaults> unseen = UnseenFaultsOf(survey);
  if (!unseen) return "";
  std::string text = fmt::format(
      "unseen faults  with one the end is within {} m by {} m (half axes), the long one towards {} "
      "deg; TVD +- {} m; most by {}, {} m\n",
      Fixed(unseen->bound.semi_major, 2), Fixed(unseen->bound.semi_minor, 2),
      Fixed(ToDegrees(unseen->bound.azimuth_major), 0), Fixed(unseen->tvd, 2), unseen->cause,
      Fixed(unseen->shift, 2));
  if (unseen->unshown.empty()) return text;
  return text + fmt::format("on trust       {}: this run would not show them at any size\n",
                            fmt::join(unseen->unshown, ", "));
}

std::string CheckText(const Check& check) {
  std::string text = fmt::format("check {:<8} {}", WordOf(check.verdict), check.code);
  if (check.run > 0) text += fmt::format(", run {}", check.run);
  if (check.pass) text += fmt::format(" {}", WordOf(*check.pass));
  if (check.md) text += fmt::format(", MD {} m", Fixed(*check.md, 2));
  if (check.value && check.limit) {
    const std::string unit = check.unit == "1" ? "" : " " + check.unit;
    text += fmt::format(": {} against {}{} ({})", ShortNumber(*check.value, 3),
                        ShortNumber(*check.limit, 3), unit, check.limit_source);
  }
  return text + '\n';
}

}  // namespace

std::string VerdictText(const RunVerdict& verdict) {
  std::string text = fmt::format("verdict {}", WordOf(verdict.verdict));
  for (std::size_t i = 0; i < verdict.causes.size(); ++i) {
    text += (i == 0 ? ": " : "; ") + verdict.causes[i];
  }
  return text;
}

std::string SummaryText(const Survey& survey) {
  std::string text;
  if (survey.chosen.empty()) return "no station\n";
  text += EndText(survey.chosen.back()) + UnseenText(survey);
  const auto good = std::count_if(survey.chosen.begin(), survey.chosen.end(),
                                  [](const Station& s) { return s.quality == Quality::kGood; });
  text += fmt::format("stations       {}, of which {} good; {} in all passes of {}\n",
                      survey.chosen.size(), good, survey.passes.size(),
                      Counted(survey.runs.size(), "run"));
  for (const Check& check : survey.checks) {
    if (check.verdict != Verdict::kPass) text += CheckText(check);
  }
  return text;
}

}  // namespace wellgyro
