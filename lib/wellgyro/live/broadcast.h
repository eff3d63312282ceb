#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "wellgyro/bus/lcm_live.h"
#include "wellgyro/live/intake.h"
#include "wellgyro/live/notices.h"
#include "wellgyro/live/observer.h"
#include "wellgyro/record/advice.h"
#include "wellgyro/record/channels.h"
#include "wellgyro/record/glance.h"
#include "wellgyro/record/operations.h"
#include "wellgyro/record/station.h"
#include "wellgyro/survey/stations/station_key.h"

namespace wellgyro {

/// What a live survey tells the network: stations as they come and status once a second. Send may
/// be called from another thread than the rest.
class WELLGYRO_EXPORT Broadcast : public FaultBook {
 public:
  /// All must outlive this object.
  Broadcast(LiveBus& bus, const Channels& channels, const LiveClock& clock, Notices& notices);

  void OnStation(const Station& station) override;
  void OnFault(const Fault& fault) override;
  /// The next status, which is due at once then, says so.
  void OnAcknowledged(std::int32_t command_id) override;

  /// Sends of what waits as much as the bus may carry now; to be called every few milliseconds
  /// while something waits. A burst of revised stations would overrun the queue of 30 messages that
  /// an LCM receiver has by default.
  void Pump();
  bool waiting() const { return !outbox_.empty(); }  ///< stations that Pump has still to send
  /// Every station told, in its last revision, where that is this one or later; once a second.
  void SayAgain(std::int32_t from_revision);
  void Send(Glance glance);
  void Send(Advice advice);
  /// The last station told, muted or not.
  const std::optional<Station>& last() const { return last_; }

  /// While a log is read again nothing is told.
  void Mute(bool muted) { muted_ = muted; }
  /// Fills in what only the broadcast knows and sends it.
  void Send(Status status);

  std::int64_t stations() const { return stations_; }          ///< told by the surveyor
  std::int64_t news() const { return news_; }                  ///< anything the files show
  bool must_acknowledge() const { return must_acknowledge_; }  ///< a status is due at once

 private:
  /// Stations and their pause: 2000 a second, 0.6 MB/s of some 290 bytes each.
  static constexpr int kAtOnce = 20;
  static constexpr std::int64_t kPauseUs = 10'000;
  void Queue(const Station& station);
  template <class Record>
  bool SendBeside(const std::string& channel, const Record& record);
  void Publish(const std::string& channel, const std::vector<std::byte>& bytes);

  LiveBus& bus_;
  const Channels& channels_;
  const LiveClock& clock_;
  Notices& notices_;
  std::int32_t session_;
  std::int64_t station_seq_ = 0, status_seq_ = 0;
  std::int64_t stations_ = 0, news_ = 0;
  std::int32_t last_command_id_ = 0;
  std::atomic<bool> must_acknowledge_ = false;
  std::map<StationKey, Station> told_;
  std::optional<Station> last_;
  std::deque<std::vector<std::byte>> outbox_;
  std::int64_t pump_us_ = 0, again_us_ = 0;
  int pumped_ = 0;  ///< since then
  std::int64_t glance_seq_ = 0, advice_seq_ = 0;
  bool muted_ = false;
  bool failed_ = false;
  std::mutex mutex_;  ///< of what Send uses, which the session's watchdog calls too
};

}  // namespace wellgyro
