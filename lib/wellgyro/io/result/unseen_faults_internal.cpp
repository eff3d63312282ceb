#include "wellgyro/io/result/unseen_faults_internal.h"

#include <algorithm>
#include <cmath>

#include "wellgyro/record/run_fit.h"

namespace wellgyro {
namespace {

const RunDiagnosis* DiagnosisOfTheEnd(const Survey& survey) {
  for (const RunSummary& run : survey.runs) {
    if (run.run == survey.chosen.back().run && run.fit && run.fit->diagnosis) {
      return &*run.fit->diagnosis;
    }
  }
  return nullptr;
}

}  // namespace

std::optional<UnseenFaults> UnseenFaultsOf(const Survey& survey) {
  if (survey.chosen.empty()) return std::nullopt;
  const Station& end = survey.chosen.back();
  const RunDiagnosis* found = DiagnosisOfTheEnd(survey);
  if (!found || found->hidden_cause.empty() || Has(end.quality, Quality::kUnfit)) {
    return std::nullopt;
  }
  const double sigmas = ConfidenceFactor(kConfidence, 2);
  const Eigen::Matrix2d by_chance = sigmas * sigmas * end.cov_p_WT_W.topLeftCorner<2, 2>();
  Eigen::Matrix3d about = Eigen::Matrix3d::Zero();
  about.topLeftCorner<2, 2>() = EllipseAboutSum(found->hidden, by_chance);
  UnseenFaults unseen;
  unseen.bound = HorizontalEllipse(about / (sigmas * sigmas), kConfidence);
  unseen.cause = found->hidden_cause;
  const double chance = HorizontalEllipse(end.cov_p_WT_W, kConfidence).semi_major;
  double deep = 0;
  for (const RunReliability& fault : found->reliability) {
    const double shift = fault.shift_W.head<2>().norm();
    unseen.shift = std::max(unseen.shift, shift);
    deep = std::max(deep, std::abs(fault.shift_W.z()));
    if (!fault.smallest && shift > chance) unseen.unshown.push_back(fault.code);
  }
  for (const RunSummary& run : survey.runs) {
    if (run.run != end.run || !run.slip || run.slip->reliability.smallest) continue;
    if (run.slip->reliability.shift_W.norm() > chance) unseen.unshown.emplace_back("depth_slip");
  }
  const bool axes_told =
      std::none_of(survey.checks.begin(), survey.checks.end(), [&](const Check& c) {
        return c.run == end.run && c.code == "axes" && c.verdict == Verdict::kNotDone;
      });
  if (!axes_told) unseen.unshown.emplace_back("axes");
  unseen.tvd = ConfidenceFactor(kConfidence, 1) * std::sqrt(end.cov_p_WT_W(2, 2)) + deep;
  return unseen;
}

}  // namespace wellgyro
