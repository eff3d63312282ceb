#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "wellgyro/noise/value_runs_internal.h"

namespace wellgyro {
namespace {

using Kind = LogFinding::Kind;

constexpr std::size_t kFindingsMax = 100;  // of a kind, the first: a log with more is useless
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();  // equal to no reading

class ValueRuns {
 public:
  ValueRuns(std::span<const double> rate, std::span<const SampleGap> gaps,
            const StaticLogOptions& options, std::int64_t together)
      : rate_(rate),
        gaps_(gaps),
        options_(options),
        samples_(static_cast<std::int64_t>(rate.size())),
        together_(together) {}

  std::vector<LogFinding> Find() {
    const Values values = CountValues();
    if (values.present > 1 && values.high.value == values.low.value) {
      AddFinding({.kind = Kind::kConstant,
                  .where = {0, samples_},
                  .size = values.high.value,
                  .samples = values.present},
                 findings_);
      return std::move(findings_);
    }
    const bool high_pile = values.IsPile(values.high);
    const bool low_pile = values.IsPile(values.low);
    const double stuck = LongestByChance(values);
    SampleGap run;
    double value = kNone;
    const auto close = [&] {
      const std::int64_t length = run.end - run.begin;
      const bool piled =
          (high_pile && value == values.high.value) || (low_pile && value == values.low.value);
      if (length > 0 && (IsAtEnd(value) || (piled && length >= 3))) {
        AddSaturated(run, value);
      } else if (static_cast<double>(length) > stuck) {
        AddFinding({.kind = Kind::kStuck, .where = run, .size = value, .samples = length},
                   findings_);
      }
    };
    ForEachPresent([&](std::int64_t i, double y) {
      if (y != value || i != run.end) {
        close();
        run.begin = i;
        value = y;
      }
      run.end = i + 1;
    });
    close();
    return std::move(findings_);
  }

 private:
  struct Extreme {
    double value;
    std::int64_t count = 0;
    double next_value;
    std::int64_t next_count = 0;

    // `sign` +1 for the largest, -1 for the smallest.
    void Take(double y, double sign) {
      if (count > 0 && y == value) {
        ++count;
      } else if (count == 0 || sign * y > sign * value) {
        next_value = value;
        next_count = count;
        value = y;
        count = 1;
      } else if (next_count > 0 && y == next_value) {
        ++next_count;
      } else if (next_count == 0 || sign * y > sign * next_value) {
        next_value = y;
        next_count = 1;
      }
    }
    bool IsPile() const { return count >= 3 && count > 2 * next_count; }
  };

  // Calls `see` with every present sample, in order.
  template <class See>
  void ForEachPresent(See see) const {
    std::size_t gap = 0;
    for (std::int64_t i = 0; i < samples_; ++i) {
      while (gap < gaps_.size() && gaps_[gap].end <= i) ++gap;
      if (gap < gaps_.size() && gaps_[gap].begin <= i) {
        i = gaps_[gap].end - 1;
      } else {
        see(i, rate_[static_cast<std::size_t>(i)]);
      }
    }
  }

  // What one pass over the samples tells of their values.
  struct Values {
    Extreme high{kNone, 0, kNone, 0};
    Extreme low{kNone, 0, kNone, 0};
    std::int64_t present = 0;
    std::int64_t repeats = 0;  // of the sample before

    // What most readings are is no end of the range, but a signal finer than its steps.
    bool IsPile(const Extreme& end) const { return end.IsPile() && end.count < present / 2; }
  };

  Values CountValues() const {
    Values values;
    double last = kNone;
    ForEachPresent([&](std::int64_t, double y) {
      values.high.Take(y, 1);
      values.low.Take(y, -1);
      values.repeats += y == last;
      last = y;
      ++values.present;
    });
    return values;
  }

  // Length of a run that coarse readings make by chance once in a million logs.
  double LongestByChance(const Values& values) const {
    const auto present = static_cast<double>(values.present);
    const double repeat = static_cast<double>(values.repeats) / std::max(1., present);
    const double chance = std::log(1e-6 / (present + 1));
    return repeat < 1 ? std::max(32., chance / std::log(std::max(repeat, 1e-3)))
                      : static_cast<double>(samples_);
  }

  bool IsAtEnd(double y) const {
    return (options_.highest && y >= *options_.highest) ||
           (options_.lowest && y <= *options_.lowest);
  }

  // Runs that follow each other closely are told as one.
  void AddSaturated(SampleGap where, double value) {
    for (auto& finding : findings_) {
      if (finding.kind == Kind::kSaturated && finding.size == value &&
          where.begin - finding.where.end < together_) {
        finding.samples += where.end - where.begin;
        finding.where.end = where.end;
        return;
      }
    }
    AddFinding({.kind = Kind::kSaturated,
                .where = where,
                .size = value,
                .samples = where.end - where.begin},
               findings_);
  }

  std::span<const double> rate_;
  std::span<const SampleGap> gaps_;
  const StaticLogOptions& options_;
  std::int64_t samples_, together_;
  std::vector<LogFinding> findings_;
};

}  // namespace

void AddFinding(const LogFinding& finding, std::vector<LogFinding>& findings) {
  const auto same = std::count_if(findings.begin(), findings.end(),
                                  [&](const LogFinding& f) { return f.kind == finding.kind; });
  if (static_cast<std::size_t>(same) < kFindingsMax) findings.push_back(finding);
}

std::vector<LogFinding> FindValueRuns(std::span<const double> rate, std::span<const SampleGap> gaps,
                                      const StaticLogOptions& options, std::int64_t together) {
  return ValueRuns(rate, gaps, options, together).Find();
}

}  // namespace wellgyro
