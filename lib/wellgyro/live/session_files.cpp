// What a live session writes: its files, its end.
#include <algorithm>
#include <chrono>
#include <memory>
#include <thread>
#include <utility>

#include "wellgyro/live/observer.h"
#include "wellgyro/live/session_core_internal.h"

namespace wellgyro {
namespace {

constexpr std::int64_t kKeepUs = 500'000;  // twice a second: nobody reads files more often
// For stations that were not sent yet at the end: 2000 of them at Broadcast's pace.
constexpr std::int64_t kOutboxUs = 1'000'000;
constexpr int kOutboxMs = 10;  // Broadcast's pause
// After a snapshot that took t the next one comes 200 t later at the soonest: 0.5 % of the stream's
// thread, so that few stations wait for one.
constexpr std::int64_t kSnapshotShare = 200;

}  // namespace

void LiveSession::Core::KeepFiles(std::int64_t now) {
  next_keep = now + kKeepUs;
  if (broadcast.news() == kept_news || !keeper.idle()) return;
  kept_news = broadcast.news();
  Snapshot snapshot = Take();
  reporter.Note(snapshot.tools);
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
  reporter.CountLatencies(source);
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
    reporter.ReportFault("the survey's files cannot be written");
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
    reporter.Report(reporter.next_us());
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
