#include "wellgyro/io/sensor/clock_join_internal.h"

#include <cmath>
#include <cstddef>
#include <deque>
#include <functional>
#include <variant>
#include <vector>

#include "wellgyro/alignment/still_detector.h"
#include "wellgyro/depth/depth_motion.h"
#include "wellgyro/depth/depth_track.h"
#include "wellgyro/io/sensor/sensor_rows_internal.h"
#include "wellgyro/math/median.h"
#include "wellgyro/record/depth.h"
#include "wellgyro/record/sample_block.h"

namespace wellgyro::sensors {
namespace {

// [s], the shortest stop that joins clocks: several times what its ends are noted to, some seconds.
constexpr double kRest = 20;
// [s] between marks of one rest: a logger that writes when depth changes is silent in it.
constexpr double kRestGap = 60;
// That depth is pushed ahead of samples, and kept behind them: more than any fit spans.
constexpr Duration kAhead = Duration::Seconds(30);
constexpr double kToolStep = 1;  // [s], a block of the StillDetector
// Sigma of a lag that says more than rests do [s]: their steps leave 0.2 s where marks come each
// second.
constexpr double kToldLag = 0.1;
// Its error that does not scatter [s]: two hours of stops with ramps of 3 and 10 s leave 4 ms.
constexpr double kLagLeast = 0.01;
constexpr double kExcluded = 5;  // sigmas, P(|x| > 5) = 5.7e-7
// A lag of 0.5 s is found to a tenth of itself where speed changes within it: the second round
// leaves some milliseconds.
constexpr int kLagRounds = 2;

/// The times in which depth stays within kRestsWithin, each as long as it can be. Of a string that
/// slows down and speeds up alike its ends are then as far off on either side; a rest that begins
/// at the first mark with which the next agree begins early and ends in time. Marks as SensorCsv
/// reads them: each later than the one before.
class RigRests {
 public:
  void Take(const DepthMark& mark) {
    const Mark now{mark.utc, mark.md};
    const double since = window_.empty() ? 0 : (now.utc - window_.back().utc).seconds();
    if (since > kRestGap) Clear();
    if (!window_.empty() && steps_.size() < kStepsMost) steps_.push_back(since);
    Add(now);
    const UtcRest rest{window_.front().utc, now.utc};
    if (longest_ && rest.begin > longest_->end) Emit();
    if (Length(rest) >= kRest && (!longest_ || Length(rest) > Length(*longest_))) longest_ = rest;
  }
  std::vector<UtcRest> All() {
    Emit();
    return std::move(rests_);
  }
  /// Between marks, by the first of them [s].
  double Step() { return steps_.empty() ? 0 : Median(steps_); }

 private:
  struct Mark {
    UtcTime utc;
    double md;  ///< [m]
  };
  static constexpr std::size_t kStepsMost = 1000;

  static double Length(const UtcRest& rest) { return (rest.end - rest.begin).seconds(); }
  void Clear() {
    window_.clear();
    lowest_.clear();
    highest_.clear();
  }
  void Emit() {
    if (longest_) rests_.push_back(*longest_);
    longest_.reset();
  }
  /// Lets marks go, from the oldest on, until all agree.
  void Add(const Mark& now) {
    const auto add = [&now](std::deque<Mark>& extremes, auto beyond) {
      while (!extremes.empty() && !beyond(extremes.back().md, now.md)) extremes.pop_back();
      extremes.push_back(now);
    };
    window_.push_back(now);
    add(lowest_, std::less{});
    add(highest_, std::greater{});
    while (highest_.front().md - lowest_.front().md >= kRestsWithin) {
      const UtcTime oldest = window_.front().utc;
      window_.pop_front();
      for (std::deque<Mark>* extremes : {&lowest_, &highest_}) {
        if (extremes->front().utc <= oldest) extremes->pop_front();
      }
    }
  }

