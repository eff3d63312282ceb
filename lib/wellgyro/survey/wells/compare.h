#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/base/units.h"
#include "wellgyro/record/check.h"
#include "wellgyro/survey/hole/well_uncertainty.h"
#include "wellgyro/uncertainty/station_errors.h"

namespace wellgyro {

/// What a survey says of one of its stations where no error model speaks for it; how such errors
/// go together along the hole is not known.
struct StationSigmas {
  double inclination = 0;                             ///< [rad]
  double azimuth = 0;                                 ///< [rad]
  Eigen::Matrix3d cov_p_W = Eigen::Matrix3d::Zero();  ///< north, east, down [m^2]
};

/// One of two surveys of the same hole, azimuths of both from one north, places in one frame.
struct ComparedSurvey {
  SurveyedWell well;
  std::optional<SurveyErrors> errors;                      ///< by models
  std::vector<StationSigmas> own;                          ///< else one for each station
  Eigen::Matrix3d cov_tie_in_W = Eigen::Matrix3d::Zero();  ///< of the first station [m^2]
};

struct CompareOptions {
  std::vector<double> at;  ///< depths [m]; empty: stations of the one that has fewer in common
  double every = 0;        ///< where above 0, whole multiples of it instead [m]
  /// Both are passes of one tool in one run, so that what is systematic in the one model is one
  /// error too. Global errors always are, and the well's, as it is one.
  bool same_run = false;
  /// What no model speaks of, as rounding of listings and a tool's seat in the hole; 1 sigma of
  /// each direction difference [rad]. In places it counts at every common station.
  double local_sigma = 0.05 * units::kDeg;
};

/// Both surveys at one depth, second less first.
struct ComparedPlace {
  double md = 0;                                             ///< [m]
  double inclination[2] = {0, 0}, azimuth[2] = {0, 0};       ///< of first and second [rad]
  double inclination_difference = 0, sigma_inclination = 0;  ///< [rad]
  /// Absent where the hole is within 0.1 deg of vertical [rad].
  std::optional<double> azimuth_difference, sigma_azimuth;
  Eigen::Vector3d position_difference_W = Eigen::Vector3d::Zero();  ///< north, east, down [m]
  /// Of that what the surveys lose differently between their stations: it is not there where both
  /// are summed over stations in common [m].
  Eigen::Vector3d between_stations_W = Eigen::Vector3d::Zero();
  Eigen::Matrix3d cov_position_W = Eigen::Matrix3d::Zero();  ///< of the rest, d [m^2]
  /// sqrt(d' C^-1 d); absent where C is singular.
  std::optional<double> position_sigmas;
};

/// A part of the difference that is the same all along, second less first, estimated with the
/// others by weighted least squares from all directions.
struct ShiftEstimate {
  double value = 0, sigma = 0;
  double smallest = 0;  ///< that would be found four times in five
};

struct Comparison {
  std::vector<ComparedPlace> places;
  std::size_t joint =
      0;  ///< places in the joint statistics, which take the correlations along hole
  double joint_middle = 0;  ///< depth that the stretch turns about [m]
  /// How the hole bends between stations: its curvature as white noise [rad^2/m] and as a random
  /// walk [rad^2/m^3], in either way across.
  double kink = 0, wander = 0;
  /// Absent without error models of both, or where the hole is too straight to show it.
  std::optional<ShiftEstimate> depth_offset;    ///< what the second reads more [m]
  std::optional<ShiftEstimate> depth_stretch;   ///< likewise, per metre
  std::optional<ShiftEstimate> azimuth_offset;  ///< [rad]
  std::vector<Check> checks;
  RunVerdict verdict;
  std::vector<std::string> notes;
};

/// Holds two surveys of one hole against each other, depth by depth as both list it.
///
/// An error of depth moves a listing along the hole: of direction e, of depth m and of the
/// station's place p a listing read at a given depth is wrong by e - t' m and p - t m. These are
/// carried from station to station by error source, so that differences have their whole covariance
/// along the hole, shared sources taken out once.
///
/// Between stations a listing knows nothing of the hole. Places are held against each other summed
/// over common stations, where no survey has seen more than the other; at a depth that is none of
/// its stations a direction is read off the spline through them, and wrong by what the hole leaves
/// it, whose variance is estimated from how far stations lie off the arcs between their neighbours.
/// Tested are chi-square of all inclinations, of all lateral directions, of the deepest place, and
/// the three shifts; all checks of a pair together fail 1 % of pairs without a difference and warn
/// of 10 % (survey/verdict/verdict.h); depths that span less than half of what is common warn.
/// Where a survey has sigmas of its own only, the worst depth takes the place of the first two, and
/// shifts are not done.
///
/// Joint statistics take at most 300 places, evenly chosen; O(places^2 x random terms). Throws
/// std::invalid_argument for surveys without common depth, sizes that differ, depths outside what
/// is common, more than 20 000 places, or numbers that are not finite.
WELLGYRO_EXPORT Comparison Compare(const ComparedSurvey& first, const ComparedSurvey& second,
                                   const CompareOptions& options = {});

}  // namespace wellgyro
