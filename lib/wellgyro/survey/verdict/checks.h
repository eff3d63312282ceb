#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/depth/cable.h"
#include "wellgyro/record/check.h"
#include "wellgyro/record/north_fix.h"
#include "wellgyro/record/station.h"
#include "wellgyro/survey/job.h"
#include "wellgyro/survey/survey.h"

namespace wellgyro {

/// A foresight, and what the run's attitude says of the same direction.
struct Foresight {
  std::int32_t run = 0;
  double stated = 0;               ///< true direction of the reference mark [rad]
  double sigma_stated = 0;         ///< [rad]
  std::optional<double> measured;  ///< absent: the run has no azimuth at that time [rad]
  double sigma_measured = 0;       ///< [rad]
};

/// The depth read when the tool was back at zero.
struct ReturnToZero {
  std::int32_t run = 0;
  std::optional<double> read_md;  ///< what the depth system said [m]; absent: no depth at that time
  double value_md = 0;            ///< what it should have said [m]
  double sigma = 0;               ///< [m]
};

/// Depth marks that were left out.
struct MarksRefused {
  std::int64_t impossible = 0;  ///< no depth, or far off their neighbours
  std::int64_t late = 0;        ///< later than the depth latency allows
  std::int64_t all() const { return impossible + late; }
};

/// What can be checked of one job.
struct CheckInputs {
  std::span<const RunSummary> runs;
  std::span<const Station> passes;
  std::span<const Foresight> foresights;
  std::span<const ReturnToZero> returns;
  const CableMarks* marks = nullptr;
  MarksRefused marks_refused = {};
  std::optional<double> deepest_mark = {};  ///< [m]; absent: not known
};

/// `value` against `limit`: passes up to two thirds of it, warns up to it, fails beyond.
WELLGYRO_EXPORT Verdict Judge(double value, double limit);

/// The depths of stations.at below the tie-in of which `chosen` has no station; as many as there
/// are. Depth in the hole that the run did not reach is the commonest reason.
WELLGYRO_EXPORT Check CheckAsked(const Job& job, std::span<const Station> chosen);

/// All checks of a job, in a fixed order; those that could not be made say not_done. Limits come
/// from [acceptance] or are three sigma of the check's own error.
WELLGYRO_EXPORT std::vector<Check> MakeChecks(const Job& job, const CheckInputs& inputs);

}  // namespace wellgyro
