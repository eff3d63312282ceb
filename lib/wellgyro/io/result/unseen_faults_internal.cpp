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

const RunSlip* SlipOf(const Survey& survey, std::int32_t run) {
  const auto of = std::ranges::find(survey.runs, run, &RunSummary::run);
  return of == survey.runs.end() ? nullptr : of->slip.get();
}

}  // namespace

std::optional<UnseenFaults> UnseenFaultsOf(const Survey& survey) {
  if (survey.chosen.empty()) return std::nullopt;
  const Station& end = survey.chosen.back();
  const RunDiagnosis* found = DiagnosisOfTheEnd(survey);
  if (!found || Has(end.quality, Quality::kUnfit)) return std::nullopt;
  std::vector<RunReliability> faults = found->reliability;
  const RunSlip* slip = SlipOf(survey, end.run);
  if (slip != nullptr && slip->reliability.smallest) faults.push_back(slip->reliability);
  std::vector<Eigen::Vector2d> shifts;
  for (const RunReliability& fault : faults) shifts.push_back(fault.shift_W.head<2>());
  const double sigmas = ConfidenceFactor(kConfidence, 2);
  const Eigen::Matrix2d by_chance = sigmas * sigmas * end.cov_p_WT_W.topLeftCorner<2, 2>();
  Eigen::Matrix3d about = Eigen::Matrix3d::Zero();
  about.topLeftCorner<2, 2>() = EllipseAboutSum(EllipseAbout(shifts), by_chance);
  UnseenFaults unseen;
  unseen.bound = HorizontalEllipse(about / (sigmas * sigmas), kConfidence);
  const double chance = HorizontalEllipse(end.cov_p_WT_W, kConfidence).semi_major;
  double deep = 0;
  for (const RunReliability& fault : faults) {
    const double shift = fault.shift_W.head<2>().norm();
    if (shift > unseen.shift) {
      unseen.shift = shift;
      unseen.cause = fault.code;
    }
    deep = std::max(deep, std::abs(fault.shift_W.z()));
    if (!fault.smallest && shift > chance) unseen.unshown.push_back(fault.code);
  }
  if (slip != nullptr && slip->unseen_W.norm() > chance) {
    unseen.unshown.emplace_back("depth_slip");
  }
  if (unseen.cause.empty()) return std::nullopt;
  const bool axes_told =
      std::none_of(survey.checks.begin(), survey.checks.end(), [&](const Check& c) {
        return c.run == end.run && c.code == "axes" && c.verdict == Verdict::kNotDone;
      });
  if (!axes_told) unseen.unshown.emplace_back("axes");
  unseen.tvd = ConfidenceFactor(kConfidence, 1) * std::sqrt(end.cov_p_WT_W(2, 2)) + deep;
  return unseen;
}

}  // namespace wellgyro