  std::deque<Mark> window_;            ///< marks up to now that agree
  std::deque<Mark> lowest_, highest_;  ///< of it and of what follows each of them
  std::optional<UtcRest> longest_;     ///< that the window has been, of this rest
  std::vector<UtcRest> rests_;
  std::vector<double> steps_;  ///< [s]
};

/// The rests of the tool, and its first and last sample.
struct ToolSide {
  std::vector<ToolRest> rests;
  std::optional<SampleStamp> first, last;
};

Result<ToolSide> ToolSideOf(const std::filesystem::path& samples, const Job& job) {
  StillSetup setup{.gyro = job.noise, .errors = job.errors};
  setup.min_still = Duration::Seconds(kRest);
  StillDetector still(setup);
  ToolSide side;
  const auto note = [&](const std::optional<StillWindow>& window) {
    if (window) side.rests.push_back({window->begin, window->end});
  };
  const auto fault = ForEach<ImuSample>(samples, [&](const ImuSample& sample) {
    if (!side.first) side.first = sample.stamp;
    side.last = sample.stamp;
    note(still.Push(sample, AlongHole{}));
  });
  if (fault) return *fault;
  note(still.Flush());
  return side;
}

/// Pushes a table's marks onto a track, as far as they are asked for.
class MarksAhead {
 public:
  MarksAhead(SensorCsv& table, DepthTrack& track) : table_(table), track_(track) {
    more_ = table_.Next(row_);
  }
  void PushUntil(UtcTime utc) {
    while (more_) {
      const DepthMark& mark = std::get<DepthMark>(row_);
      if (mark.utc > utc) return;
      // A mark out of order, which the survey tells.
      static_cast<void>(track_.Push(mark));
      more_ = table_.Next(row_);
    }
  }

 private:
  SensorCsv& table_;
  DepthTrack& track_;
  SensorCsv::Row row_;
  bool more_;
};

Result<DepthMotion::Found> FeltMotion(const ClockTables& tables, const StopMatch& match) {
  Result<SensorCsv> depth = SensorCsv::Open(tables.depth);
  if (!depth) return depth.fault();
  DepthTrack track;
  MarksAhead marks(*depth, track);
  DepthMotion motion;
  const auto fault = ForEach<ImuSample>(tables.samples, [&](const ImuSample& sample) {
    const UtcTime utc = match.ToUtc(sample.stamp.tool_time);
    marks.PushUntil(utc + kAhead);
    const SixAxes axes = AxesOf(sample);
    motion.Feel({&utc, 1}, Duration{sample.stamp.period_ns}, {&axes, 1}, track);
    track.Forget(utc - kAhead);
  });
  if (fault) return *fault;
  if (depth->fault()) return *depth->fault();
  return motion.found();
}

}  // namespace

Result<JoinedClocks> JoinByStops(const ClockTables& tables, const Job& job) {
  RigRests rig;
  const auto fault =
      ForEach<DepthMark>(tables.depth, [&](const DepthMark& mark) { rig.Take(mark); });
  if (fault) return *fault;
  const Result<ToolSide> tool = ToolSideOf(tables.samples, job);
  if (!tool) return tool.fault();
  const Result<StopMatch> match = MatchStops(tool->rests, rig.All());
  if (!match) return match.fault();
  JoinedClocks joined{*match, *tool->first, *tool->last};
  const double step = rig.Step();
  joined.match.cov(0, 0) += (kToolStep * kToolStep + step * step) / 24;
  return joined;
}

std::optional<Fault> RefineByMotion(const ClockTables& tables, StopMatch& match) {
  const double by_rests = match.cov(0, 0);
  for (int round = 0; round < kLagRounds; ++round) {
    const Result<DepthMotion::Found> felt = FeltMotion(tables, match);
    if (!felt) return felt.fault();
    const double sigma = felt->sigma_lag;
    const bool told = sigma > 0 && sigma < kToldLag;
    if (!told || std::abs(felt->lag) > kExcluded * std::sqrt(by_rests)) break;
    match.utc = match.utc + Duration::Seconds(felt->lag);
    match.cov(0, 0) = sigma * sigma + kLagLeast * kLagLeast;
    match.cov(0, 1) = match.cov(1, 0) = 0;
  }
  return std::nullopt;
}

}  // namespace wellgyro::sensors
