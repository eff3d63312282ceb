#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "wellgyro/bus/feed.h"
#include "wellgyro/bus/loss_watch.h"
#include "wellgyro/bus/survey_log.h"
#include "wellgyro/io/result/run_file.h"
#include "wellgyro/live/digester.h"
#include "wellgyro/live/operation_gate.h"
#include "wellgyro/survey/fault_book.h"
#include "wellgyro/survey/surveyor.h"

namespace wellgyro {

/// What the depth system said last.
struct DepthNow {
  std::optional<DepthMark> mark;
  double speed = 0;    ///< [m/s]
  double rest_md = 0;  ///< where the tool came to rest [m]
  UtcTime rest_begin;  ///< since when it has not moved by 2 cm
};

/// Also keeps what the tools say they are, the latest of each in each run, and asks of orders
/// whether they are to be obeyed.
class WELLGYRO_EXPORT ToolBook : public SurveyorListener {
 public:
  ToolBook(const JobFile& job, Surveyor& surveyor, Sink& faults)
      : SurveyorListener(surveyor, faults),
        gate_(job, surveyor,
              [this](const OperationRecord& record, bool event) {
                if (tell_) tell_(record, event);
              }),
        surveyor_(surveyor) {}
  /// Kept as the latest of its tool and run, then handed on.
  void OnTool(const ToolInfo& info) override;
  void OnImu(std::span<const ImuSample> batch) override;
  void OnRaw(std::span<const RawSample> batch) override;
  void OnStill(const StillWindow& window) override;
  /// Follows rests and speed for DepthNow, then handed on.
  void OnDepth(const DepthMark& mark) override;
  void OnMode(const ToolMode& mode) override;
  void OnEvent(const Event& event) override { gate_.Take(event); }
  void OnCommand(const Command& command) override { gate_.Take(command); }
  void OnOperation(const SignedOperation& operation) override { gate_.Take(operation); }
  void Watch(LossWatch& watch) { watch_ = &watch; }
  void Tell(OperationGate::Tell tell) { tell_ = std::move(tell); }
  const OperationGate& gate() const { return gate_; }
  const DepthNow& depth() const { return depth_; }
  const std::vector<ToolInfo>& tools() const { return tools_; }

 private:
  std::vector<ToolInfo> tools_;  ///< by tool and run
  void Heard();

  LossWatch* watch_ = nullptr;
  DepthNow depth_;
  OperationGate::Tell tell_;
  OperationGate gate_;
  Surveyor& surveyor_;
};

/// The messages of one source on their way into a surveyor, with what is written about them.
class WELLGYRO_EXPORT Intake {
 public:
  /// Both must outlive this object.
  Intake(const JobFile& job, Surveyor& surveyor);

  /// `offset`: of the message in its log; -1: it came from none.
  void Take(std::string_view channel, std::span<const std::byte> bytes, std::int64_t offset = -1) {
    feed_.Take(channel, bytes, offset);
  }

  /// What came on each channel so far, with the digest of its accepted payloads.
  std::vector<ChannelRecord> Channels() const;
  const std::vector<ToolInfo>& tools() const { return listener_.tools(); }
  /// `watch`, which must outlive this object, sees all samples too.
  void Watch(LossWatch& watch) { listener_.Watch(watch); }
  /// `tell` hears what becomes of each order.
  void Tell(OperationGate::Tell tell) { listener_.Tell(std::move(tell)); }
  const OperationGate& operations() const { return listener_.gate(); }
  const DepthNow& depth() const { return listener_.depth(); }
  /// Batches of either type: whether the tool still sends.
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

/// Sentences that say which channel carries one of our types under a name that the job does not
/// know.
WELLGYRO_EXPORT std::vector<std::string> HintsAtChannels(const Feed& feed);

}  // namespace wellgyro
