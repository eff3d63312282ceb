#include "wellgyro/survey/job.h"

#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

#include <fmt/core.h>

#include "wellgyro/calibration/apply.h"
#include "wellgyro/record/limits.h"
#include "wellgyro/survey/job_keys.h"
#include "wellgyro/survey/plausible.h"

namespace wellgyro {
namespace {

[[noreturn]] void Refuse(std::string_view field, double value, std::string_view why) {
  throw std::invalid_argument(fmt::format("job: {} = {} {}", field, value, why));
}

// One number of a list.
void CheckListed(std::string_view table, std::string_view key, double value) {
  if (const auto complaint = ComplaintOf(value, JobKeyOf(table, key).range)) {
    throw std::invalid_argument(fmt::format("job: {}.{}: {}", table, key, *complaint));
  }
}

void CheckTieIn(const TieIn& tie) {
  if (tie.inclination.has_value() != tie.azimuth.has_value()) {
    throw std::invalid_argument(
        "job: tie_in has one of inclination_deg and azimuth_true_deg; give both or none");
  }
  if (const auto complaint = FindCovarianceComplaint(tie.cov_p_WT_W)) {
    throw std::invalid_argument("job: tie_in.cov_p_WT_W: " + *complaint);
  }
}

// It has no key: a tool's calibration says it. Beyond that size a gyro lies along the tool.
void CheckCoupling(std::string_view field, double value) {
  if (const auto complaint = ComplaintOf(value, {.min = -10, .max = 10})) {
    throw std::invalid_argument(fmt::format("job: {}: {}", field, *complaint));
  }
}

void CheckTool(const ToolCalibration& tool) {
  if (const auto complaint = FindComplaint(tool)) {
    throw std::invalid_argument("job: tool: " + *complaint);
  }
  if (tool.accel.n_channels == 0) {
    throw std::invalid_argument(
        "job: tool.accel.n_channels = 0: without accelerometers there is no survey");
  }
}

void CheckAlignment(const AlignmentSpec& alignment) {
  if (alignment.method != AlignmentSpec::Method::kExternal) return;
  if (alignment.at_md && alignment.at_utc) {
    throw std::invalid_argument("job: alignment has at_md_m and at_utime_us; give one of them");
  }
}

void CheckDepth(const DepthSpec& depth) {
  for (std::size_t i = 0; i < depth.corrections.size(); ++i) {
    if (!(std::abs(depth.corrections[i].first) <= limits::kMd)) {
      Refuse("depth.corrections", depth.corrections[i].first, "m is no measured depth");
    }
    CheckListed("depth", "corrections", depth.corrections[i].second);
    if (i > 0 && !(depth.corrections[i].first > depth.corrections[i - 1].first)) {
      Refuse("depth.corrections", depth.corrections[i].first, "m does not increase");
    }
  }
}

void CheckRuns(const std::vector<RunSpec>& runs) {
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (runs[i].number < 1) Refuse("run.number", runs[i].number, "is not a run (from 1)");
    for (std::size_t j = 0; j < i; ++j) {
      if (runs[j].number == runs[i].number) Refuse("run.number", runs[i].number, "stands twice");
    }
    if (runs[i].begin && runs[i].end && !(*runs[i].begin < *runs[i].end)) {
      Refuse("run.number", runs[i].number, "ends before it begins");
    }
  }
}

void CheckEvents(const std::vector<Event>& events) {
  for (std::size_t i = 0; i < events.size(); ++i) {
    if (const std::string odd = FindImplausible(events[i]); !odd.empty()) {
      throw std::invalid_argument(fmt::format("job: events[{}] has {}", i, odd));
    }
  }
}

}  // namespace

void CheckJob(const Job& job) {
  if (const auto complaint = FindNumberComplaint(job)) {
    throw std::invalid_argument("job: " + *complaint);
  }
  CheckTieIn(job.tie_in);
  CheckCoupling("errors.gyro_misalignment_x", job.errors.gyro_misalignment_x);
  CheckCoupling("errors.gyro_misalignment_y", job.errors.gyro_misalignment_y);
  CheckAlignment(job.alignment);
  CheckDepth(job.depth);
  if (job.tool) CheckTool(*job.tool);
  CheckEvents(job.events);
  CheckRuns(job.runs);
  for (double md : job.stations.at) CheckListed("stations", "at_m", md);
  if (job.stations.every == 0 && job.stations.at.empty() && !job.stations.at_stops) {
    throw std::invalid_argument(
        "job: [stations] asks for nothing; give every_m, at_m or at_stops = true");
  }
}

}  // namespace wellgyro
