#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "wellgyro/bus/feed.h"
#include "wellgyro/bus/loss_watch.h"
#include "wellgyro/bus/surveyor_listener.h"
#include "wellgyro/io/result/run_file.h"
#include "wellgyro/survey/surveyor.h"

#include "digester.h"

namespace wellgyro::apps {

/// Keeps the first faults and counts them all.
class FaultBook : public Sink {
 public:
  static constexpr std::size_t kKept = 1000;

  void OnFault(const Fault& fault) override {
    ++count_;
    if (faults_.size() < kKept) faults_.push_back(fault);
  }
  const std::vector<Fault>& faults() const { return faults_; }
  std::int64_t count() const { return count_; }

 private:
  std::vector<Fault> faults_;
  std::int64_t count_ = 0;
};

/// Also keeps what the tools say they are, the latest of each in each run, and whether someone has
/// asked for the end.
class ToolBook : public SurveyorListener {
 public:
  using SurveyorListener::SurveyorListener;
  void OnTool(const ToolInfo& info) override;
  void OnImu(std::span<const ImuSample> batch) override;
  void OnRaw(std::span<const RawSample> batch) override;
  void OnCommand(const Command& command) override;
  void Watch(LossWatch& watch) { watch_ = &watch; }
  bool finish_heard() const { return finish_heard_; }
  const std::vector<ToolInfo>& tools() const { return tools_; }

 private:
  std::vector<ToolInfo> tools_;  ///< by tool and run
  LossWatch* watch_ = nullptr;
  bool finish_heard_ = false;
};

/// The messages of one source on their way into a surveyor, with what is written about them.
class Intake {
 public:
  /// Both must outlive this object.
  Intake(const Job& job, Surveyor& surveyor);

  /// `offset`: of the message in its log; -1: it came from none.
  void Take(std::string_view channel, std::span<const std::byte> bytes, std::int64_t offset = -1) {
    feed_.Take(channel, bytes, offset);
  }

  std::vector<ChannelRecord> Channels() const;
  const std::vector<ToolInfo>& tools() const { return listener_.tools(); }
  /// `watch`, which must outlive this object, sees all samples too.
  void Watch(LossWatch& watch) { listener_.Watch(watch); }
  bool finish_heard() const { return listener_.finish_heard(); }
  std::int64_t sample_messages() const {
    return feed_.count(MessageType::kImuBatch).messages +
           feed_.count(MessageType::kRawBatch).messages;
  }
  const Feed& feed() const { return feed_; }
  const FaultBook& faults() const { return feed_faults_; }

 private:
  FaultBook feed_faults_;
  ToolBook listener_;
  mutable Digester digester_;  ///< waiting for a digest changes nothing that shows
  Feed feed_;
};

/// Says which channel carries one of our types under a name that the job does not know.
void HintAtChannels(const Feed& feed);

}  // namespace wellgyro::apps
