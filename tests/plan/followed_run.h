#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <optional>
#include <variant>
#include <vector>

#include "wellgyro/io/toml/plan_file.h"
#include "wellgyro/plan/live_advice.h"
#include "wellgyro/plan/plan_case.h"
#include "wellgyro/plan/stop_search.h"
#include "wellgyro/simulate/simulator.h"
#include "wellgyro/simulate/tool_errors.h"
#include "wellgyro/survey/run/run_now.h"
#include "wellgyro/survey/surveyor.h"
#include "wellgyro/uncertainty/ellipse.h"

namespace wellgyro::test {

/// What came of a run that did as it was advised.
struct Followed {
  std::vector<PlannedStop> stops;
  double cost = 0;     ///< at rest, with the overhead of every stop [s]
  double ellipse = 0;  ///< semi-major axis of the deepest station's, as surveyed [m]
  Eigen::Matrix3d cov_p_WT_W = Eigen::Matrix3d::Zero();
  Eigen::Vector3d error = Eigen::Vector3d::Zero();  ///< of that station against the truth [m]
  bool failed = false;  ///< by its verdict: what it states of its end then means less
  int advices = 0;
  double worst_ms = 0, mean_ms = 0;  ///< of an advice
};

/// A simulated tool that rests and moves as the advice to its own survey says. What is not yet
/// decided is simulated anew; what has been sampled stays as it was.
class FollowedRun {
 public:
  /// `c`: as planned; `truth`: the well as it is and the noise of the tool. The tool's errors are
  /// drawn from its priors by `seed`.
  FollowedRun(const PlanCase& c, const PlanCase& truth, const PlanLimits& limits,
              std::uint64_t seed)
      : case_(c), limits_(limits), surveyor_(JobOf(c), sink_) {
    for (std::size_t i = 0; i < truth.well.size(); ++i) {
      const TrajectoryPoint p = truth.well.station(i);
      simulation_.well.stations.push_back({p.md, p.inclination, p.azimuth});
    }
    simulation_.well.begin_p_WT_W.z() = c.way.begin_md;
    simulation_.earth.latitude = c.site.latitude;
    simulation_.tool.errors = DrawToolErrors(truth.errors, truth.gyro, seed);
    simulation_.streams.imu_hz = 2;
    simulation_.streams.depth_hz = 1;
    simulation_.seed = seed;
    simulation_.run.start_md = md_ = c.way.begin_md;
    simulation_.run.start_toolface = c.way.toolface;
  }

  static Job JobOf(const PlanCase& c) {
    Job job;
    job.well.name = "followed";
    job.well.latitude = c.site.latitude;
    job.noise = c.gyro;
    job.errors = c.errors;
    job.tie_in.md = c.way.begin_md;
    job.tie_in.tvd = c.way.begin_md;
    job.stations.every = 30;
    job.depth.latency = 2;
    return job;
  }

  Followed Follow() {
    Advice advice = Rest();
    for (;;) {
      up_ = up_ || !advice.next || advice.next->out;
      if (up_ && deepest_ < case_.way.end_md - 1) {
        MoveTo(case_.way.end_md);
        continue;
      }
      if (!advice.next) break;
      advice = Approach(advice);
    }
    MoveTo(case_.way.begin_md);
    Conclude();
    return std::move(followed_);
  }

 private:
  /// Rests for as long as it is told to; what was said last.
  Advice Rest() {
    simulation_.run.steps.emplace_back(RunStop{.seconds = 3600});
    Changed();
    const double begin = time_;
    Advice advice;
    for (double rested = kReact; rested < 3600; rested += kAsk) {
      PlayUntil(begin + rested);
      advice = Ask();
      if (advice.action == Advice::Action::kMoveOn) break;
    }
    const double seconds = time_ - begin + 2;
    std::get<RunStop>(simulation_.run.steps.back()).seconds = seconds;
    Changed();
    time_ = begin + seconds;
    followed_.stops.push_back({up_, md_, seconds, {}});
    followed_.cost += seconds + limits_.overhead;
    return advice;
  }

