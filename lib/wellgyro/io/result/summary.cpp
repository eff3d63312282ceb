#include "wellgyro/io/result/summary.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/number_text_internal.h"
#include "wellgyro/io/words.h"
#include "wellgyro/record/run_fit.h"

namespace wellgyro {
namespace {

constexpr double k95Plane = 2.4477468306808166;  // sqrt(-2 ln 0.05), two dimensions
constexpr double k95Line = 1.959963984540054;    // of the normal distribution, two-sided

/// Principal half axes of e' C^-1 e = 1, and where the long one points.
struct Axes {
  double major = 0, minor = 0, direction = 0;
};
Axes AxesOf(const Eigen::Matrix2d& c) {
  const double mean = 0.5 * (c(0, 0) + c(1, 1));
  const double spread = std::hypot(0.5 * (c(0, 0) - c(1, 1)), c(0, 1));
  const double direction = 0.5 * std::atan2(2 * c(0, 1), c(0, 0) - c(1, 1));
  return {std::sqrt(mean + spread), std::sqrt(std::max(mean - spread, 0.0)),
          direction < 0 ? direction + kPi : direction};
}

std::string EndText(const Station& end) {
  const auto& c = end.cov_p_WT_W;
  const Axes axes = AxesOf(c.topLeftCorner<2, 2>());
  std::string text = fmt::format(
      "end of survey  MD {} m, inclination {} deg, azimuth {} deg true\n"
      "position       north {} m, east {} m, TVD {} m\n",
      Fixed(end.md, 2), Fixed(ToDegrees(end.inclination), 2), AzimuthText(end.azimuth, 2),
      Fixed(end.p_WT_W.x(), 2), Fixed(end.p_WT_W.y(), 2), Fixed(end.p_WT_W.z(), 2));
  if (Has(end.quality, Quality::kUnfit)) return text + "95 % ellipse   none: the end is unfit\n";
  return text + fmt::format(
                    "95 % ellipse   {} m by {} m (half axes), the long one towards {} deg; TVD +- "
                    "{} m\n",
                    Fixed(k95Plane * axes.major, 2), Fixed(k95Plane * axes.minor, 2),
                    Fixed(ToDegrees(axes.direction), 0), Fixed(k95Line * std::sqrt(c(2, 2)), 2));
}

/// What a fault that passed unnoticed may have done to the end.
std::string HiddenText(const Survey& survey) {
  const std::int32_t last = survey.chosen.back().run;
  for (const RunSummary& run : survey.runs) {
    if (run.run != last || !run.fit || !run.fit->diagnosis) continue;
    const RunDiagnosis& found = *run.fit->diagnosis;
    if (found.hidden_cause.empty()) continue;
    const Axes axes = AxesOf(found.hidden);
    return fmt::format(
        "unseen faults  move the end by up to {} m by {} m (half axes), the long one towards {} "
        "deg; most by {}\n",
        Fixed(axes.major, 2), Fixed(axes.minor, 2), Fixed(ToDegrees(axes.direction), 0),
        found.hidden_cause);
  }
  return "";
}

std::string CheckText(const Check& check) {
  std::string text = fmt::format("check {:<8} {}", WordOf(check.verdict), check.code);
  if (check.run > 0) text += fmt::format(", run {}", check.run);
  if (check.pass) text += fmt::format(" {}", WordOf(*check.pass));
  if (check.md) text += fmt::format(", MD {} m", Fixed(*check.md, 2));
  if (check.value && check.limit) {
    const std::string unit = check.unit == "1" ? "" : " " + check.unit;
    text += fmt::format(": {:.3g} against {:.3g}{} ({})", *check.value, *check.limit, unit,
                        check.limit_source);
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
  text += EndText(survey.chosen.back()) + HiddenText(survey);
  const auto good = std::count_if(survey.chosen.begin(), survey.chosen.end(),
                                  [](const Station& s) { return s.quality == Quality::kGood; });
  text += fmt::format("stations       {}, of which {} good; {} in all passes of {} run{}\n",
                      survey.chosen.size(), good, survey.passes.size(), survey.runs.size(),
                      survey.runs.size() == 1 ? "" : "s");
  for (const Check& check : survey.checks) {
    if (check.verdict != Verdict::kPass) text += CheckText(check);
  }
  return text;
}

}  // namespace wellgyro
