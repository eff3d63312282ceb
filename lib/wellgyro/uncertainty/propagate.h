#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/base/units.h"
#include "wellgyro/uncertainty/error_model.h"
#include "wellgyro/uncertainty/survey_point.h"

namespace wellgyro {

/// Where the well is. Absent values are an error only for terms that need them.
struct Surroundings {
  std::optional<double> latitude;            ///< [rad]
  double gravity = units::kStandardGravity;  ///< [m/s^2]
  double convergence = 0;                    ///< true azimuth = survey azimuth + convergence [rad]
  std::optional<double> field;               ///< total magnetic field [T]
  std::optional<double> dip;                 ///< [rad]
  std::optional<double> declination;         ///< magnetic azimuth = true - declination [rad]
};

/// Stations [begin, end) were surveyed with one tool. Legs follow each other without gaps; legs of
/// the same run and model share their systematic errors.
struct ToolLeg {
  const ErrorModel* model = nullptr;
  std::size_t begin = 0, end = 0;
  int run = 1;
};

/// A station that the model does not reach. Nothing is given from there on.
struct Refusal {
  std::size_t station = 0;
  std::string term;  ///< empty: the model as a whole
  std::string text;  ///< one sentence with depth and inclination
};

/// One error source along the well; covariances as those of PositionUncertainty.
struct TermUncertainty {
  std::string term;  ///< its name; with "/" and its first leg's number where several have that name
  std::vector<Eigen::Matrix3d> cov_p_W;  ///< [m^2]
};

/// A source that other legs (kWell) or other wells (kGlobal) share: its 1-sigma position error.
struct SharedError {
  std::string term;
  Propagation propagation = Propagation::kGlobal;
  std::vector<Eigen::Vector3d> error_p_W;  ///< [m]
};

/// Covariance of (north, east, down) per station, in the frame of the survey's azimuths.
struct PositionUncertainty {
  std::vector<Eigen::Matrix3d> cov_p_W;  ///< [m^2]; as long as the survey, or up to the refusal
  std::vector<SharedError> shared;
  std::vector<TermUncertainty> terms;  ///< when asked for
  std::vector<std::string> notes;      ///< assumptions that had to be made
  std::optional<Refusal> refusal;
};

/// What is known of the first station, which opens the first leg.
enum class TieOn {
  kModel,  ///< as the model says: half or whole
  kHalf,   ///< no error: half of the first leg goes along an exact direction
  kWhole,  ///< the second station's: its error acts over the whole leg
  /// Another run surveyed it, as where a side-track leaves its parent: by the model's weights
  /// there, its direction over half the leg; its depth, counted from the datum as the side-track's
  /// is, where the leg bends. Of that, only what reaches beyond a run is shared with other stations
  /// (ISCWSA, Current Common Practice in Collision Avoidance Calculations, 2017, 2.8).
  kIndependent,
};

struct PropagateOptions {
  Eigen::Matrix3d cov_tie_in_W = Eigen::Matrix3d::Zero();  ///< of the first station [m^2]
  bool terms = false;
  TieOn tie_on = TieOn::kModel;
  /// A station, not the first, from which on errors count: where a side-track leaves this hole.
  /// What comes before it is common to both and so left out; the tool's mode is followed through
  /// it.
  std::optional<std::size_t> zero_at;
};

/// Position uncertainty of a survey, each station in constant time.
///
/// Stations carry their errors into positions by the balanced tangential sensitivities (ISCWSA
/// Error Model Definition, section 4). Gyro terms follow the mode of the tool (SPE 90408, App. C),
/// which is taken to have run in from the well's first station. The first station has no error of
/// direction but by `tie_on`. A station that the model cannot serve (a two-axis gyrocompass above
/// its end inclination or within 1 deg of horizontal, an inclination beyond the model's) ends the
/// result with a refusal; no term is ever left out.
///
/// Throws std::invalid_argument, naming what and where, for fewer than two points, depths that do
/// not increase, a `zero_at` that is no station, values that are not finite or out of range, a
/// model with a complaint, legs that do not cover the stations, gyrocompass terms without a
/// latitude or beyond 89 deg, or missing magnetics.
WELLGYRO_EXPORT PositionUncertainty PropagateErrors(std::span<const SurveyPoint> survey,
                                                    const Surroundings& surroundings,
                                                    const ErrorModel& model,
                                                    const PropagateOptions& options = {});

WELLGYRO_EXPORT PositionUncertainty PropagateErrors(std::span<const SurveyPoint> survey,
                                                    const Surroundings& surroundings,
                                                    std::span<const ToolLeg> legs,
                                                    const PropagateOptions& options = {});

}  // namespace wellgyro
