#include "wellgyro/survey/hole/well_line.h"

#include <vector>

namespace wellgyro {

Trajectory LineOf(const SurveyedWell& well) {
  std::vector<double> md, inclination, azimuth;
  for (const SurveyPoint& p : well.survey) {
    md.push_back(p.md);
    inclination.push_back(p.inclination);
    azimuth.push_back(p.azimuth);
  }
  return Trajectory(md, inclination, azimuth, well.position_W.front());
}

}  // namespace wellgyro
