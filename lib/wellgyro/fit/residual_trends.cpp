#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/fit/residual_trends_internal.h"
#include "wellgyro/math/statistics.h"

namespace wellgyro {
namespace {

constexpr double kFalseAlarm = 0.01;
constexpr int kFewestRows = 8;     // rows of a channel, below which nothing is tested
constexpr double kLeastSwing = 1;  // degC

// Rows of one channel of one table, among those that the solution used.
struct ChannelRows {
  std::string channel;
  std::vector<Eigen::Index> rows, in_problem;
};

std::vector<ChannelRows> ChannelsOf(const LinearProblem& problem, const LinearSolution& solution) {
  const std::set<int> out(solution.outlier_lines.begin(), solution.outlier_lines.end());
  std::map<std::pair<bool, std::string>, ChannelRows> channels;
  Eigen::Index used = 0;
  for (std::size_t i = 0; i < problem.rows.size(); ++i) {
    const FitRow& row = problem.rows[i];
    if (out.count(row.line) > 0) continue;
    const Eigen::Index at = used++;
    if (row.line == 0) continue;
    ChannelRows& channel = channels[{row.line < 0, row.channel}];
    channel.channel = row.line < 0 ? "table " + row.channel : row.channel;
    channel.rows.push_back(at);
    channel.in_problem.push_back(static_cast<Eigen::Index>(i));
  }
  std::vector<ChannelRows> list;
  for (auto& [key, channel] : channels) {
    if (static_cast<int>(channel.rows.size()) >= kFewestRows) list.push_back(std::move(channel));
  }
  return list;
}

struct Trend {
  double t = 0, limit = 0;
  double change = 0;  // from the least to the largest abscissa [data's unit]
  std::string moved;  // parameter that it would move most
  double moved_sigmas = 0;
};

// The term `z` (one a row of the channel) added to the model: r is at right angles to the model's
// columns, so that z'r needs no projection; z'z does.
Trend TrendAlong(const LinearProblem& problem, const LinearSolution& solution,
                 const ChannelRows& channel, const std::vector<double>& z, double probability) {
  const double variance =
      problem.sigma_given ? 1 : solution.chi_square / static_cast<double>(solution.dof);
  if (!(variance > 0)) return {};
  double zr = 0, zz = 0;
  Eigen::VectorXd h = Eigen::VectorXd::Zero(problem.size());
  const auto [least, most] = std::minmax_element(z.begin(), z.end());
  const double middle = (*least + *most) / 2, half = (*most - *least) / 2;
  if (!(half > 0)) return {};
  for (std::size_t i = 0; i < z.size(); ++i) {
    const Eigen::Index row = channel.in_problem[i];
    // One of the data's unit at the end, over what that unit is of the whitened residual.
    const double value = (z[i] - middle) / half / problem.rows[static_cast<std::size_t>(row)].unit;
    zr += value * solution.residual[channel.rows[i]];
    zz += value * value;
    h += value / problem.sigma[row] * problem.A.row(row).transpose();
  }
  const Eigen::VectorXd move = solution.cov * h / variance;
  const double left = zz - h.dot(move);
  // What the model holds already cannot be tested, nor what it holds but for a thousandth: the
  // noise of its own columns makes such a remainder, as where temperatures rise from row to row.
  if (!(left > 1e-3 * zz)) return {};
  Trend trend;
  const double beta = zr / left;
  const double freed = std::max(solution.chi_square - zr * beta, 0.0);
  const double dof = solution.dof - 1;
  const double scatter = problem.sigma_given ? 1 : std::sqrt(freed / dof);
  trend.t = scatter > 0 ? std::abs(beta) * std::sqrt(left) / scatter : 0;
  trend.limit = problem.sigma_given ? -NormalQuantile(probability) : StudentLimit(probability, dof);
  trend.change = 2 * beta;
  const Eigen::VectorXd sigma = solution.cov.diagonal().cwiseMax(0).cwiseSqrt();
  for (Eigen::Index i = 0; i < move.size(); ++i) {
    const double sigmas = sigma[i] > 0 ? std::abs(beta * move[i]) / sigma[i] : 0;
    if (sigmas <= trend.moved_sigmas) continue;
    trend.moved_sigmas = sigmas;
    trend.moved = problem.parameters[static_cast<std::size_t>(i)];
  }
  return trend;
}

std::map<int, double> TemperatureOf(const BenchTable& data) {
  std::map<int, double> of;
  const auto column = data.Find("T_C");
  for (int i = 0; column && i < data.rows(); ++i) {
    of[data.lines[static_cast<std::size_t>(i)]] = data.values(i, *column);
  }
  return of;
}

void Tell(const ChannelRows& channel, const Trend& trend, std::string_view against,
          FitReport& report) {
  if (!(trend.t > trend.limit)) return;
  report.remarks.push_back(fmt::format(
      "channel {}: the residuals follow {}, by {:.3g} from end to end ({:.1f} of its sigmas, "
      "chance "
      "reaches {:.1f}); with a term for it {} would move by {:.1f} of its sigmas: repeat what was "
      "measured first, or fit all of the bench's data by calibrate tool",
      channel.channel, against, trend.change, trend.t, trend.limit, trend.moved,
      trend.moved_sigmas));
}

}  // namespace

void TestTrends(const BenchTable& data, const LinearProblem& problem,
                const LinearSolution& solution, FitReport& report) {
  if (solution.dof < 4 || solution.cov.size() == 0) return;
  const std::vector<ChannelRows> channels = ChannelsOf(problem, solution);
  const std::map<int, double> temperatures = TemperatureOf(data);
  const double tests = static_cast<double>(channels.size()) * (temperatures.empty() ? 1 : 2);
  const double probability = kFalseAlarm / 2 / std::max(1.0, tests);
  for (const ChannelRows& channel : channels) {
    std::vector<double> order, temperature;
    for (const Eigen::Index row : channel.in_problem) {
      const int line = problem.rows[static_cast<std::size_t>(row)].line;
      order.push_back(std::abs(line));
      const auto found = temperatures.find(line);
      if (found != temperatures.end()) temperature.push_back(found->second);
    }
    Tell(channel, TrendAlong(problem, solution, channel, order, probability),
         "the order of the readings", report);
    if (temperature.size() != order.size()) continue;
    const auto [least, most] = std::minmax_element(temperature.begin(), temperature.end());
    if (*most - *least < kLeastSwing) continue;
    Tell(channel, TrendAlong(problem, solution, channel, temperature, probability),
         "the temperature", report);
  }
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
