#include "broadcast.h"

#include <stdexcept>

#include "wellgyro/bus/encode.h"

#include "report.h"

namespace wellgyro::apps {
namespace {

/// Two programs started within a second of each other on one network are told apart by the user.
std::int32_t SessionNow() { return static_cast<std::int32_t>(NowUs() / 1'000'000 % INT32_MAX); }

}  // namespace

Broadcast::Broadcast(LiveBus& bus, const Channels& channels)
    : bus_(bus), channels_(channels), session_(SessionNow()) {}

void Broadcast::Publish(const std::string& channel) {
  const auto fault = bus_.Publish(channel, bytes_);
  if (fault && !failed_) Complain(*fault);
  failed_ = fault.has_value();
}

void Broadcast::OnStation(const Station& station) {
  ++stations_;
  ++news_;
  if (muted_) return;
  try {
    Encode(SentStation{station, station_seq_, session_}, bytes_);
  } catch (const std::invalid_argument& error) {
    // A station that cannot travel is in the files all the same.
    teller_.Tell({FaultCode::kRange, error.what()});
    return;
  }
  ++station_seq_;
  Publish(channels_.station);
}

void Broadcast::OnFault(const Fault& fault) {
  FaultBook::OnFault(fault);
  if (!muted_) teller_.Tell(fault);
}

void Broadcast::OnAcknowledged(std::int32_t command_id) {
  last_command_id_ = command_id;
  must_acknowledge_ = true;
  ++news_;
}

void Broadcast::Send(Status status) {
  must_acknowledge_ = false;
  status.utc = UtcTime{NowUs() * 1000};
  status.seq = status_seq_++;
  status.session = session_;
  status.last_command_id = last_command_id_;
  Encode(status, bytes_);
  Publish(channels_.status);
}

}  // namespace wellgyro::apps
