// What a live session says and writes: its status, its files, its end.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <thread>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/io/words.h"
#include "wellgyro/live/observer.h"
#include "wellgyro/live/session_core_internal.h"
#include "wellgyro/survey/run/run_now.h"

namespace wellgyro {
namespace {

constexpr std::int64_t kKeepUs = 500'000;          // twice a second: nobody reads files more often
constexpr std::int64_t kAdviceUs = 2 * kSecondUs;  // two statuses: nobody acts on it sooner
constexpr double kRests = 5;  // [s] so long without moving is a rest: no reversal takes it
// For stations that were not sent yet at the end: 2000 of them at Broadcast's pace.
constexpr std::int64_t kOutboxUs = 1'000'000;
constexpr int kOutboxMs = 10;  // Broadcast's pause
// After a snapshot that took t the next one comes 200 t later at the soonest: 0.5 % of the stream's
// thread, so that few stations wait for one.
constexpr std::int64_t kSnapshotShare = 200;

}  // namespace

Status LiveSession::Core::StatusNow(bool on_time) {
  const SampleTally tally = surveyor.tally();
  Status status;
  status.samples_received = tally.received;
  status.samples_lost = tally.lost;
  status.gaps = tally.gaps;
  status.duplicates = tally.duplicates;
  status.malformed = intake.feed().malformed() + bus.refused();
  status.kernel_drops = bus.kernel_drops();
  status.latency_p99 = static_cast<double>(message_latency.Recent(on_time)) * 1e-6;
  if (tally.newest) {
    status.data_age = (UtcTime{setup.clock.utc_us() * 1000} - *tally.newest).seconds();
  }
  if (tally.lost > 0) status.text = "samples were lost";
  Worsen(status);
  return status;
}

void LiveSession::Core::Worsen(Status& status) const {
  const bool log_failing = log && log->failing();
  if (status.kernel_drops.value_or(0) > 0) status.text = "the receive buffer overflowed";
  if (keeper.failing()) status.text = "the survey's files cannot be written";
  if (log && log->moved()) status.text = "the recording was moved or removed";
  if (log && log->lost() > 0) status.text = "messages are missing in the recording";
  if (log_failing) status.text = "the recording cannot be written";
  if (!status.text.empty()) status.state = Status::State::kDegraded;
  if (log_failing || keeper.failing()) status.state = Status::State::kFault;
}

void LiveSession::Core::SendStatus(std::int64_t now) {
  const bool on_time = now >= next_status;
  if (on_time) next_status = std::max(next_status + kSecondUs, now);
  const Status status = StatusNow(on_time);
  const std::int64_t drops = status.kernel_drops.value_or(0);
  if (drops > kernel_drops_said) {
    notices.Say(
        fmt::format("the system has thrown away {} datagrams: its receive buffer was full", drops));
    kernel_drops_said = drops;
  }
  broadcast.Send(status);
  if (on_time) broadcast.Send(GlanceNow());
  const std::lock_guard lock(status_mutex);
  last_status = status;
  last_status_us = now;
}

Glance LiveSession::Core::GlanceNow() const {
  Glance glance;
  const SampleTally tally = surveyor.tally();
  if (tally.newest && tally.newest->ns > 0) glance.utc = *tally.newest;
  const DepthNow& depth = intake.depth();
  if (depth.mark) {
    glance.run = depth.mark->run;
    glance.md = depth.mark->md;
    glance.speed = depth.speed;
    const double rests = (depth.mark->utc - depth.rest_begin).seconds();
    if (rests >= kRests) glance.still = rests;
  }
  glance.still_needed = setup.job.job.alignment.min_still;
  if (const auto& station = broadcast.last()) {
    glance.run = station->run;
    glance.inclination = station->inclination;
    glance.azimuth = station->azimuth;
    glance.sigma_azimuth = std::sqrt(std::max(station->cov_md_inc_azi(2, 2), 0.0));
  }
  glance.samples_lost = tally.lost;
  for (const auto& [code, verdict] : verdicts) {
    glance.checks_warned += verdict == Verdict::kWarn ? 1 : 0;
    glance.checks_failed += verdict == Verdict::kFail ? 1 : 0;
  }
  glance.turned = turned;
  return glance;
}

/// Asks every two seconds, of the tool that was heard of first by its number.
void LiveSession::Core::Advise(std::int64_t now) {
  if (const auto advice = adviser->Take()) broadcast.Send(*advice);
  if (now < next_advice) return;
  const std::vector<std::int32_t> tools = surveyor.tools();
  const std::optional<UtcTime> newest = surveyor.tally().newest;
  if (tools.empty() || !newest || newest->ns <= 0) return;
  if (adviser->Ask(NowOf(surveyor, tools.front()), *newest)) next_advice = now + kAdviceUs;
}

/// Which check has another verdict than in the files before.
void LiveSession::Core::NoteChecks(const std::vector<ToolResult>& tools) {
  std::map<std::string, Verdict> now;
  for (const ToolResult& tool : tools) {
    for (const Check& check : tool.survey.checks) {
      const auto at = now.try_emplace(check.code, check.verdict).first;
      const bool worse = check.verdict == Verdict::kFail ||
                         (check.verdict == Verdict::kWarn && at->second != Verdict::kFail);
      if (worse) at->second = check.verdict;
    }
  }
  for (const auto& [code, verdict] : now) {
    const auto before = verdicts.find(code);
    const bool bad = verdict == Verdict::kWarn || verdict == Verdict::kFail;
    const bool was = before != verdicts.end() && before->second == verdict;
    if (was || (!bad && before == verdicts.end())) continue;
    turned = fmt::format("{} {}", code, WordOf(verdict));
  }
  verdicts = std::move(now);
}

/// In the watchdog's thread: the survey is busy, and the rig should know that it lives.
void LiveSession::Core::SendLate() {
  Status status;
  {
    const std::lock_guard lock(status_mutex);
    status = last_status;
    status.data_age += static_cast<double>(Now() - last_status_us) * 1e-6;
  }
  status.text = kBusy;
  if (status.state == Status::State::kOk) status.state = Status::State::kDegraded;
  broadcast.Send(status);
}

void LiveSession::Core::KeepFiles(std::int64_t now) {
  next_keep = now + kKeepUs;
  if (broadcast.news() == kept_news || !keeper.idle()) return;
  kept_news = broadcast.news();
  Snapshot snapshot = Take();
  NoteChecks(snapshot.tools);
  keeper.Keep(std::move(snapshot));
  const std::int64_t cost = Now() - now;
  next_keep = now + std::max(kKeepUs, kSnapshotShare * cost);
}

SourceRecord LiveSession::Core::Source() const {
  SourceRecord source;
  source.name = bus.url();
  source.faults = intake.faults().faults();
  source.counts["malformed"] = intake.feed().malformed();
  source.counts["refused_by_size"] = bus.refused();
  if (bus.strangers() > 0) source.counts["refused_by_sender"] = bus.strangers();
  if (guard.left_out() > 0) source.counts["messages_of_other_senders"] = guard.left_out();
  if (orders_from_elsewhere > 0) source.counts["orders_from_elsewhere"] = orders_from_elsewhere;
  if (log && log->lost() > 0) source.counts["missing_in_recording"] = log->lost();
  if (const auto drops = bus.kernel_drops()) source.counts["kernel_drops"] = *drops;
  if (const auto granted = bus.granted_receive_buffer()) {
    source.counts["receive_buffer_bytes"] = *granted;
  }
  source.counts["station_latency_median_us"] = station_latency.Of(0.5);
  source.counts["station_latency_p99_us"] = station_latency.Of(0.99);
  source.counts["message_latency_p99_us"] = message_latency.Of(0.99);
  return source;
}

Snapshot LiveSession::Core::Take() const {
  Snapshot snapshot;
  snapshot.folder = setup.out;
  snapshot.tools = ResultsOf(surveyor, setup.out);
  snapshot.record = RecordOf(setup.program, setup.job, setup.formats, intake, broadcast);
  snapshot.source = Source();
  snapshot.source.ended = "not yet";
  return snapshot;
}

void LiveSession::Core::EmptyOutbox() {
  const std::int64_t end = Now() + kOutboxUs;
  while (broadcast.waiting() && Now() < end) {
    broadcast.Pump();
    std::this_thread::sleep_for(std::chrono::milliseconds(kOutboxMs));
  }
}

/// The last files. Those of a survey that has ended are made once, and without a recording never
/// again: where the disk is full they are tried until it is not, or a stop gives them up.
std::optional<Fault> LiveSession::Core::WriteLast(const Snapshot& snapshot, bool patient) {
  auto fault = ResultKeeper::Write(setup.job.job, snapshot);
  if (!fault || !patient) return fault;
  notices.Say(*fault);
  notices.Say("the last files of the survey are tried again every second; a stop gives them up");
  while (fault) {
    Status status = StatusNow(true);
    status.state = Status::State::kFault;
    status.text = "the survey's files cannot be written";
    broadcast.Send(status);
    for (const std::int64_t next = Now() + kSecondUs; Now() < next;) {
      const auto woken = bus.Wait(kOutboxMs);
      if (!woken || *woken == LiveBus::Woken::kStopped) return fault;
    }
    fault = ResultKeeper::Write(setup.job.job, snapshot);
  }
  notices.Say("the survey's files are up to date again");
  return fault;
}

LiveOutcome LiveSession::Core::End(Ended ended) {
  watchdog->Through();
  if (ended == Ended::kFinished) {
    watch.Settle();
    SendStatus(next_status);
  } else {
    // What is known of the samples that still wait for their depth belongs to the result.
    surveyor.Flush();
  }
  Snapshot snapshot = Take();
  snapshot.source.ended = ended == Ended::kFinished      ? "adjusted"
                          : ended == Ended::kInterrupted ? "interrupted"
                                                         : "the bus was lost";
  EmptyOutbox();
  keeper.End();
  if (log) log->Close();
  LiveOutcome outcome;
  outcome.fault = WriteLast(snapshot, ended == Ended::kFinished);
  outcome.ended = ended;
  outcome.recording_is_whole = !log || (!log->failing() && log->lost() == 0);
  outcome.hints = HintsAtChannels(intake.feed());
  outcome.tools = std::move(snapshot.tools);
  outcome.record = std::make_shared<const RunRecord>(std::move(snapshot.record));
  outcome.source = std::make_shared<const SourceRecord>(std::move(snapshot.source));
  return outcome;
}

}  // namespace wellgyro
