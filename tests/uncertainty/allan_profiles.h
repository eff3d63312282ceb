#pragma once

#include <string>
#include <vector>

#include "wellgyro/uncertainty/survey_point.h"

namespace wellgyro::test {

/// A well to carry a gyro down, sampled at stations.
struct Profile {
  std::string name;
  std::vector<SurveyPoint> survey;
};

/// Straight at 60 deg; turning at 45 deg through 180 deg of azimuth; out-and-back, north at 50 deg
/// and then a turn to south and back along; the ISCWSA well 2 from its surface.
std::vector<Profile> AllanProfiles();

/// The same path with `parts` times the stations: points of the arcs between them.
std::vector<SurveyPoint> Split(const std::vector<SurveyPoint>& survey, int parts);

}  // namespace wellgyro::test
