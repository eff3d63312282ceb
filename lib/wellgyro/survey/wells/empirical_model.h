#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/export.h"
#include "wellgyro/survey/hole/well_uncertainty.h"
#include "wellgyro/uncertainty/error_model.h"
#include "wellgyro/uncertainty/propagate.h"

namespace wellgyro {

/// One survey of a hole. Surveys of one hole with the same `run` are passes of one tool in one run
/// and share its systematic errors.
struct RepeatedSurvey {
  SurveyedWell well;
  int run = 0;
};

/// One hole that was surveyed more than once, azimuths of all from one north.
struct RepeatedHole {
  std::string name;
  Surroundings surroundings;
  std::vector<RepeatedSurvey> surveys;
};

/// A magnitude, 1 sigma, in SI units.
struct TermEstimate {
  std::string term;
  double assumed = 0;
  double magnitude = 0;  ///< of the model that came of it
  double lower = 0;      ///< of its 95 % interval; without meaning where `kept`
  std::optional<double> upper;
  std::string kept;  ///< why the assumed magnitude stands; empty: it is estimated
};

/// How well a hole's surveys agree by the model that came of all.
struct HoleFit {
  std::string name;
  std::size_t surveys = 0, places = 0;
  double freedom = 0;     ///< differences of directions, in both ways across the hole
  double chi_square = 0;  ///< over `freedom`
};

struct EmpiricalModel {
  ErrorModel model;                 ///< the assumed one with other magnitudes
  std::vector<TermEstimate> terms;  ///< in the model's order
  /// Of each direction, what no term of the model speaks of; not in `model` [rad].
  TermEstimate local;
  std::vector<HoleFit> holes;
  std::vector<std::string> notes;  ///< holes and surveys that were left out, and why
};

struct EmpiricalOptions {
  /// Where the search for `local` begins [rad].
  double local_sigma = FromDegrees(0.05);
};

/// Magnitudes of a model's terms from how surveys of the same holes differ.
///
/// To first order the listings of a hole at common depths are its directions and, linear in the
/// draws of every source, the errors of station_errors.h with what errors of depth make of the
/// hole's bend. The directions are fixed effects; in contrasts free of them variances are found by
/// restricted maximum likelihood (math/variance_components.h), each interval by its profile. Global
/// and well terms are the same in all surveys of a hole: they keep what is assumed. So do, one
/// after the other, terms of which the data tell neither 0 nor the assumed magnitude apart, and the
/// others are estimated beside them.
///
/// Depths are stations of the surveys with the widest spacing, where two surveys reach. Throws
/// std::invalid_argument where no hole has two surveys with depths in common, and as
/// ErrorsAtStations does.
WELLGYRO_EXPORT EmpiricalModel EstimateModel(std::span<const RepeatedHole> holes,
                                             const ErrorModel& assumed,
                                             const EmpiricalOptions& options = {});

}  // namespace wellgyro
