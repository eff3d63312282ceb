#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/fit/bench_checks_internal.h"
#include "wellgyro/fit/least_squares_internal.h"
#include "wellgyro/math/median.h"

namespace wellgyro {

Fault BenchFault(const BenchTable& data, std::string text, int line, FaultCode code) {
  return {.code = code, .text = std::move(text), .source = data.source, .line = line};
}

Result<std::vector<int>> FindColumns(const BenchTable& data,
                                     const std::vector<std::string>& names) {
  std::vector<int> places;
  std::vector<std::string> missing;
  for (const std::string& name : names) {
    const auto place = data.Find(name);
    if (place) places.push_back(*place);
    if (!place) missing.push_back(name);
  }
  if (missing.empty()) return places;
  return BenchFault(data,
                    fmt::format("the table has no column {}; it has {}", fmt::join(missing, ", "),
                                fmt::join(data.columns, ", ")),
                    1, FaultCode::kForeign);
}

std::string LinesText(const std::vector<int>& lines) {
  // Six numbers of three digits with their words are 45 letters: the message keeps to its point.
  constexpr std::size_t kShown = 6;
  const std::size_t shown = std::min(lines.size(), kShown);
  std::string text = lines.size() == 1 ? "line " : "lines ";
  text +=
      fmt::format("{}", fmt::join(lines.begin(), lines.begin() + static_cast<int>(shown), ", "));
  if (lines.size() > shown) text += fmt::format(" and {} more", lines.size() - shown);
  return text;
}

std::optional<Fault> TooFew(const BenchTable& data, int least, std::string_view what,
                            std::string_view advice) {
  if (data.rows() >= least) return std::nullopt;
  return BenchFault(
      data, fmt::format("{} {} are too few, {} are needed: {}", data.rows(), what, least, advice));
}

std::optional<Fault> Repeated(const BenchTable& data) {
  std::map<std::vector<double>, int> seen;
  for (int row = 0; row < data.rows(); ++row) {
    const Eigen::VectorXd values = data.values.row(row).transpose();
    // Of whole numbers, counts, two readings may.
    if (values == values.array().round().matrix()) continue;
    const auto [first, is_new] =
        seen.emplace(std::vector<double>(values.begin(), values.end()), row);
    if (is_new) continue;
    const int line = data.lines[static_cast<std::size_t>(row)];
    return BenchFault(data,
                      fmt::format("line {} repeats line {} to the last digit in every column: two "
                                  "readings never do; delete the copy, or measure again",
                                  line, data.lines[static_cast<std::size_t>(first->second)]),
                      line, FaultCode::kConflict);
  }
  return std::nullopt;
}

std::optional<std::pair<Eigen::Index, Eigen::Index>> CopyAmong(const Eigen::MatrixXd& readings) {
  std::map<std::vector<double>, Eigen::Index> seen;
  std::vector<Eigen::Index> first;
  std::optional<std::pair<Eigen::Index, Eigen::Index>> copy;
  double copies = 0;
  for (Eigen::Index row = 0; row < readings.rows(); ++row) {
    const Eigen::VectorXd values = readings.row(row).transpose();
    const auto [at, is_new] = seen.emplace(std::vector<double>(values.begin(), values.end()), row);
    if (is_new) first.push_back(row);
    if (!is_new && copies++ == 0) copy = {at->second, row};
  }
  if (!copy) return std::nullopt;
  const auto n = static_cast<double>(first.size());
  double expected = n - 1, repeats = 0;
  for (Eigen::Index c = 0; c < readings.cols(); ++c) {
    Eigen::VectorXd values = readings(first, c);
    std::sort(values.begin(), values.end());
    double alike = 0;
    for (Eigen::Index i = 1; i < values.size(); ++i) alike += values[i] == values[i - 1] ? 1 : 0;
    expected *= (alike + 1) / (n + 1);
    repeats += alike;
  }
  // Where values repeat besides, repeats hang together: of one attitude without noise all channels.
  const double m = repeats == 0 ? copies : 1;
  const double log_chance = m * std::log(expected) - std::lgamma(m + 1);
  return log_chance < std::log(kFalseAlarm) ? copy : std::nullopt;
}

std::optional<Fault> Copied(const BenchTable& data, const std::vector<int>& columns) {
  const auto copy = CopyAmong(data.values(Eigen::all, columns));
  if (!copy) return std::nullopt;
  const int line = data.lines[static_cast<std::size_t>(copy->second)];
  return BenchFault(data,
                    fmt::format("line {} repeats the readings of line {} to the last digit in "
                                "every channel: two readings never do; delete the copy, or "
                                "measure again",
                                line, data.lines[static_cast<std::size_t>(copy->first)]),
                    line, FaultCode::kConflict);
}

std::optional<Fault> Frozen(const BenchTable& data, const std::vector<int>& columns) {
  if (data.rows() < 3) return std::nullopt;
  for (const int column : columns) {
    const auto values = data.values.col(column);
    if (values.maxCoeff() != values.minCoeff()) continue;
    return BenchFault(
        data,
        fmt::format("column {} reads {} in all {} rows: the channel is frozen or not "
                    "connected; mend it and measure all positions again",
                    data.columns[static_cast<std::size_t>(column)], values[0], data.rows()),
        data.lines[0]);
  }
  return std::nullopt;
}

std::optional<Fault> MixedUnits(const BenchTable& data, const std::vector<int>& columns,
                                double expected, std::string_view what, std::string_view units) {
  std::vector<double> lengths;
  for (int row = 0; row < data.rows(); ++row) {
    double square = 0;
    for (const int column : columns) square += std::pow(data.values(row, column), 2);
    lengths.push_back(std::sqrt(square));
  }
  if (lengths.empty()) return std::nullopt;
  const double middle = Median(lengths);
  std::vector<int> lines;
  double example = 0;
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    if (lengths[i] < 3 * middle && lengths[i] > middle / 3) continue;
    lines.push_back(data.lines[i]);
    example = lengths[i];
  }
  // One row alone is a bad reading, and outliers are found later.
  if (lines.size() > 1) {
    return BenchFault(data,
                      fmt::format("{}: {} is {:.4g} where the other rows have {:.4g}: units are "
                                  "mixed; give every row in {}",
                                  LinesText(lines), what, example, middle, units),
                      lines.front(), FaultCode::kConflict);
  }
  if (expected > 0 && (middle > 2 * expected || middle < expected / 2)) {
    return BenchFault(
        data,
        fmt::format("{} is {:.4g} in the middle of the rows where {:.4g} is expected: "
                    "give the reference in the unit of the readings, {}",
                    what, middle, expected, units),
        data.lines[0]);
  }
  return std::nullopt;
}

