#include "wellgyro/io/result/unseen_faults_internal.h"

#include <algorithm>
#include <cmath>
#include <string_view>

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

/// The check was made; `run` 0: of the whole survey.
bool IsTold(const Survey& survey, std::int32_t run, std::string_view code) {
  return std::none_of(survey.checks.begin(), survey.checks.end(), [&](const Check& c) {
    return c.run == run && c.code == code && c.verdict == Verdict::kNotDone;
  });
}

/// A tie-in below the datum whose place the job calls exact, and no run has been on the way to it.
bool IsTieInTrusted(const Survey& survey) {
  const Station& tie = survey.chosen.front();
  const bool exact = tie.kind == StationKind::kTieIn && tie.cov_p_WT_W.isZero(0);
  return exact && tie.md > 0 && !IsTold(survey, 0, "tie_in_way");
}

/// Axes of the other hand, gyros and accelerometers alike: gravity and the Earth's rate are those
/// of the hole's image across the meridian, A for -A, and so its east is the other one.
RunReliability MirroredAxes(const Survey& survey, std::int32_t run) {
  const auto first = std::ranges::find(survey.chosen, run, &Station::run);
  const double east = survey.chosen.back().p_WT_W.y() - first->p_WT_W.y();
  return {.code = "axes", .shift_W = Eigen::Vector3d(0, -2 * east, 0)};
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
  if (!IsTold(survey, end.run, "axes")) faults.push_back(MirroredAxes(survey, end.run));
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
  if (IsTieInTrusted(survey)) unseen.unshown.emplace_back("tie_in");
  if (unseen.cause.empty()) return std::nullopt;
  unseen.tvd = ConfidenceFactor(kConfidence, 1) * std::sqrt(end.cov_p_WT_W(2, 2)) + deep;
  return unseen;
}

}  // namespace wellgyro
