#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "wellgyro/bus/lcm_live.h"
#include "wellgyro/record/channels.h"
#include "wellgyro/record/status.h"

#include "intake.h"
#include "live.h"

namespace wellgyro::apps {

/// What a live survey tells the network: stations as they come and status once a second.
class Broadcast : public FaultBook {
 public:
  /// Both must outlive this object.
  Broadcast(LiveBus& bus, const Channels& channels);

  void OnStation(const Station& station) override;
  void OnFault(const Fault& fault) override;
  void OnAcknowledged(std::int32_t command_id) override;

  /// While a log is read again nothing is told.
  void Mute(bool muted) { muted_ = muted; }
  /// Fills in what only the broadcast knows and sends it.
  void Send(Status status);

  std::int64_t stations() const { return stations_; }  ///< told by the surveyor
  std::int64_t news() const { return news_; }          ///< anything the files show
  bool must_acknowledge() const { return must_acknowledge_; }

 private:
  void Publish(const std::string& channel);

  LiveBus& bus_;
  const Channels& channels_;
  FaultTeller teller_;
  std::int32_t session_;
  std::int64_t station_seq_ = 0, status_seq_ = 0;
  std::int64_t stations_ = 0, news_ = 0;
  std::int32_t last_command_id_ = 0;
  bool must_acknowledge_ = false;
  bool muted_ = false;
  bool failed_ = false;
  std::vector<std::byte> bytes_;
};

}  // namespace wellgyro::apps
