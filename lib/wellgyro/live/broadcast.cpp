#include "wellgyro/live/broadcast.h"

#include <stdexcept>
#include <utility>

#include "wellgyro/bus/encode.h"
#include "wellgyro/bus/glance_channel.h"
#include "wellgyro/record/advice.h"
#include "wellgyro/record/glance.h"
#include "wellgyro/record/limits.h"

namespace wellgyro {

// Two programs started within a second of each other on one network are told apart by the user.
Broadcast::Broadcast(LiveBus& bus, const Channels& channels, const LiveClock& clock,
                     Notices& notices)
    : bus_(bus),
      channels_(channels),
      clock_(clock),
      notices_(notices),
      session_(static_cast<std::int32_t>(clock.utc_us() / 1'000'000 % INT32_MAX)) {}

void Broadcast::Publish(const std::string& channel, const std::vector<std::byte>& bytes) {
  const std::lock_guard lock(mutex_);
  const auto fault = bus_.Publish(channel, bytes);
  if (fault && !failed_) notices_.Say(*fault);
  failed_ = fault.has_value();
}

void Broadcast::OnStation(const Station& station) {
  ++stations_;
  ++news_;
  last_ = station;
  told_.insert_or_assign(KeyOf(station), station);
  if (muted_) return;
  Queue(station);
  Pump();
  notices_.With([&station](LiveObserver& observer) { observer.OnStation(station); });
}

void Broadcast::Queue(const Station& station) {
  std::vector<std::byte> bytes;
  try {
    Encode(SentStation{station, station_seq_, session_}, bytes);
  } catch (const std::invalid_argument& error) {
    // A station that cannot travel is in the files all the same.
    notices_.Tell({FaultCode::kRange, error.what()});
    return;
  }
  ++station_seq_;
  outbox_.push_back(std::move(bytes));
}

void Broadcast::Pump() {
  if (outbox_.empty()) return;
  const std::int64_t now = clock_.monotonic_us();
  if (now - pump_us_ >= kPauseUs) {
    pump_us_ = now;
    pumped_ = 0;
  }
  for (; pumped_ < kAtOnce && !outbox_.empty(); ++pumped_) {
    Publish(channels_.station, outbox_.front());
    outbox_.pop_front();
  }
}

void Broadcast::SayAgain(std::int32_t from_revision) {
  const std::int64_t now = clock_.monotonic_us();
  if (muted_ || now - again_us_ < 1'000'000) return;
  again_us_ = now;
  for (const auto& [key, station] : told_) {
    if (station.revision >= from_revision) Queue(station);
  }
}

void Broadcast::Send(Glance glance) {
  glance.seq = glance_seq_++;
  glance.session = session_;
  glance.stations = stations_;
  if (!SendBeside(GlanceChannel(channels_), glance)) return;
  notices_.With([&glance](LiveObserver& observer) { observer.OnGlance(glance); });
}

void Broadcast::Send(Advice advice) {
  advice.seq = advice_seq_++;
  advice.session = session_;
  if (!SendBeside(AdviceChannel(channels_), advice)) return;
  notices_.With([&advice](LiveObserver& observer) { observer.OnAdvice(advice); });
}

/// On a channel beside the status'; false: it cannot travel.
template <class Record>
bool Broadcast::SendBeside(const std::string& channel, const Record& record) {
  std::vector<std::byte> bytes;
  try {
    Encode(record, bytes);
  } catch (const std::invalid_argument& error) {
    notices_.Tell({FaultCode::kRange, error.what()});
    return false;
  }
  if (channel.size() > limits::kChannel) return false;
  Publish(channel, bytes);
  return true;
}

void Broadcast::OnFault(const Fault& fault) {
  FaultBook::OnFault(fault);
  if (!muted_) notices_.Tell(fault);
}

void Broadcast::OnAcknowledged(std::int32_t command_id) {
  {
    const std::lock_guard lock(mutex_);
    last_command_id_ = command_id;
  }
  must_acknowledge_ = true;
  ++news_;
}

void Broadcast::Send(Status status) {
  must_acknowledge_ = false;
  std::vector<std::byte> bytes;
  status.utc = UtcTime{clock_.utc_us() * 1000};
  {
    const std::lock_guard lock(mutex_);
    status.seq = status_seq_++;
    status.last_command_id = last_command_id_;
  }
  status.session = session_;
  Encode(status, bytes);
  Publish(channels_.status, bytes);
  notices_.With([&status](LiveObserver& observer) { observer.OnStatus(status); });
}

}  // namespace wellgyro