std::optional<Fault> RadiansForDegrees(const BenchTable& data, const std::vector<int>& columns) {
  if (data.rows() < 6) return std::nullopt;
  double largest = 0;
  for (const int column : columns) {
    largest = std::max(largest, data.values.col(column).cwiseAbs().maxCoeff());
  }
  if (largest == 0 || largest > kTwoPi + 0.01) return std::nullopt;
  return BenchFault(data,
                    fmt::format("no angle in the table is larger than {:.4g}: they look like "
                                "radians; give degrees",
                                largest),
                    data.lines[0]);
}

std::optional<Fault> OtherRate(const BenchTable& data, const std::string& channel,
                               double sensitivity) {
  // Factor off one: a maker's scale is within some per cent of its unit, while one deg/h is 1/57 of
  // a rad/h, 1/3600 of a deg/s and 1000 mdeg/h.
  constexpr double kOtherUnit = 5;
  if (sensitivity > 1 / kOtherUnit && sensitivity < kOtherUnit) return std::nullopt;
  return BenchFault(
      data,
      fmt::format("channel {} reads {:.4g} for one deg/h: give its readings in deg/h, "
                  "and the rates of a rate table in deg/s",
                  channel, sensitivity),
      data.lines[0], FaultCode::kConflict);
}

std::optional<Fault> SwappedPositions(const BenchTable& data,
                                      const std::vector<UprightReading>& readings) {
  std::vector<int> lines;
  for (int c = 0; c < 3; ++c) {
    double up = 0, down = 0, n_up = 0, n_down = 0;
    for (const UprightReading& reading : readings) {
      if (reading.channel != c) continue;
      (reading.sign > 0 ? up : down) += reading.value;
      (reading.sign > 0 ? n_up : n_down) += 1;
    }
    if (n_up == 0 || n_down == 0) continue;
    const double middle = (up / n_up + down / n_down) / 2, half = up / n_up - middle;
    for (const UprightReading& reading : readings) {
      if (reading.channel == c && (reading.value - middle) * reading.sign * half < 0) {
        lines.push_back(reading.line);
      }
    }
  }
  if (lines.empty()) return std::nullopt;
  std::sort(lines.begin(), lines.end());
  lines.erase(std::unique(lines.begin(), lines.end()), lines.end());
  return BenchFault(data,
                    fmt::format("{}: the upright axis reads as the others do upside down: up and "
                                "down are swapped in these positions; measure them again",
                                LinesText(lines)),
                    lines.front(), FaultCode::kConflict);
}

