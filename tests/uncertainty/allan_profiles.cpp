#include "allan_profiles.h"

#include <algorithm>
#include <cmath>

#include "wellgyro/base/units.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/trajectory/minimum_curvature.h"

#include "cases.h"

namespace wellgyro::test {

std::vector<Profile> AllanProfiles() {
  using units::kDeg;
  std::vector<Profile> all;
  all.push_back({"straight", MadeSurvey(2000, 25, [](SurveyPoint& p) {
                   p.inclination = 60 * kDeg;
                   p.azimuth = 0.4;
                 })});
  all.push_back({"turning", MadeSurvey(2000, 25, [](SurveyPoint& p) {
                   p.inclination = 45 * kDeg;
                   p.azimuth = 180 * kDeg * p.md / 2000;
                 })});
  all.push_back({"out and back", MadeSurvey(2400, 25, [](SurveyPoint& p) {
                   p.inclination = 50 * kDeg;
                   p.azimuth = 180 * kDeg * std::clamp((p.md - 900) / 600, 0.0, 1.0);
                 })});
  all.push_back({"ISCWSA 2", StandardWell(2, "iscwsa-mwd-rev5.1.txt").survey});
  return all;
}

std::vector<SurveyPoint> Split(const std::vector<SurveyPoint>& survey, int parts) {
  std::vector<SurveyPoint> fine = {survey.front()};
  for (std::size_t k = 1; k < survey.size(); ++k) {
    const Eigen::Vector3d from = Tangent(survey[k - 1].inclination, survey[k - 1].azimuth);
    const Eigen::Vector3d to = Tangent(survey[k].inclination, survey[k].azimuth);
    for (int i = 1; i <= parts; ++i) {
      const double u = static_cast<double>(i) / parts;
      if (i == parts) {
        fine.push_back(survey[k]);
        break;
      }
      const Eigen::Vector3d t = TangentOnArc(from, to, u);
      SurveyPoint p;
      p.md = survey[k - 1].md + u * (survey[k].md - survey[k - 1].md);
      p.inclination = std::atan2(t.head<2>().norm(), t.z());
      p.azimuth = std::atan2(t.y(), t.x());
      fine.push_back(p);
    }
  }
  AddDepths(fine);
  return fine;
}

}  // namespace wellgyro::test
