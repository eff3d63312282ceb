#include "wellgyro/calibration/history.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/calibration/error_sources.h"
#include "wellgyro/calibration/members.h"
#include "wellgyro/math/median.h"
#include "wellgyro/math/statistics.h"

namespace wellgyro {
namespace {

const ParameterCovariance& KnownOf(const ToolCalibration& tool) {
  const SensorGroup& group = tool.gyro.covariance ? tool.gyro : tool.accel;
  if (!group.covariance || !tool.calibrated) {
    throw std::invalid_argument(
        fmt::format("tool {}: a history needs calibrations with their date and the covariance that "
                    "calibrate tool writes",
                    tool.asset_serial));
  }
  // Its change from the calibration that it rests on is less than the tool's, and the covariances
  // of both count the same readings.
  if (tool.rests_on_prior) {
    throw std::invalid_argument(
        fmt::format("tool {}: a calibration that rests on a prior does not show by itself how the "
                    "tool changed: give the bench's own, made without --prior and not by calibrate "
                    "learn",
                    tool.asset_serial));
  }
  return *group.covariance;
}

double DaysBetween(const ToolCalibration& a, const ToolCalibration& b) {
  return (*b.calibrated - *a.calibrated).seconds() / units::kDay;
}

// What samples calibrated by the older model would be off, were the newer one right.
Eigen::VectorXd ChangeOf(const ToolCalibration& older, const ToolCalibration& newer,
                         double temperature) {
  const ParameterCovariance& known = KnownOf(newer);
  const auto n = static_cast<Eigen::Index>(known.names.size());
  Eigen::VectorXd moved(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const CalibrationMember member = MemberOf(known.names[static_cast<std::size_t>(k)]);
    moved[k] = ValueOf(older, member) - ValueOf(newer, member);
  }
  return SourceEffects(newer, known.names, temperature) * moved;
}

double Reach(double false_alarm, std::size_t n) {
  return -NormalQuantile(false_alarm / 2 / static_cast<double>(std::max<std::size_t>(n, 1)));
}

// Variance of a walk per day that `changes` over `days` do not exceed in five of six tools: the one
// sigma limit of theirs, with n degrees of freedom for n changes, less what both calibrations'
// sigmas make of it. From one or two changes the estimate itself says next to nothing.
double WalkAtMost(const SourceHistory& source, double days) {
  double squares = 0, known = 0;
  for (std::size_t k = 0; k < source.changes.size(); ++k) {
    squares += std::pow(source.changes[k], 2);
    known += std::pow(source.sigmas[k], 2);
  }
  const auto n = static_cast<double>(source.changes.size());
  return std::max(0.0, squares * n / ChiSquareQuantile(NormalCdf(-1), n) - known) / days;
}

ToolHistory HistoryOf(std::vector<const ToolCalibration*> tools, const HistorySetup& setup) {
  std::sort(tools.begin(), tools.end(), [](const ToolCalibration* a, const ToolCalibration* b) {
    return *a->calibrated < *b->calibrated;
  });
  const auto twice = std::adjacent_find(tools.begin(), tools.end(),
                                        [](const ToolCalibration* a, const ToolCalibration* b) {
                                          return !(*a->calibrated < *b->calibrated);
                                        });
  if (twice != tools.end()) {
    throw std::invalid_argument(fmt::format(
        "tool {}: two calibrations of one date: give each once, with the date that it was made",
        (*twice)->asset_serial));
  }
  ToolHistory history;
  history.asset_serial = tools.front()->asset_serial;
  const CalibrationSources last = SourcesOf(*tools.back(), setup.temperature);
  for (std::size_t i = 0; i < last.names.size(); ++i) {
    if (last.cov(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) > 0) {
      history.sources.push_back({.name = last.names[i]});
    }
  }
  history.reach = Reach(setup.false_alarm, history.sources.size());
  for (std::size_t k = 1; k < tools.size(); ++k) {
    history.days.push_back(DaysBetween(*tools[k - 1], *tools[k]));
    const Eigen::VectorXd change = ChangeOf(*tools[k - 1], *tools[k], setup.temperature);
    const CalibrationSources a = SourcesOf(*tools[k - 1], setup.temperature);
    const CalibrationSources b = SourcesOf(*tools[k], setup.temperature);
    for (SourceHistory& source : history.sources) {
      const Eigen::Index at = last.At(source.name);
      source.changes.push_back(change[at]);
      source.sigmas.push_back(std::sqrt(a.cov(at, at) + b.cov(at, at)));
    }
  }
  for (SourceHistory& source : history.sources) {
    double excess = 0, days = 0;
    for (std::size_t k = 0; k < source.changes.size(); ++k) {
      excess += std::pow(source.changes[k], 2) - std::pow(source.sigmas[k], 2);
      days += history.days[k];
    }
    source.walk_per_sqrt_day = days > 0 ? std::sqrt(std::max(0.0, excess) / days) : 0;
    const Eigen::Index at = last.At(source.name);
    if (days > 0) {
      source.prior_sigma =
          std::sqrt(last.cov(at, at) + WalkAtMost(source, days) * setup.days_ahead);
    }
    source.shifted = !source.changes.empty() &&
                     std::abs(source.changes.back()) > history.reach * source.sigmas.back();
  }
  return history;
}

// Of one source, logarithms of the root mean square of changes against the other tools'. Beyond
// five robust sigmas of these, and beyond what the few changes of a tool do by chance.
void CompareTools(const std::string& name, double false_alarm,
                  std::vector<ToolHistory>& histories) {
  std::vector<double> logs;
  std::vector<SourceHistory*> of;
  for (ToolHistory& history : histories) {
    for (SourceHistory& source : history.sources) {
      if (source.name != name || source.changes.empty()) continue;
      double square = 0, days = 0;
      for (std::size_t k = 0; k < source.changes.size(); ++k) {
        square += std::pow(source.changes[k], 2);
        days += history.days[k];
      }
      if (!(square > 0) || !(days > 0)) continue;
      logs.push_back(std::log(square / days) / 2);
      of.push_back(&source);
    }
  }
  if (of.size() < kToolsOfFamily) return;
  const double middle = Median(logs);
  constexpr double kUnlike = 5;  // robust sigmas of the logarithm, P(x > 5) = 2.9e-7
  const double spread = RobustSigma(logs, middle);
  for (std::size_t i = 0; i < of.size(); ++i) {
    const auto changes = static_cast<double>(of[i]->changes.size());
    const double chance =
        std::log(ChiSquareQuantile(1 - false_alarm, changes) / ChiSquareQuantile(0.5, changes)) / 2;
    of[i]->out_of_family = logs[i] - middle > std::max(kUnlike * spread, chance);
  }
}

}  // namespace

std::vector<ToolHistory> HistoriesOf(std::span<const ToolCalibration> calibrations,
                                     const HistorySetup& setup) {
  std::map<std::string, std::vector<const ToolCalibration*>> tools;
  for (const ToolCalibration& calibration : calibrations) {
    KnownOf(calibration);
    tools[calibration.asset_serial].push_back(&calibration);
  }
  std::vector<ToolHistory> histories;
  for (auto& [serial, list] : tools) histories.push_back(HistoryOf(list, setup));
  if (histories.empty()) return histories;
  const auto names = SourcesOf(calibrations.front(), setup.temperature).names;
  const double false_alarm = setup.false_alarm / static_cast<double>(names.size());
  for (const std::string& name : names) CompareTools(name, false_alarm, histories);
  return histories;
}

}  // namespace wellgyro
