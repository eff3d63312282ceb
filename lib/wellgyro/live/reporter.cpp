#include "wellgyro/live/reporter.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/io/words.h"

namespace wellgyro {
namespace {

constexpr double kRests = 5;  // [s] so long without moving is a rest: no reversal takes it

/// The worst verdict of each check over all tools.
std::map<std::string, Verdict> WorstOf(const std::vector<ToolResult>& tools) {
  std::map<std::string, Verdict> worst;
  for (const ToolResult& tool : tools) {
    for (const Check& check : tool.survey.checks) {
      const auto at = worst.try_emplace(check.code, check.verdict).first;
      const bool worse = check.verdict == Verdict::kFail ||
                         (check.verdict == Verdict::kWarn && at->second != Verdict::kFail);
      if (worse) at->second = check.verdict;
    }
  }
  return worst;
}

}  // namespace

void Reporter::Begin() { next_us_ = session_.clock.monotonic_us(); }

void Reporter::Used(std::int64_t delay_us, bool gave_station) {
  message_latency_.Add(delay_us);
  if (gave_station) station_latency_.Add(delay_us);
}

void Reporter::Note(const std::vector<ToolResult>& tools) {
  std::map<std::string, Verdict> now = WorstOf(tools);
  for (const auto& [code, verdict] : now) {
    const auto before = verdicts_.find(code);
    const bool bad = verdict == Verdict::kWarn || verdict == Verdict::kFail;
    const bool was = before != verdicts_.end() && before->second == verdict;
    if (was || (!bad && before == verdicts_.end())) continue;
    turned_ = fmt::format("{} {}", code, WordOf(verdict));
  }
  verdicts_ = std::move(now);
}

Status Reporter::StatusNow(bool on_time) {
  const SampleTally tally = session_.surveyor.tally();
  Status status;
  status.samples_received = tally.received;
  status.samples_lost = tally.lost;
  status.gaps = tally.gaps;
  status.duplicates = tally.duplicates;
  status.malformed = session_.intake.feed().malformed() + session_.bus.refused();
  status.kernel_drops = session_.bus.kernel_drops();
  status.latency_p99 = static_cast<double>(message_latency_.Recent(on_time)) * 1e-6;
  if (tally.newest) {
    status.data_age = (UtcTime{session_.clock.utc_us() * 1000} - *tally.newest).seconds();
  }
  if (tally.lost > 0) status.text = "samples were lost";
  Worsen(status);
  return status;
}

void Reporter::Worsen(Status& status) const {
  const bool log_failing = log_ != nullptr && log_->failing();
  if (status.kernel_drops.value_or(0) > 0) status.text = "the receive buffer overflowed";
  if (session_.keeper.failing()) status.text = "the survey's files cannot be written";
  if (log_ != nullptr && log_->moved()) status.text = "the recording was moved or removed";
  if (log_ != nullptr && log_->lost() > 0) status.text = "messages are missing in the recording";
  if (log_failing) status.text = "the recording cannot be written";
  if (!status.text.empty()) status.state = Status::State::kDegraded;
  if (log_failing || session_.keeper.failing()) status.state = Status::State::kFault;
}

void Reporter::Report(std::int64_t now) {
  const bool on_time = now >= next_us_;
  if (on_time) next_us_ = std::max(next_us_ + kSecondUs, now);
  const Status status = StatusNow(on_time);
  const std::int64_t drops = status.kernel_drops.value_or(0);
  if (drops > kernel_drops_said_) {
    session_.notices.Say(
        fmt::format("the system has thrown away {} datagrams: its receive buffer was full", drops));
    kernel_drops_said_ = drops;
  }
  session_.broadcast.Send(status);
  if (on_time) session_.broadcast.Send(GlanceNow());
  const std::lock_guard lock(mutex_);
  last_ = status;
  last_us_ = now;
}

void Reporter::ReportFault(std::string_view reason) {
  Status status = StatusNow(true);
  status.state = Status::State::kFault;
  status.text = reason;
  session_.broadcast.Send(status);
}

/// The survey is busy, and the rig should know that it lives.
void Reporter::Repeat() {
  Status status;
  {
    const std::lock_guard lock(mutex_);
    status = last_;
    const std::int64_t now = session_.clock.monotonic_us();
    if (last_us_) status.data_age += static_cast<double>(now - *last_us_) * 1e-6;
  }
  status.text = kBusy;
  if (status.state == Status::State::kOk) status.state = Status::State::kDegraded;
  session_.broadcast.Send(status);
}

Glance Reporter::GlanceNow() const {
  Glance glance;
  const SampleTally tally = session_.surveyor.tally();
  if (tally.newest && tally.newest->ns > 0) glance.utc = *tally.newest;
  const DepthNow& depth = session_.intake.depth();
  if (depth.mark) {
    glance.run = depth.mark->run;
    glance.md = depth.mark->md;
    glance.speed = depth.speed;
    const double rests = (depth.mark->utc - depth.rest_begin).seconds();
    if (rests >= kRests) glance.still = rests;
  }
  glance.still_needed = session_.still_needed;
  if (const auto& station = session_.broadcast.last()) {
    glance.run = station->run;
    glance.inclination = station->inclination;
    glance.azimuth = station->azimuth;
    glance.sigma_azimuth = std::sqrt(std::max(station->cov_md_inc_azi(2, 2), 0.0));
  }
  glance.samples_lost = tally.lost;
  for (const auto& [code, verdict] : verdicts_) {
    glance.checks_warned += verdict == Verdict::kWarn ? 1 : 0;
    glance.checks_failed += verdict == Verdict::kFail ? 1 : 0;
  }
  glance.turned = turned_;
  return glance;
}

void Reporter::CountLatencies(SourceRecord& source) const {
  source.counts["station_latency_median_us"] = station_latency_.Of(0.5);
  source.counts["station_latency_p99_us"] = station_latency_.Of(0.99);
  source.counts["message_latency_p99_us"] = message_latency_.Of(0.99);
}

}  // namespace wellgyro
