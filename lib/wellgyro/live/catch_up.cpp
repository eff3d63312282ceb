#include "wellgyro/live/catch_up.h"

#include <filesystem>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/bus/log_reader.h"
#include "wellgyro/bus/stream_guard.h"

namespace wellgyro {
namespace {

constexpr std::int64_t kPatienceUs = 10'000'000;  // for a recorder's log to reach the live stream
constexpr std::int64_t kQuietUs = 2'000'000;      // neither log nor bus says anything: joined
constexpr int kPollMs = 50;  // between looks at a growing log: 20 a second, far below kQuietUs
// A recorder that began after the own log ended has all that came since, or it is lost.
constexpr std::size_t kLookedBackAt = Splice::kKept;
// A log that has just begun may lack what waits for its sender to be known (see StreamGuard).
constexpr std::int64_t kWaitsUs = 2 * StreamGuard::kSilentUs;

}  // namespace

/// A log that may still be growing.
struct CatchUp::Follower {
  std::string path;
  std::int64_t at = 0;

  /// How many events were new.
  Result<std::int64_t> Read(const std::function<void(const LogEvent&)>& use) {
    Result<LogReader> reader = LogReader::OpenAt(path, at);
    if (!reader) return reader.fault();
    std::int64_t count = 0;
    LogEvent event;
    while (reader->Next(event)) {
      use(event);
      ++count;
      at = event.data_offset + static_cast<std::int64_t>(event.data.size());
    }
    return count;
  }
};

MessageKey CatchUp::Key(std::string_view channel, std::span<const std::byte> bytes) const {
  const auto type = TypeOn(channels_, channel);
  const bool once = type == MessageType::kImuBatch || type == MessageType::kRawBatch ||
                    type == MessageType::kDepth || type == MessageType::kStillWindow;
  return KeyOf(channel, bytes, once);
}

void CatchUp::NoteUsed(std::string_view channel, const MessageKey& key) {
  splice_.Used(key);
  if (heard_.find(channel) == heard_.end()) heard_.emplace(channel);
  if (!key.once) return;
  const auto found = last_.find(channel);
  if (found == last_.end()) {
    last_.emplace(channel, key);
  } else {
    found->second = key;
  }
}

void CatchUp::UseOne(const HeldMessage& message, bool fresh) {
  NoteUsed(message.channel, Key(message.channel, message.bytes));
  last_received_us_ = message.received_us;
  use_(message.channel, message.bytes, message.received_us, fresh);
}

std::optional<Fault> CatchUp::OwnLog(const std::string& path, std::int64_t begun_us) {
  begun_us_ = begun_us;
  Result<LogReader> reader = LogReader::Open(path);
  // Killed before its first whole event: there is nothing to continue from.
  if (!reader) {
    std::error_code absent;
    const auto size = std::filesystem::file_size(path, absent);
    if (absent || size == 0 || reader.fault().code == FaultCode::kDamaged) return std::nullopt;
    return reader.fault();
  }
  LogEvent event;
  while (reader->Next(event)) {
    NoteUsed(event.channel, Key(event.channel, event.data));
    use_(event.channel, event.data, event.received_us, false);
    last_received_us_ = event.received_us;
  }
  return std::nullopt;
}

void CatchUp::Hold(std::string_view channel, std::span<const std::byte> bytes,
                   std::int64_t received_us) {
  held_.push_back({std::string(channel), {bytes.begin(), bytes.end()}, received_us});
}

/// What came before the place where our log ended is in it, but for streams of which it has
/// nothing: their sender was not known yet (see StreamGuard), and what waited for that went with
/// the program.
void CatchUp::UseUnheard(std::vector<HeldMessage> before) {
  std::erase_if(before, [this](const HeldMessage& message) {
    return !Key(message.channel, message.bytes).once || heard_.contains(message.channel);
  });
  for (const HeldMessage& message : before) UseOne(message, true);
}

void CatchUp::TakeFill(const HeldMessage& message) {
  if (message.received_us < begun_us_) return;
  if (!fill_begun_us_) fill_begun_us_ = message.received_us;
  const MessageKey key = Key(message.channel, message.bytes);
  if (joined_fill_) {
    if (!splice_.WasUsed(key)) UseOne(message, true);
    return;
  }
  // Whether this is behind what was used shows when the last one used comes by.
  if (splice_.Find({&key, 1})) {
    joined_fill_ = true;
    UseUnheard(std::exchange(before_, {}));
    splice_.Used(key);  // it is still the last
    return;
  }
  before_.push_back(message);
  // A recorder that began later never brings it.
  const bool later = splice_.empty() || message.received_us > last_received_us_ + kQuietUs;
  if (!later) {
    if (before_.size() > kLookedBackAt) before_.erase(before_.begin());
    return;
  }
  joined_fill_ = true;
  // Not by the last one used here: what waited for its sender stands behind what came after it.
  const bool all = splice_.empty();
  const std::int64_t ended = last_received_us_;
  for (const HeldMessage& since : std::exchange(before_, {})) {
    if (all || since.received_us > ended) UseOne(since, true);
  }
}

std::vector<MessageKey> CatchUp::HeldKeys() const {
  std::vector<MessageKey> keys;
  for (const HeldMessage& m : held_) keys.push_back(Key(m.channel, m.bytes));
  return keys;
}

/// Where in what is held the last one used of each channel stands.
std::map<std::string_view, std::size_t> CatchUp::Joints(const std::vector<MessageKey>& keys) const {
  std::map<std::string_view, std::size_t> joints;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const auto last = last_.find(held_[i].channel);
    if (last == last_.end() || !keys[i].once || last->second.hash != keys[i].hash) continue;
    joints.try_emplace(last->first, i);
  }
  return joints;
}

