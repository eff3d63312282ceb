#include "wellgyro/live/result_keeper.h"

#include <chrono>
#include <exception>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/io/atomic_file.h"

namespace wellgyro {

ResultKeeper::ResultKeeper(const Job& job, Notices& notices)
    : job_(job), notices_(notices), thread_([this] { Work(); }) {}

ResultKeeper::~ResultKeeper() { End(); }

void ResultKeeper::Keep(Snapshot snapshot) {
  const std::lock_guard lock(mutex_);
  waiting_ = std::move(snapshot);
  woken_.notify_one();
}

bool ResultKeeper::idle() const {
  const std::lock_guard lock(mutex_);
  return !waiting_ && !writing_;
}

bool ResultKeeper::failing() const {
  const std::lock_guard lock(mutex_);
  return failing_;
}

std::optional<RunVerdict> ResultKeeper::kept() const {
  const std::lock_guard lock(mutex_);
  return kept_;
}

void ResultKeeper::End() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    waiting_.reset();
    woken_.notify_one();
  }
  if (thread_.joinable()) thread_.join();
}

std::optional<Fault> ResultKeeper::Write(const Job& job, const Snapshot& snapshot) {
  for (const ToolResult& tool : snapshot.tools) {
    if (!tool.survey.unusable.empty()) continue;
    const auto files = ResultFiles(snapshot.record, snapshot.source, job, tool.survey);
    if (auto fault = WriteFiles(tool.folder, files)) return fault;
  }
  RemoveFormer(snapshot.folder, snapshot.tools);
  return std::nullopt;
}

void ResultKeeper::Work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    woken_.wait(lock, [this] { return ending_ || waiting_; });
    if (ending_) return;
    Snapshot snapshot = std::move(*waiting_);
    waiting_.reset();
    writing_ = true;
    lock.unlock();
    std::optional<Fault> fault;
    try {
      fault = Write(job_, snapshot);
    } catch (const std::exception& error) {
      fault = Fault{FaultCode::kConflict, error.what()};
    }
    lock.lock();
    writing_ = false;
    if (fault && !failing_) {
      notices_.Say(*fault);
      notices_.Say("the survey goes on; its files are tried again every second");
    }
    if (!fault && failing_) notices_.Say("the survey's files are up to date again");
    failing_ = fault.has_value();
    if (!failing_ && AnyUsable(snapshot.tools)) kept_ = WorstVerdict(snapshot.tools);
    if (!failing_ || ending_ || waiting_) continue;
    // The disk is full or the folder is gone: what could not be written is not lost.
    woken_.wait_for(lock, std::chrono::seconds(1), [this] { return ending_ || waiting_; });
    if (!waiting_) waiting_ = std::move(snapshot);
  }
}

}  // namespace wellgyro
