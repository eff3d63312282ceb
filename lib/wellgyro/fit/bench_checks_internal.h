#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/result.h"
#include "wellgyro/base/units.h"
#include "wellgyro/calibration/bench_table.h"
#include "wellgyro/calibration/fit_report.h"
#include "wellgyro/fit/bench_reference.h"

namespace wellgyro {

/// Readings more than unknowns, from which on a bench finds its own noise: a sigma of n of them is
/// known to 1 / sqrt(2 n), of 30 to 13 %.
inline constexpr int kToFindNoise = 30;

/// Scatter about a fit, over what the channel should vary by, from which on it is said: 0.02 is
/// 0.3 deg/h of the Earth's rate or 20 mg, coarser than any tool that finds north.
inline constexpr double kCoarseShare = 0.02;

inline constexpr double kBenchEarthDegPerHour = kBenchEarthRate / units::kDegPerHour;

/// The complaint about a table of readings; `advice` says what to measure next.
Fault BenchFault(const BenchTable& data, std::string text, int line = 0,
                 FaultCode code = FaultCode::kRange);

/// Places of the named columns; a Fault that names those that are missing.
Result<std::vector<int>> FindColumns(const BenchTable& data, const std::vector<std::string>& names);

/// "lines 3, 7 and 12 more".
std::string LinesText(const std::vector<int>& lines);

// Each gives the Fault, or the remark, if any.

/// Fewer rows than `least`.
std::optional<Fault> TooFew(const BenchTable& data, int least, std::string_view what,
                            std::string_view advice);
/// Two rows alike to the last digit in every column.
std::optional<Fault> Repeated(const BenchTable& data);
/// Two rows of readings, a column a channel, alike to the last digit in every channel, the second
/// behind the first, where chance does not make them so. Of the other rows' n values of a channel,
/// in their order, k neighbours are alike: the next two are so by chance in (k + 1) of (n + 1)
/// cases (Laplace's rule of succession), and in all channels at once in the product of these, so
/// that h of all neighbours are expected to be. Chance reaches m copies in less than h^m / m! of
/// tables (Poisson), which is to be below 0.01: rounded readings may repeat. Where
/// other values repeat, m counts as one.
std::optional<std::pair<Eigen::Index, Eigen::Index>> CopyAmong(const Eigen::MatrixXd& readings);
/// The same in these columns of a table, under whatever times or labels.
std::optional<Fault> Copied(const BenchTable& data, const std::vector<int>& columns);
/// A column that reads the same in every row.
std::optional<Fault> Frozen(const BenchTable& data, const std::vector<int>& columns);
/// Rows whose vector (of three columns) is longer or shorter than the others' by more than a factor
/// of three; and all of them against `expected` where it is above zero. `units` as "g, or m/s2".
std::optional<Fault> MixedUnits(const BenchTable& data, const std::vector<int>& columns,
                                double expected, std::string_view what, std::string_view units);
/// Angles that look like radians.
std::optional<Fault> RadiansForDegrees(const BenchTable& data, const std::vector<int>& columns);
/// A gyro that reads another unit of rate than deg/h: between deg/s, deg/h, rad/s and rpm lies no
/// factor below six.
std::optional<Fault> OtherRate(const BenchTable& data, const std::string& channel,
                               double sensitivity);
/// A reading of the axis that stands upright.
struct UprightReading {
  int channel = 0;
  double sign = 1;  ///< +1 up, -1 down
  double value = 0;
  int line = 0;
};
/// Readings on the wrong side of their channel's middle: up and down swapped in some positions.
/// Where all of a channel are, WrongAxes says so.
std::optional<Fault> SwappedPositions(const BenchTable& data,
                                      const std::vector<UprightReading>& readings);
/// What a channel (by the begin of its name) varies by, in its unit.
struct ChannelSignal {
  std::string channel;
  double signal = 0;
};
/// How people find the readings of a report that stand in its residuals by line.
struct ReadingPlaces {
  std::function<std::string(const std::vector<int>&)> text;  ///< "lines 3, 7"
  std::function<Fault(std::string text, int line)> fault;    ///< at one of them
};
ReadingPlaces ReadingPlacesOf(const BenchTable& data);  ///< of one table; `data` must outlive it
/// Residuals so large that the model is none of these readings (a fifth of the signal); a remark
/// from a fiftieth on. Names the worst lines.
std::optional<Fault> DoesNotFit(const ReadingPlaces& places,
                                const std::vector<ChannelSignal>& signals, FitReport& report);
std::optional<Fault> DoesNotFit(const BenchTable& data, const std::vector<ChannelSignal>& signals,
                                FitReport& report);
/// A square sensitivity whose diagonal is not what dominates its rows: axes or signs.
std::optional<Fault> WrongAxes(const BenchTable& data, const Eigen::Matrix3d& sensitivity,
                               const std::vector<std::string>& channels);

}  // namespace wellgyro
