#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/uncertainty/gyro_mode.h"
#include "wellgyro/uncertainty/propagate.h"

namespace wellgyro {

/// What the error model of one leg says at each station of the well, from the first one down.
class LegWeights {
 public:
  LegWeights(const ErrorModel& model, const Surroundings& surroundings);

  const ErrorModel& model() const { return model_; }
  const GyroModeTracker& tracker() const { return tracker_; }

  void Begin(const SurveyPoint& first) { tracker_.Begin(first); }
  void Advance(const SurveyPoint& previous, const SurveyPoint& point) {
    tracker_.Advance(previous, point);
  }

  /// Why the model as a whole does not serve `point`; empty: it does.
  std::string WhyNot(const SurveyPoint& point) const;
  /// Weights of term i at `place`, which has this leg's parameters. An empty result: `why` says why
  /// they are not to be trusted.
  std::optional<Weights> Weigh(std::size_t term, const WeightPlace& place, std::string& why);
  /// The position error of term i in place of its weights, where it has one: per metre of course at
  /// a vertical station; of a course term always, and whole.
  std::optional<Eigen::Vector3d> Displacement(std::size_t term, const WeightPlace& place,
                                              bool vertical) const;
  /// Errors of term i add up while this stays the same: from station to station for systematic
  /// ones; within a section of continuous survey for what was drawn once at its begin.
  std::int64_t Group(std::size_t term, std::size_t station) const;

 private:
  struct Carried {
    int section = 0;
    double azimuth = 0;
  };

  const GyroMode& mode() const { return tracker_.mode(); }
  double CarriedAzimuth(std::size_t term, const WeightPlace& place);
  double InitCosine();

  const ErrorModel& model_;
  double convergence_ = 0;
  GyroModeTracker tracker_;
  std::vector<std::size_t> zones_;  ///< per term, of continuous ones
  std::vector<Carried> carried_;    ///< per term, from the fix that opened the section
  int cosine_section_ = 0;
  double init_cosine_ = 1;  ///< of the inclination at which that section was entered
};

}  // namespace wellgyro
