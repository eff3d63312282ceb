#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <fmt/core.h>

#include "wellgyro/fit/added_terms_internal.h"
#include "wellgyro/fit/residual_trends_internal.h"

namespace wellgyro {
namespace {

// Rows of a channel, below which nothing is tested: a step has kBesideStep on either side.
constexpr std::size_t kFewestRows = 2 * kBesideStep;
// [degC], what thermometers agree to: where temperatures vary by less their slope is noise.
constexpr double kLeastSwing = 1;

// Readings of one channel of one table, among those that the solution used, in their order.
struct ChannelReadings {
  std::string channel;
  std::vector<const FitRow*> labels;
  std::vector<ReadingUnit> units;
};

// Channels that rows hold together.
void AddSensed(const LinearProblem& problem, const std::set<int>& out, const AddedTerms& added,
               std::vector<ChannelReadings>& channels) {
  for (const SensedChannel& sensed : problem.sensed) {
    ChannelReadings channel;
    channel.channel = sensed.name;
    for (std::size_t k = 0; k < sensed.first.size(); ++k) {
      const FitRow& row = problem.rows[static_cast<std::size_t>(sensed.first[k])];
      if (out.count(row.line) > 0) continue;
      channel.labels.push_back(&row);
      channel.units.push_back(added.UnitAt(sensed.first[k], sensed.spread[k]));
    }
    channels.push_back(std::move(channel));
  }
}

std::vector<ChannelReadings> ChannelsOf(const LinearProblem& problem,
                                        const LinearSolution& solution, const AddedTerms& added) {
  const std::set<int> out(solution.outlier_lines.begin(), solution.outlier_lines.end());
  std::map<std::pair<bool, std::string>, ChannelReadings> by_name;
  for (std::size_t i = 0; i < problem.rows.size(); ++i) {
    const FitRow& row = problem.rows[i];
    if (row.line == 0 || !row.in_time || out.count(row.line) > 0) continue;
    ChannelReadings& channel = by_name[{row.line < 0, row.channel}];
    channel.channel = row.line < 0 ? "table " + row.channel : row.channel;
    channel.labels.push_back(&row);
    channel.units.push_back(added.UnitOf(i));
  }
  std::vector<ChannelReadings> channels;
  for (auto& [key, channel] : by_name) channels.push_back(std::move(channel));
  AddSensed(problem, out, added, channels);
  std::erase_if(channels, [](const ChannelReadings& c) { return c.labels.size() < kFewestRows; });
  return channels;
}

std::map<int, double> TemperatureOf(const BenchTable& data) {
  std::map<int, double> of;
  const auto column = data.Find("T_C");
  for (int i = 0; column && i < data.rows(); ++i) {
    of[data.lines[static_cast<std::size_t>(i)]] = data.values(i, *column);
  }
  return of;
}

// Tests of one fit's residuals, which share its rate of false alarms.
class Trends {
 public:
  Trends(const LinearProblem& problem, const LinearSolution& solution,
         std::map<int, double> temperatures)
      : added_(problem, solution),
        temperatures_(std::move(temperatures)),
        channels_(ChannelsOf(problem, solution, added_)) {
    const double kinds = temperatures_.empty() ? 2 : 3;
    each_ = kFalseAlarm / 2 / kinds / std::max<double>(1, static_cast<double>(channels_.size()));
  }

  /// The likelier of a slope and a step in the order of the readings, and a slope in temperature.
  void TellAll(const LineNames& name, FitReport& report) const {
    const auto order = [](const FitRow& row) { return std::abs(static_cast<double>(row.line)); };
    const std::vector<AddedTerm> slopes = Slopes(order, 0);
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      AddedTerm step;
      const std::size_t first = StepOf(channels_[c], step);
      if (step.sigmas > step.limit && step.sigmas > slopes[c].sigmas) {
        Tell(fmt::format("channel {}: from {} on the residuals are {:.3g} beside those before",
                         channels_[c].channel, name(std::abs(channels_[c].labels[first]->line)),
                         step.coefficient),
             step, report);
        continue;
      }
      TellSlope(channels_[c], slopes[c], "the order of the readings", report);
    }
    const auto temperature = [&](const FitRow& row) {
      const auto found = temperatures_.find(row.line);
      return found != temperatures_.end() ? found->second : NAN;
    };
    const std::vector<AddedTerm> warmed = Slopes(temperature, kLeastSwing);
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      TellSlope(channels_[c], warmed[c], "the temperature", report);
    }
  }