/// Whether the log has reached the stream on every channel that is heard, and lacks nothing that
/// may still wait.
bool CatchUp::Reached(bool quiet) const {
  const std::vector<MessageKey> keys = HeldKeys();
  const auto joints = Joints(keys);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (keys[i].once && !joints.contains(held_[i].channel)) return false;
  }
  return !joints.empty() &&
         (quiet || last_received_us_ - fill_begun_us_.value_or(last_received_us_) > kWaitsUs);
}

void CatchUp::Join() {
  splice_.Turn();
  const std::vector<MessageKey> keys = HeldKeys();
  const auto joints = Joints(keys);
  const std::optional<std::size_t> joint = splice_.Find(keys);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const HeldMessage& message = held_[i];
    if (keys[i].once) {
      const auto last = joints.find(message.channel);
      if (last == joints.end() || i > last->second) UseOne(message, true);
    } else if ((!joint || i > *joint) && !splice_.WasUsed(keys[i])) {
      UseOne(message, true);
    }
  }
  held_.clear();
}

Result<std::int64_t> CatchUp::ReadOn(Follower& log) {
  return log.Read([this](const LogEvent& event) {
    TakeFill(
        {std::string(event.channel), {event.data.begin(), event.data.end()}, event.received_us});
  });
}

Result<bool> CatchUp::Follow(LiveBus& bus, Follower& log) {
  const std::int64_t begin = clock_.monotonic_us();
  std::int64_t last_news = begin;
  for (;;) {
    const auto count = ReadOn(log);
    if (!count) return count.fault();
    const std::size_t held_before = held_.size();
    const auto woken = bus.Wait(kPollMs);
    if (!woken) return woken.fault();
    if (*woken == LiveBus::Woken::kStopped) return true;
    const std::int64_t now = clock_.monotonic_us();
    if (*count > 0 || held_.size() > held_before) last_news = now;
    const bool quiet = now - last_news > kQuietUs;
    if (Reached(quiet) || (held_.empty() && quiet)) return false;
    if (now - begin < kPatienceUs) continue;
    notices_.Say(fmt::format("{} does not reach the live stream: what was sent between may be lost",
                             log.path));
    return false;
  }
}

Result<bool> CatchUp::FillAndJoin(LiveBus& bus, const std::vector<std::string>& logs) {
  bool stopped = false;
  for (std::size_t i = 0; i < logs.size() && !stopped; ++i) {
    splice_.Turn();
    joined_fill_ = false;
    fill_begun_us_.reset();
    before_.clear();
    Follower log{logs[i]};
    if (i + 1 < logs.size()) {
      if (const auto count = ReadOn(log); !count) return count.fault();
      continue;
    }
    const auto followed = Follow(bus, log);
    if (!followed) return followed.fault();
    stopped = *followed;
  }
  Join();
  return stopped;
}

}  // namespace wellgyro
