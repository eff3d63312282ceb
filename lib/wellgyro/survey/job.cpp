#include "wellgyro/survey/job.h"

#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/calibration/apply.h"
#include "wellgyro/survey/job_keys.h"
#include "wellgyro/survey/job_rules.h"

namespace wellgyro {
namespace {

[[noreturn]] void Refuse(std::string_view table, const KeyComplaint& wrong) {
  throw std::invalid_argument(fmt::format("job: {}.{}: {}", table, wrong.key, wrong.why));
}

template <class Table>
void CheckTable(std::string_view name, const Table& table) {
  if (const auto wrong = FindKeyComplaint(table)) Refuse(name, *wrong);
}

void CheckCovariance(const TieIn& tie) {
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

void CheckJobGrid(const Job& job) {
  if (!job.grid) return;
  CheckTable("grid", *job.grid);
  if (const auto complaint = FindWellHeadComplaint(job)) {
    throw std::invalid_argument("job: grid: " + *complaint);
  }
}

void CheckRuns(std::span<const RunSpec> runs) {
  for (std::size_t i = 0; i < runs.size(); ++i) {
    CheckTable(fmt::format("runs[{}]", i), runs.first(i + 1));
  }
}

void CheckEvents(const std::vector<Event>& events) {
  for (std::size_t i = 0; i < events.size(); ++i) {
    CheckTable(fmt::format("events[{}]", i), events[i]);
  }
}

}  // namespace

void CheckJob(const Job& job) {
  if (const auto complaint = FindNumberComplaint(job)) {
    throw std::invalid_argument("job: " + *complaint);
  }
  CheckJobGrid(job);
  CheckTable("tie_in", job.tie_in);
  CheckCovariance(job.tie_in);
  CheckCoupling("errors.gyro_misalignment_x", job.errors.gyro_misalignment_x);
  CheckCoupling("errors.gyro_misalignment_y", job.errors.gyro_misalignment_y);
  CheckTable("channels", job.channels);
  CheckTable("alignment", job.alignment);
  CheckTable("attitude", job.attitude);
  CheckTable("stations", job.stations);
  CheckTable("depth", job.depth);
  if (job.tool) CheckTool(*job.tool);
  CheckEvents(job.events);
  CheckRuns(job.runs);
}

}  // namespace wellgyro
