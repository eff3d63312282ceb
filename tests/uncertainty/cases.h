#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "wellgyro/uncertainty/propagate.h"

namespace wellgyro::test {

std::filesystem::path CasePath(const std::string& name);
std::filesystem::path ModelPath(const std::string& name);

/// A model of data/models; a fault fails the test with its text.
ErrorModel Model(const std::string& name);

/// A published well: stations with TVD by minimum curvature.
struct CaseWell {
  double unit = 1;  ///< of its lengths [m]
  std::vector<SurveyPoint> survey;
  Surroundings place;

  /// Index of the first station not above `md`, in the well's unit, to 0.6 of it.
  std::size_t StationAt(double md) const;
};

/// Well `number` of the ISCWSA, with the place that the case file `name` gives it.
CaseWell StandardWell(int number, const std::string& name);

/// A line `value` of a case file: its words.
std::vector<std::vector<std::string>> CaseValues(const std::string& name);

/// Stations every `step` along md from 0, straight down first; inclination and azimuth by `shape`.
template <class Shape>
std::vector<SurveyPoint> MadeSurvey(double end, double step, const Shape& shape);

/// Fills the TVD by minimum curvature.
void AddDepths(std::vector<SurveyPoint>& survey);

template <class Shape>
std::vector<SurveyPoint> MadeSurvey(double end, double step, const Shape& shape) {
  std::vector<SurveyPoint> survey;
  for (int k = 0; k * step <= end + 1e-9; ++k) {
    SurveyPoint point;
    point.md = k * step;
    shape(point);
    survey.push_back(point);
  }
  AddDepths(survey);
  return survey;
}

}  // namespace wellgyro::test
