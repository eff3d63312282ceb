#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/uncertainty/propagate.h"

namespace wellgyro {

/// One independent source of error of a survey.
struct NamedSource {
  std::string term;
  Propagation propagation = Propagation::kSystematic;
  std::string model;
  int run = 1;  ///< of the first leg that has it
};

/// What one source, while its group lasts, does to one station: 1 sigma, all of one sign. Groups of
/// a source are independent of each other, and so are sources.
struct StationError {
  std::size_t source = 0;
  std::int64_t group = 0;
  std::size_t station = 0;
  double md = 0;                                             ///< listed less true [m]
  Eigen::Vector3d direction_W = Eigen::Vector3d::Zero();     ///< of the unit tangent [rad]
  Eigen::Vector3d displacement_W = Eigen::Vector3d::Zero();  ///< of the course that ends here [m]
};

/// What a survey's error models say of each station: from it every covariance between any two
/// stations follows, where PositionUncertainty has only that of each with itself.
struct SurveyErrors {
  std::vector<NamedSource> sources;
  std::vector<StationError> errors;  ///< by source, group, station
  std::size_t stations = 0;          ///< served; fewer than the survey's where there is a refusal
  bool first_is_measured = false;    ///< the first station has an error: it is not at MD 0
  bool doubled_tie_on = false;       ///< the first course has the second station's direction
  std::optional<Refusal> refusal;
};

/// The same terms, modes and groups as PropagateErrors, station by station instead of summed. A
/// first station at MD 0 is taken as exact, any other as measured by its leg's model. Throws as
/// PropagateErrors.
WELLGYRO_EXPORT SurveyErrors ErrorsAtStations(std::span<const SurveyPoint> survey,
                                              const Surroundings& surroundings,
                                              std::span<const ToolLeg> legs);

}  // namespace wellgyro
