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

// Rows of one channel of one table, among those that the solution used, in their order.
struct ChannelRows {
  std::string channel;
  std::vector<Eigen::Index> in_problem;
};

std::vector<ChannelRows> ChannelsOf(const LinearProblem& problem, const LinearSolution& solution) {
  const std::set<int> out(solution.outlier_lines.begin(), solution.outlier_lines.end());
  std::map<std::pair<bool, std::string>, ChannelRows> channels;
  for (std::size_t i = 0; i < problem.rows.size(); ++i) {
    const FitRow& row = problem.rows[i];
    if (row.line == 0 || !row.in_time || out.count(row.line) > 0) continue;
    ChannelRows& channel = channels[{row.line < 0, row.channel}];
    channel.channel = row.line < 0 ? "table " + row.channel : row.channel;
    channel.in_problem.push_back(static_cast<Eigen::Index>(i));
  }
  std::vector<ChannelRows> list;
  for (auto& [key, channel] : channels) {
    if (channel.in_problem.size() >= kFewestRows) list.push_back(std::move(channel));
  }
  return list;
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
      : problem_(problem),
        added_(problem, solution),
        temperatures_(std::move(temperatures)),
        channels_(ChannelsOf(problem, solution)) {
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
        const auto row = static_cast<std::size_t>(channels_[c].in_problem[first]);
        Tell(fmt::format("channel {}: from {} on the residuals are {:.3g} beside those before",
                         channels_[c].channel, name(std::abs(problem_.rows[row].line)),
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
  // From -1/2 to 1/2 over each channel's own rows; all channels together, so that what moves them
  // all does not pass for the others' scatter. Not of channels whose abscissae are unknown or vary
  // by less than `swing`.
  template <typename Abscissa>
  std::vector<AddedTerm> Slopes(const Abscissa& of, double swing) const {
    Eigen::MatrixXd Z = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(problem_.rows.size()),
                                              static_cast<Eigen::Index>(channels_.size()));
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      const std::vector<Eigen::Index>& rows = channels_[c].in_problem;
      Eigen::VectorXd at(static_cast<Eigen::Index>(rows.size()));
      std::transform(rows.begin(), rows.end(), at.begin(), [&](Eigen::Index i) {
        return of(problem_.rows[static_cast<std::size_t>(i)]);
      });
      if (!at.allFinite()) continue;
      const double least = at.minCoeff(), width = at.maxCoeff() - least;
      if (!(width > 0) || width < swing) continue;
      Z(rows, static_cast<Eigen::Index>(c)) = (at.array() - least) / width - 0.5;
    }
    return added_.Test(Z, each_);
  }

  std::size_t StepOf(const ChannelRows& channel, AddedTerm& step) const {
    const std::vector<Eigen::Index>& rows = channel.in_problem;
    const std::size_t first = added_.LikeliestStep(rows);
    if (first == 0) return 0;
    Eigen::MatrixXd z = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(problem_.rows.size()), 1);
    for (std::size_t i = first; i < rows.size(); ++i) z(rows[i], 0) = 1;
    // The likeliest of so many.
    step = added_.Test(z, each_ / static_cast<double>(rows.size())).front();
    return first;
  }

  static void TellSlope(const ChannelRows& channel, const AddedTerm& slope,
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

  const LinearProblem& problem_;
  AddedTerms added_;
  std::map<int, double> temperatures_;
  std::vector<ChannelRows> channels_;
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
