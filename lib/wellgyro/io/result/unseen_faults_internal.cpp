#include "wellgyro/io/result/unseen_faults_internal.h"

#include <algorithm>

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
  for (const RunReliability& fault : found->reliability) {
    unseen.shift = std::max(unseen.shift, fault.shift_W.head<2>().norm());
  }
  return unseen;
}

}  // namespace wellgyro