  /// Towards the next stop, and another one where that is said on the way; what was said last.
  Advice Approach(Advice advice) {
    BeginMove(advice.next->md);
    while (MoveEnd() - time_ > kLook) {
      PlayUntil(time_ + kLook - kRamp);
      advice = Ask();
      const double here = MdNow() + (up_ ? -1 : 1) * Speed() * kRamp;
      if (advice.action == Advice::Action::kStop) {
        Retarget(here);
        break;
      }
      const bool turns = !advice.next || (advice.next->out && !up_);
      const double md = turns ? (up_ ? case_.way.begin_md : case_.way.end_md) : advice.next->md;
      if (up_ ? md < here : md > here) Retarget(md);
      if (turns && !up_) break;
    }
    EndMove();
    const bool turns = !advice.next || (advice.next->out && !up_);
    if (turns && advice.action != Advice::Action::kStop) return advice;
    return Rest();
  }

  void MoveTo(double md) {
    BeginMove(md);
    EndMove();
  }

  double Speed() const { return up_ && deepest_ > md_ ? case_.way.speed_out : case_.way.speed_in; }
  RunMove& Move() { return std::get<RunMove>(simulation_.run.steps.back()); }
  void BeginMove(double md) {
    const RunMove move{
        .to_md = md, .speed = Speed(), .ramp = kRamp, .roll = PlannedRoll(case_.way, moved_)};
    simulation_.run.steps.emplace_back(move);
    Changed();
    begin_ = time_;
  }
  void Retarget(double md) {
    if (Move().to_md == md) return;
    Move().to_md = md;
    Changed();
  }
  double MoveEnd() {
    return begin_ + std::max(std::abs(Move().to_md - md_) / Move().speed, kRamp) + kRamp;
  }
  double MdNow() {
    const double gone = Move().speed * (time_ - begin_ - 0.5 * kRamp);
    return md_ + (Move().to_md > md_ ? gone : -gone);
  }
  void EndMove() {
    PlayUntil(MoveEnd());
    moved_ += std::abs(Move().to_md - md_) / Move().speed;
    md_ = Move().to_md;
    deepest_ = std::max(deepest_, md_);
  }

  /// The run has been given other steps; those that were made stay as they were.
  void Changed() { simulator_.reset(); }

  void PlayUntil(double time) {
    SimulatedStep step;
    if (!simulator_) {
      simulator_.emplace(simulation_);
      for (std::int64_t i = 0; i < played_; ++i) simulator_->Next(step);
    }
    if (played_ == 0) surveyor_.Push(simulator_->tool_info());
    while (simulator_->Next(step)) {
      std::visit([this](const auto& record) { surveyor_.Push(record); }, step);
      ++played_;
      const auto* sample = std::get_if<ImuSample>(&step);
      if (sample != nullptr && simulator_->SampleTime(sample->stamp.seq) > time) break;
    }
    time_ = time;
  }

  Advice Ask() {
    const std::clock_t begin = std::clock();
    const AskingRun run = AskingOf(NowOf(surveyor_, 0), surveyor_.tally().newest, deepest_);
    const Advice advice = Advise(case_, limits_, run);
    const double took = 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    deepest_ = std::max(deepest_, run.deepest);
    followed_.worst_ms = std::max(followed_.worst_ms, took);
    followed_.mean_ms += (took - followed_.mean_ms) / ++followed_.advices;
    return advice;
  }

  void Conclude() {
    surveyor_.Finish();
    const Survey survey = surveyor_.Current(0);
    followed_.failed = survey.verdict.verdict == Verdict::kFail;
    if (survey.chosen.empty()) return;
    const Station& end = survey.chosen.back();
    followed_.cov_p_WT_W = end.cov_p_WT_W;
    followed_.ellipse = HorizontalEllipse(end.cov_p_WT_W, 0.95).semi_major;
    const Simulator simulator(simulation_);
    followed_.error = end.p_WT_W - simulator.truth().well().PlaceAt(case_.way.end_md).p_WT_W;
  }

  static constexpr double kReact = 30, kAsk = 5, kLook = 60, kRamp = 10;  // [s]

  const PlanCase& case_;
  PlanLimits limits_;
  struct : Sink {
  } sink_;
  Surveyor surveyor_;
  Simulation simulation_;
  std::optional<Simulator> simulator_;
  double md_ = 0, time_ = 0, begin_ = 0, moved_ = 0, deepest_ = 0;
  bool up_ = false;
  std::int64_t played_ = 0;
  Followed followed_;
};

}  // namespace wellgyro::test