ReadingPlaces ReadingPlacesOf(const BenchTable& data) {
  return {LinesText,
          [&data](std::string text, int line) { return BenchFault(data, std::move(text), line); }};
}

std::optional<Fault> DoesNotFit(const BenchTable& data, const std::vector<ChannelSignal>& signals,
                                FitReport& report) {
  return DoesNotFit(ReadingPlacesOf(data), signals, report);
}

std::optional<Fault> DoesNotFit(const ReadingPlaces& places,
                                const std::vector<ChannelSignal>& signals, FitReport& report) {
  // Readings with a wrong sign, a share p of them, leave 2 sqrt(p) of the signal: 0.2 is one in a
  // hundred.
  constexpr double kRefused = 0.2;
  std::map<std::string, std::vector<const FitResidual*>> of;
  for (const FitResidual& residual : report.residuals) of[residual.channel].push_back(&residual);
  for (auto& entry : of) {
    const std::string& channel = entry.first;
    std::vector<const FitResidual*>& residuals = entry.second;
    const auto known = std::find_if(signals.begin(), signals.end(), [&](const ChannelSignal& s) {
      return channel.rfind(s.channel, 0) == 0;
    });
    if (known == signals.end() || !(known->signal > 0)) continue;
    double square = 0;
    for (const FitResidual* residual : residuals) square += residual->value * residual->value;
    const double rms = std::sqrt(square / static_cast<double>(residuals.size()));
    if (!(rms > kCoarseShare * known->signal)) continue;
    std::sort(residuals.begin(), residuals.end(), [](const FitResidual* a, const FitResidual* b) {
      return std::abs(a->value) > std::abs(b->value);
    });
    std::vector<int> worst;
    for (std::size_t i = 0; i < residuals.size() && i < 3; ++i) worst.push_back(residuals[i]->line);
    const std::string text = fmt::format(
        "channel {} scatters about the fit by {:.3g}, {:.0f} % of what it should vary by, worst in "
        "{}: look there for swapped positions, wrong signs, mixed units or a wrong reference, or "
        "average longer",
        channel, rms, 100 * rms / known->signal, places.text(worst));
    if (rms > kRefused * known->signal) {
      return places.fault("the readings do not fit: " + text, worst.front());
    }
    report.remarks.push_back(text);
  }
  return std::nullopt;
}

std::optional<Fault> WrongAxes(const BenchTable& data, const Eigen::Matrix3d& sensitivity,
                               const std::vector<std::string>& channels) {
  static constexpr std::string_view kAxes = "xyz";
  for (int c = 0; c < 3; ++c) {
    Eigen::Index most = 0;
    const double value = sensitivity.row(c).cwiseAbs().maxCoeff(&most);
    const std::string& channel = channels[static_cast<std::size_t>(c)];
    if (most != c) {
      return BenchFault(
          data,
          fmt::format("channel {} follows {}{}: its axis is not {}; exchange the columns, or "
                      "mend the names of the positions",
                      channel, sensitivity(c, most) < 0 ? "-" : "",
                      kAxes[static_cast<std::size_t>(most)], kAxes[static_cast<std::size_t>(c)]));
    }
    if (sensitivity(c, c) < 0) {
      return BenchFault(
          data,
          fmt::format("channel {} falls by {:.4g} where {} rises by one: its sign is wrong, or "
                      "up and down of {} are swapped",
                      channel, value, kAxes[static_cast<std::size_t>(c)],
                      kAxes[static_cast<std::size_t>(c)]));
    }
  }
  return std::nullopt;
}

}  // namespace wellgyro
