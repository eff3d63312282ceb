#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/record/station.h"
#include "wellgyro/uncertainty/allan_error.h"
#include "wellgyro/uncertainty/propagate.h"

namespace wellgyro {

/// A survey with its positions by minimum curvature, in the frame of its azimuths.
struct SurveyedWell {
  std::vector<SurveyPoint> survey;
  std::vector<Eigen::Vector3d> position_W;  ///< north, east, TVD [m]
};

/// `stations` have no TVD yet; the first is at `start_W` (north, east, TVD) [m]. Throws
/// std::invalid_argument as MinimumCurvature does.
WELLGYRO_EXPORT SurveyedWell SurveyWell(std::vector<SurveyPoint> stations,
                                        const Eigen::Vector3d& start_W);

/// The chosen stations of a survey, with the positions they already have; true azimuths.
WELLGYRO_EXPORT SurveyedWell SurveyWell(std::span<const Station> stations);

/// How the gyro's own Allan coefficients enter.
enum class AllanForm { kExact, kPrinted };

/// What a position uncertainty is to rest on: tool legs, a gyro's Allan coefficients, or both: then
/// the Allan terms take the place of the legs' drift and random walk.
struct UncertaintyBasis {
  std::vector<ToolLeg> legs;
  std::optional<NoiseCoefficients> noise;
  AllanForm form = AllanForm::kExact;
  std::optional<double> speed;       ///< along hole [m/s]; absent: the model's
  std::optional<double> initialise;  ///< see AllanRun; absent: the model's, else 15 deg
  double sigma_azimuth = 0;          ///< of the fix, where no model says [rad]
};

/// Throws std::invalid_argument as PropagateErrors and AllanErrors do; and when Allan coefficients
/// stand beside legs of several models, or beside one without or with several continuous gyros.
WELLGYRO_EXPORT PositionUncertainty WellUncertainty(const SurveyedWell& well,
                                                    const Surroundings& surroundings,
                                                    const UncertaintyBasis& basis,
                                                    const PropagateOptions& options = {});

}  // namespace wellgyro
