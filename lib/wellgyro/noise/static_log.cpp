#include "wellgyro/noise/static_log.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "wellgyro/math/median.h"
#include "wellgyro/noise/level_step_internal.h"
#include "wellgyro/noise/value_runs_internal.h"

namespace wellgyro {
namespace {

using Kind = LogFinding::Kind;

constexpr double kUnusual = 8;      // times the robust sigma: P(|x| > 8) = 1.2e-15
constexpr std::size_t kAway = 100;  // stretches it may stand away and come back: 5 % of a log's
// Share of the variance of 40 means that a line must explain: of pure rate random walk one log in
// twenty does (5.1 % of 4000 simulated), of white noise none (29 % of the variance at most).
constexpr double kExplained = 0.9;
constexpr double kSureStep = 25;  // evidence: of 200 sound logs the most was 19

double Spread(const std::vector<double>& values) { return RobustSigma(values, Median(values)); }

// Means over equal stretches, those with missing samples left out.
struct Stretch {
  std::int64_t begin = 0;
  double mean = 0;
  double log_scatter = 0;  // logarithm of the variance of successive differences
  double temperature = 0;
};

class Inspector {
 public:
  Inspector(std::span<const double> rate, std::span<const SampleGap> gaps,
            const StaticLogOptions& options)
      : rate_(rate),
        gaps_(gaps),
        options_(options),
        samples_(static_cast<std::int64_t>(rate.size())),
        length_(std::max<std::int64_t>(16, samples_ / 2000)) {}

  std::vector<LogFinding> Inspect() {
    findings_ = FindValueRuns(rate_, gaps_, options_, length_);
    if (!findings_.empty() && findings_.front().kind == Kind::kConstant) return findings_;
    FillStretches();
    FindMovements();
    const std::optional<LogFinding> step = FindStep();
    FindDrift();
    const bool other = std::any_of(findings_.begin(), findings_.end(), [](const LogFinding& f) {
      return f.kind != Kind::kSaturated && f.kind != Kind::kStuck;
    });
    if (step && !other) AddFinding(*step, findings_);
    return findings_;
  }

 private:
  void FillStretches() {
    std::size_t gap = 0;
    for (std::int64_t begin = 0; begin + length_ <= samples_; begin += length_) {
      while (gap < gaps_.size() && gaps_[gap].end <= begin) ++gap;
      if (gap < gaps_.size() && gaps_[gap].begin < begin + length_) continue;
      const auto y =
          rate_.subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(length_));
      Stretch stretch{.begin = begin};
      double sum = 0;
      double squares = 0;
      for (std::size_t i = 0; i < y.size(); ++i) {
        sum += y[i] - y[0];
        if (i > 0) squares += (y[i] - y[i - 1]) * (y[i] - y[i - 1]);
      }
      stretch.mean = y[0] + sum / static_cast<double>(length_);
      stretch.log_scatter =
          std::log(squares / static_cast<double>(length_ - 1) + std::numeric_limits<double>::min());
      if (options_.temperature.size() == rate_.size()) {
        double t = 0;
        for (std::int64_t i = begin; i < begin + length_; ++i) {
          t += static_cast<double>(options_.temperature[static_cast<std::size_t>(i)]);
        }
        stretch.temperature = t / static_cast<double>(length_);
      }
      stretches_.push_back(stretch);
    }
  }

  // Against the stretch before each; zero for the first.
  std::vector<double> Steps() const {
    std::vector<double> steps(stretches_.size(), 0);
    for (std::size_t i = 1; i < steps.size(); ++i) {
      steps[i] = stretches_[i].mean - stretches_[i - 1].mean;
    }
    return steps;
  }

  // How far each stretch moved, zero where it did not: its step, or the scatter within.
  std::vector<double> Moves(const std::vector<double>& steps, double usual_step) const {
    std::vector<double> scatters;
    for (const auto& s : stretches_) scatters.push_back(s.log_scatter);
    const double middle = Median(scatters);
    // Differences of normal noise scatter by sqrt(3/length) in the logarithm of their variance.
    const double spread =
        std::max(RobustSigma(scatters, middle), std::sqrt(3 / static_cast<double>(length_)));
    std::vector<double> moves(stretches_.size(), 0);
    for (std::size_t i = 0; i < moves.size(); ++i) {
      if (scatters[i] - middle > kUnusual * spread) moves[i] = std::exp(scatters[i] / 2);
      const double step = std::abs(steps[i]);
      if (usual_step > 0 && step > kUnusual * usual_step) moves[i] = std::max(moves[i], step);
    }
    return moves;
  }

