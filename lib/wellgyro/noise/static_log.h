#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/noise/allan_variance.h"

namespace wellgyro {

/// Something that makes a log less than static.
struct LogFinding {
  enum class Kind {
    kConstant,     ///< one value throughout: nothing measures
    kSaturated,    ///< readings pile up at the largest or smallest value
    kStuck,        ///< the reading stood still for a while
    kMoved,        ///< the mean or the scatter jumped, and came back
    kStep,         ///< the mean jumped, and stayed
    kTemperature,  ///< the mean follows the temperature
    kWarmUp,       ///< the mean settles from the begin of the log on
    kDrift,        ///< the mean goes one way through the log
  };
  Kind kind = Kind::kMoved;
  SampleGap where;  ///< the stretch; for drifts the tenth of the log where it is fastest
  double size = 0;  ///< jump, pile's value, value stood at, or drift over the log [data's unit]
  double typical =
      0;  ///< what the log does otherwise: jump or scatter between means of that length
  std::int64_t samples = 0;             ///< affected
  std::optional<double> per_degree;     ///< kTemperature: slope [data's unit per degC]
  std::optional<double> time_constant;  ///< kWarmUp [samples]
};

struct StaticLogOptions {
  /// The converter's ends, where known: readings there are saturated.
  std::optional<double> lowest;
  std::optional<double> highest;
  /// Of every sample [degC]; empty where not recorded.
  std::span<const float> temperature;
};

/// What a log that should be static was not, in order of kind and place; at most a hundred of each
/// kind. Works on means over 1/2000 of the log (at least 16 samples).
///
/// Step: besides those that show between neighbouring means, one whose evidence by all means before
/// and behind it (likelihood of white noise about a walk, with the step and without) is beyond
/// what sound logs have, where nothing else is told of the log. Moved: neighbouring means differ by
/// more than eight times what they usually do, or the scatter within exceeds the usual likewise; a
/// movement much shorter than such a stretch and no larger than the noise goes unseen. Saturated:
/// an end of the converter, or an extreme value that comes three times in a row and more than twice
/// as often as the next. Temperature: a straight line in temperature explains nine tenths of the
/// slow changes. Warm-up: an exponential from the begin does, and leaves less than half of what a
/// straight line in time leaves. Drift: that line does.
WELLGYRO_EXPORT std::vector<LogFinding> InspectStaticLog(std::span<const double> rate,
                                                         std::span<const SampleGap> gaps,
                                                         const StaticLogOptions& options = {});

}  // namespace wellgyro
