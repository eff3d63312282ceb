#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/uncertainty/formula_weight.h"
#include "wellgyro/uncertainty/propagate.h"

namespace wellgyro {

/// The survey with the azimuth of vertical stations set to 0, as the published listings have it;
/// `changed` counts those that had another.
std::vector<SurveyPoint> WithoutVerticalAzimuths(std::span<const SurveyPoint> survey,
                                                 std::span<const ToolLeg> legs, int& changed);

/// What weights and formulas are functions of, station by station from the first one down.
class StationPlaces {
 public:
  /// `survey` and `surroundings` must outlive this object, which stays where it is.
  StationPlaces(std::span<const SurveyPoint> survey, const Surroundings& surroundings);
  StationPlaces(const StationPlaces&) = delete;
  StationPlaces& operator=(const StationPlaces&) = delete;

  /// From here on the place holds values for formulas too.
  void NameValues();
  /// Takes the parameters of a leg's model, which must outlive it.
  void StartLeg(const ErrorModel& model);
  /// To station k, the next one.
  void MoveTo(std::size_t k);

  const WeightPlace& place() const { return place_; }
  /// The hole's direction at the station below, which of the last one is its own.
  Eigen::Vector3d TangentBelow() const;

 private:
  /// Of a station, azimuth in the survey's own frame.
  struct Angles {
    double sin_inc, cos_inc, sin_azi, cos_azi;
  };
  /// Worked out once a station, which is ahead first and then at hand.
  static Angles AnglesOf(const SurveyPoint& p);
  /// Values for formulas at station k and the one before.
  void NameStation(std::size_t k);

  std::span<const SurveyPoint> survey_;
  const Surroundings& surroundings_;
  const ErrorModel* model_ = nullptr;  ///< of the leg at hand
  FormulaValues named_{};              ///< what place_.named shows, where it shows any
  WeightPlace place_;
  double magnetic_sin_ = 0, magnetic_cos_ = 1;  ///< of magnetic less survey azimuth
  Angles ahead_;                                ///< of the station below the one at hand
};

}  // namespace wellgyro