 private:
  // From -1/2 to 1/2 over each channel's own readings; all channels together, so that what moves
  // them all does not pass for the others' scatter. Not of channels whose abscissae are unknown or
  // vary by less than `swing`.
  template <typename Abscissa>
  std::vector<AddedTerm> Slopes(const Abscissa& of, double swing) const {
    Eigen::MatrixXd z =
        Eigen::MatrixXd::Zero(added_.used(), static_cast<Eigen::Index>(channels_.size()));
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      const ChannelReadings& channel = channels_[c];
      Eigen::VectorXd at(static_cast<Eigen::Index>(channel.labels.size()));
      std::transform(channel.labels.begin(), channel.labels.end(), at.begin(),
                     [&](const FitRow* row) { return of(*row); });
      if (!at.allFinite()) continue;
      const double least = at.minCoeff(), width = at.maxCoeff() - least;
      if (!(width > 0) || width < swing) continue;
      Add(channel, 0, (at.array() - least) / width - 0.5, z.col(static_cast<Eigen::Index>(c)));
    }
    return added_.TestWhitened(z, each_);
  }

  std::size_t StepOf(const ChannelReadings& channel, AddedTerm& step) const {
    const std::size_t first = added_.LikeliestStep(channel.units);
    if (first == 0) return 0;
    Eigen::MatrixXd z = Eigen::MatrixXd::Zero(added_.used(), 1);
    const auto n = static_cast<Eigen::Index>(channel.units.size());
    Add(channel, first, Eigen::VectorXd::Ones(n), z.col(0));
    // The likeliest of so many.
    step = added_.TestWhitened(z, each_ / static_cast<double>(n)).front();
    return first;
  }

  // `size` of the channel's readings from `first` on.
  static void Add(const ChannelReadings& channel, std::size_t first, const Eigen::VectorXd& size,
                  Eigen::MatrixXd::ColXpr z) {
    for (std::size_t k = first; k < channel.units.size(); ++k) {
      const ReadingUnit& unit = channel.units[k];
      z.segment(unit.first, unit.z.size()) += size[static_cast<Eigen::Index>(k)] * unit.z;
    }
  }

  static void TellSlope(const ChannelReadings& channel, const AddedTerm& slope,
                        std::string_view against, FitReport& report) {
    if (!(slope.sigmas > slope.limit)) return;
    Tell(fmt::format("channel {}: the residuals follow {}, by {:.3g} from end to end",
                     channel.channel, against, slope.coefficient),
         slope, report);
  }

  static void Tell(const std::string& what, const AddedTerm& term, FitReport& report) {
    report.remarks.push_back(fmt::format(
        "{} ({:.1f} of its sigmas, chance reaches {:.1f}); with a term for it {} would move by "
        "{:.1f} of its sigmas: repeat what was measured first",
        what, term.sigmas, term.limit, term.moved, term.moved_sigmas));
  }

  AddedTerms added_;
  std::map<int, double> temperatures_;
  std::vector<ChannelReadings> channels_;
  double each_ = 0;
};

}  // namespace

void TestTrends(const BenchTable& data, const LinearProblem& problem,
                const LinearSolution& solution, const LineNames& name, FitReport& report) {
  if (solution.dof < 4 || solution.cov.size() == 0) return;
  const std::size_t before = report.remarks.size();
  Trends(problem, solution, TemperatureOf(data)).TellAll(name, report);
  if (report.remarks.size() > before || solution.outlier_lines.empty()) return;
  // Of a table that drifts, what was left out may be the drift.
  LinearProblem whole = problem;
  whole.robust = false;
  Trends(whole, Solve(whole), TemperatureOf(data)).TellAll(name, report);
}

void RemarkTemperature(const BenchTable& data, FitReport& report) {
  const auto column = data.Find("T_C");
  if (!column) return;
  const double low = data.values.col(*column).minCoeff();
  const double high = data.values.col(*column).maxCoeff();
  if (high - low < kLeastSwing) return;
  report.remarks.push_back(
      fmt::format("the temperatures of the table, {:.4g} to {:.4g} degC, play no part in this "
                  "method: what they "
                  "do to the sensors is in the result; calibrate tool fits them",
                  low, high));
}

}  // namespace wellgyro
