#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/record/survey_table.h"

/// What measured depth, inclination and azimuth say of positions, to be held against the positions
/// that a file gives.
namespace wellgyro::witness {

/// How positions are summed from angles; each as the field's textbooks have it.
enum class Method {
  kMinimumCurvature,
  kRadiusOfCurvature,
  kBalancedTangential,
  kAverageAngle,
  kTangential,
};
inline constexpr std::array kMethods{Method::kMinimumCurvature, Method::kRadiusOfCurvature,
                                     Method::kBalancedTangential, Method::kAverageAngle,
                                     Method::kTangential};
std::string_view WordOf(Method method);  ///< as WITSML calls it

/// Displacement (north, east, down) over one leg [m]; by the chord where minimum curvature has no
/// arc.
Eigen::Vector3d Displacement(Method method, double length, double inclination1, double azimuth1,
                             double inclination2, double azimuth2);

/// A stretch of path from one row to a later one, and what is computed for it.
struct Stretch {
  std::size_t begin = 0, end = 0;  ///< rows
  Eigen::Vector3d moved_W = Eigen::Vector3d::Zero();
};
/// The path cut into at most `most` stretches of equally many legs; rows that do not belong to it
/// are passed over.
std::vector<Stretch> StretchesOf(const SurveyTable& table, Method method, std::size_t most);

/// How given displacements follow from computed ones, by a factor that most of them share.
struct LineFit {
  std::size_t pairs = 0;
  double reach = 0;   ///< sum of the computed lengths [m]
  double factor = 1;  ///< given over computed
  double sigma = 0;   ///< of the factor
  double median = 0;  ///< of what remains, over stretches [m]
};
/// Of a column of depths, as TVD, against the legs' vertical parts.
LineFit FitVertical(const SurveyTable& table, const std::vector<Stretch>& stretches, Column column);

/// The same in the plane: north + i east given = z times computed; and of the mirror image, z times
/// its conjugate.
struct PlaneFit {
  std::size_t pairs = 0;
  double reach = 0;
  std::complex<double> z{1, 0}, mirrored{1, 0};
  double sigma = 0, mirrored_sigma = 0;
  double median = 0, mirrored_median = 0;
};
/// Of two columns, offsets or map coordinates, against the legs' horizontal parts.
PlaneFit FitPlane(const SurveyTable& table, const std::vector<Stretch>& stretches, Column north,
                  Column east);

/// Given dogleg severity over that of the angles, where it is large enough to tell.
LineFit FitCurvature(const SurveyTable& table);

}  // namespace wellgyro::witness