  void FindMovements() {
    if (stretches_.size() < 16) return;
    const std::vector<double> steps = Steps();
    const double usual = Spread({steps.begin() + 1, steps.end()});
    const std::vector<double> moves = Moves(steps, usual);
    const double usual_change = UsualChange();
    for (std::size_t i = 0; i < moves.size(); ++i) {
      if (!(moves[i] > 0)) continue;
      std::size_t last = i;
      double largest = moves[i];
      double level = steps[i];  // against before the movement
      // Up to where it has been quiet for a while at the level it had.
      for (std::size_t j = i + 1; j < moves.size(); ++j) {
        level += steps[j];
        if (moves[j] > 0) {
          last = j;
          largest = std::max(largest, moves[j]);
        } else if (j > last + 3 && (std::abs(level) < kUnusual * usual || j > last + kAway)) {
          break;
        }
      }
      const std::int64_t begin = stretches_[i > 0 ? i - 1 : 0].begin;
      const std::int64_t end = stretches_[last].begin + length_;
      const bool stayed = usual_change > 0 && StaysAway(last, i, kUnusual * usual_change);
      AddFinding({.kind = stayed ? Kind::kStep : Kind::kMoved,
                  .where = {begin, end},
                  .size = stayed ? std::abs(LevelAfter(last) - LevelBefore(i)) : largest,
                  .typical = usual,
                  .samples = end - begin},
                 findings_);
      i = last;
    }
  }

  // A step that no two neighbouring stretches show, by all that stand before and behind it.
  std::optional<LogFinding> FindStep() const {
    std::vector<double> means;
    for (const Stretch& stretch : stretches_) means.push_back(stretch.mean);
    const auto step = FindLevelStep(means);
    if (!step || step->evidence < kSureStep) return std::nullopt;
    const std::int64_t begin = stretches_[step->at - 1].begin;
    const std::int64_t end = stretches_[step->at].begin + length_;
    return LogFinding{.kind = Kind::kStep,
                      .where = {begin, end},
                      .size = std::abs(step->size),
                      .samples = end - begin};
  }

  // Mean levels of up to twenty stretches beside a movement.
  static constexpr std::size_t kBeside = 20;
  double LevelBefore(std::size_t first) const {
    const std::size_t end = first > 0 ? first - 1 : 0;
    const std::size_t begin = end > kBeside ? end - kBeside : 0;
    return end > begin ? LevelOf(begin, end) : stretches_.front().mean;
  }
  double LevelAfter(std::size_t last) const {
    const std::size_t begin = std::min(last + 1, stretches_.size() - 1);
    return LevelOf(begin, std::min(begin + kBeside, stretches_.size()));
  }
  double LevelOf(std::size_t begin, std::size_t end) const {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += stretches_[i].mean;
    return sum / static_cast<double>(end - begin);
  }
  // Of the mean level across any one stretch: far less than between two neighbours.
  double UsualChange() const {
    std::vector<double> changes;
    for (std::size_t i = kBeside + 1; i + kBeside < stretches_.size(); ++i) {
      changes.push_back(LevelAfter(i) - LevelBefore(i));
    }
    return Spread(changes);
  }
  // A movement in a few stretches after which the mean is another, for as long as can be seen.
  bool StaysAway(std::size_t last, std::size_t first, double limit) const {
    constexpr std::size_t kShort = 5;  // stretches, 1/2000 of the log each: a step, not a drift
    const bool seen = first > kBeside / 2 && last + kBeside / 2 < stretches_.size();
    return seen && last - first < kShort && std::abs(LevelAfter(last) - LevelBefore(first)) > limit;
  }

  struct Line {
    double slope = 0;
    double explained = 0;  // share of the variance
  };
  template <class X>
  Line FitLine(X x_of) const {
    double mean_x = 0;
    double mean_y = 0;
    const auto n = static_cast<double>(stretches_.size());
    for (const auto& s : stretches_) {
      mean_x += x_of(s) / n;
      mean_y += s.mean / n;
    }
    double xx = 0;
    double xy = 0;
    double yy = 0;
    for (const auto& s : stretches_) {
      const double x = x_of(s) - mean_x;
      const double y = s.mean - mean_y;
      xx += x * x;
      xy += x * y;
      yy += y * y;
    }
    if (xx == 0 || yy == 0) return {};
    return {xy / xx, xy * xy / (xx * yy)};
  }

  // Slow changes show in means over a fortieth of the log, where noise has averaged out. kExplained
  // holds for so many.
  void FindDrift() {
    constexpr std::size_t kParts = 40;
    if (stretches_.size() < 4 * kParts) return;
    std::vector<Stretch> parts;
    const std::size_t each = stretches_.size() / kParts;
    for (std::size_t p = 0; p < kParts; ++p) {
      Stretch part{.begin = stretches_[p * each].begin};
      for (std::size_t i = p * each; i < (p + 1) * each; ++i) {
        part.mean += stretches_[i].mean / static_cast<double>(each);
        part.temperature += stretches_[i].temperature / static_cast<double>(each);
      }
      parts.push_back(part);
    }
    stretches_ = std::move(parts);
    if (options_.temperature.size() == rate_.size()) {
      const auto temperature = [](const Stretch& s) { return s.temperature; };
      const Line line = FitLine(temperature);
      if (line.explained > kExplained) {
        AddFinding(DriftAlong(Kind::kTemperature, line.slope, temperature), findings_);
        findings_.back().per_degree = line.slope;
        return;
      }
    }
    const auto time = [](const Stretch& s) { return static_cast<double>(s.begin); };
    const Line line = FitLine(time);
    if (FindWarmUp(line.explained)) return;
    if (line.explained > kExplained) {
      AddFinding(DriftAlong(Kind::kDrift, line.slope, time), findings_);
    }
  }

  // Time constants from a fortieth to a third of the log.
  bool FindWarmUp(double explained_by_time) {
    const auto log = static_cast<double>(samples_);
    Line best;
    double constant = 0;
    for (double part = 1.0 / 40; part < 1.0 / 3; part *= 1.2) {
      const auto decay = [&](const Stretch& s) {
        return std::exp(-static_cast<double>(s.begin) / (part * log));
      };
      const Line line = FitLine(decay);
      if (line.explained <= best.explained) continue;
      best = line;
      constant = part * log;
    }
    if (best.explained < kExplained || 1 - best.explained > (1 - explained_by_time) / 2) {
      return false;
    }
    AddFinding({.kind = Kind::kWarmUp,
                .where = {0, static_cast<std::int64_t>(5 * constant)},
                .size = std::abs(best.slope),
                .samples = samples_,
                .time_constant = constant},
               findings_);
    return true;
  }

  // The span of the log's change along x, and the tenth with the most of it.
  template <class X>
  LogFinding DriftAlong(Kind kind, double slope, X x_of) const {
    double least = x_of(stretches_.front());
    double most = least;
    for (const auto& s : stretches_) {
      least = std::min(least, x_of(s));
      most = std::max(most, x_of(s));
    }
    const std::size_t tenth = stretches_.size() / 10;
    std::size_t fastest = 0;
    for (std::size_t i = 0; i + tenth < stretches_.size(); ++i) {
      const auto change = [&](std::size_t at) {
        return std::abs(stretches_[at + tenth].mean - stretches_[at].mean);
      };
      if (change(i) > change(fastest)) fastest = i;
    }
    return {.kind = kind,
            .where = {stretches_[fastest].begin, stretches_[fastest + tenth].begin},
            .size = std::abs(slope) * (most - least),
            .samples = samples_};
  }

  std::span<const double> rate_;
  std::span<const SampleGap> gaps_;
  const StaticLogOptions& options_;
  std::int64_t samples_;
  std::int64_t length_;
  std::vector<Stretch> stretches_;
  std::vector<LogFinding> findings_;
};

}  // namespace

std::vector<LogFinding> InspectStaticLog(std::span<const double> rate,
                                         std::span<const SampleGap> gaps,
                                         const StaticLogOptions& options) {
  return Inspector(rate, gaps, options).Inspect();
}

}  // namespace wellgyro
