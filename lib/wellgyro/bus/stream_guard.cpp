#include "wellgyro/bus/stream_guard.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/bus/batch_internal.h"
#include "wellgyro/bus/bytes_internal.h"

namespace wellgyro {
namespace {

// Messages in order that count, and those that a break of the order costs: 16 - 3 * 4 = kInOrder,
// three breaks in a row leave a sender proven, a fourth does not.
constexpr int kOrderMost = 16, kOrderBroken = 4;
constexpr int kSilentAgain = 10;  // times kSilentUs, and what was heard before counts no more
constexpr int kOtherAddress = 5;  // times as long a silence lets another address in
// 4 * 5 s = kSilentAgain * kSilentUs: when another may take over at the latest, what it sends is
// news whatever its time.
constexpr int kUsualIntervals = 4;
constexpr std::int64_t kIntervalMost = 5'000'000;  // [us]
// Numbers of an own sender looked back at, one bit each: .5 kB a stream, 4 s at 1000 messages/s;
// and ahead: 17 min lost at that rate. A number drawn from all 2^32 is within them once in 4080.
constexpr std::int32_t kBehind = 4096, kAhead = 1 << 20;
constexpr int kToldOf = 3;                              // senders of one stream
constexpr std::int64_t kReach = std::int64_t{1} << 60;  // of numbers, so that none overflows
// Bytes, by the fields in their order: of depth_t utime_us, seq, then session, run, status and
// source of four bytes each and four doubles; of still_window_t utime_us, duration_ns, seq, then
// session, run, tool and status.
constexpr std::size_t kDepthSeqAt = kFingerprintSize + 8,
                      kDepthSize = kDepthSeqAt + 8 + 4 * 4 + 4 * 8;
constexpr std::size_t kStillSeqAt = kFingerprintSize + 2 * 8,
                      kStillToolAt = kStillSeqAt + 8 + 2 * 4, kStillHead = kStillToolAt + 2 * 4;
// A sender whose numbers do not continue is another one at the same address and port.
constexpr std::uint64_t kElsewhere = std::uint64_t{1} << 63;

template <class Head>
std::optional<Head> HeadOf(std::span<const std::byte> bytes) {
  if (bytes.size() < kArraysAt) return std::nullopt;
  FieldReader reader(bytes.first(kArraysAt), kFingerprintSize);
  Head head;
  Fields(reader, head);
  const bool good = !reader.Finish() && head.size() == bytes.size();
  return good ? std::optional(head) : std::nullopt;
}

std::size_t Slot(std::uint32_t number) { return number % static_cast<std::uint32_t>(kBehind); }

std::uint64_t AddressOf(std::uint64_t id) { return (id & ~kElsewhere) >> 16; }

}  // namespace

/// Whose stream a message is part of; nothing where it is none, or none that can be read.
std::optional<StreamGuard::Key> StreamGuard::Find(const Message& message, Place& place) const {
  const auto type = TypeOn(channels_, message.channel);
  const std::span<const std::byte> bytes = message.bytes;
  if (!type || bytes.size() < kFingerprintSize ||
      Load<std::uint64_t>(bytes.data()) != Fingerprint(*type)) {
    return std::nullopt;
  }
  const auto batch = [&place](const auto& head) {
    const SampleStamp& stamp = head->stamp;
    place = {stamp.seq, stamp.seq + head->n, stamp.tool_time.ns, stamp.period_ns, stamp.session};
    return stamp.tool;
  };
  const auto timed = [&](std::size_t seq_at) {
    const auto utime = Load<std::int64_t>(bytes.data() + kFingerprintSize);
    const auto seq = std::clamp(Load<std::int64_t>(bytes.data() + seq_at), -kReach, kReach);
    place = {seq, seq + 1, utime, 0, Load<std::int32_t>(bytes.data() + seq_at + 8)};
  };
  if (type == MessageType::kImuBatch) {
    const auto head = HeadOf<ImuHead>(bytes);
    return head ? std::optional(Key(*type, batch(head))) : std::nullopt;
  }
  if (type == MessageType::kRawBatch) {
    const auto head = HeadOf<RawHead>(bytes);
    return head ? std::optional(Key(*type, batch(head))) : std::nullopt;
  }
  if (type == MessageType::kDepth && bytes.size() == kDepthSize) {
    timed(kDepthSeqAt);
    return Key(*type, 0);
  }
  if (type == MessageType::kStillWindow && bytes.size() > kStillHead) {
    timed(kStillSeqAt);
    return Key(*type, Load<std::int32_t>(bytes.data() + kStillToolAt));
  }
  return std::nullopt;
}

StreamGuard::Stream& StreamGuard::StreamOf(const Key& key, std::int64_t received_us) {
  auto found = streams_.find(key);
  if (found == streams_.end() && streams_.size() >= kStreams) {
    const auto least = std::ranges::min_element(streams_, {}, [](const auto& s) {
      const bool proven = s.second.owned && s.second.speakers.front().proven();
      return std::pair(proven, s.second.heard_us);
    });
    for (Speaker& speaker : least->second.speakers) Forget(speaker);
    streams_.erase(least);
  }
  if (found == streams_.end()) found = streams_.try_emplace(key).first;
  found->second.heard_us = received_us;
  return found->second;
}

/// Made where there is none; of too many the weakest gives way.
StreamGuard::Speaker& StreamGuard::SpeakerOf(Stream& stream, std::uint64_t id) {
  std::list<Speaker>& all = stream.speakers;
  const auto others = stream.owned ? std::next(all.begin()) : all.begin();
  const auto found = std::find_if(others, all.end(), [id](const Speaker& s) { return s.id == id; });
  if (found != all.end()) return *found;
  if (all.size() >= kSpeakers) DropWeakest(stream);
  Speaker speaker;
  speaker.id = id;
  return *all.insert(stream.owned ? std::next(all.begin()) : all.begin(), std::move(speaker));
}

void StreamGuard::Take(const Message& message) {
  Place place;
  const std::optional<Key> key = message.by.sender == 0 ? std::nullopt : Find(message, place);
  if (!key) return IsForeign(message) ? Leave(message) : use_(message);
  Stream& stream = StreamOf(*key, message.received_us);
  if (IsOwn(stream, message.by)) {
    TakeOwn(stream, place, message);
  } else {
    TakeOther(*key, stream, place, message);
  }
}

/// What cannot be read, on a channel whose streams are all known to be of others, or of a number
/// that has come.
bool StreamGuard::IsForeign(const Message& message) const {
  const auto type = message.by.sender == 0 ? std::nullopt : TypeOn(channels_, message.channel);
  bool known = false;
  if (!type) return false;
  for (const auto& [key, stream] : streams_) {
    if (key.first != type || !stream.owned || !stream.speakers.front().proven()) continue;
    if (stream.speakers.front().id == message.by.sender) return HasCome(stream, message.by.number);
    known = true;
  }
  return known;
}

bool StreamGuard::HasCome(const Stream& stream, std::uint32_t number) {
  const Speaker& own = stream.speakers.front();
  const auto ahead = static_cast<std::int32_t>(number - own.number);
  return own.numbers && ahead <= 0 && ahead > -kBehind && stream.came[Slot(number)];
}

bool StreamGuard::IsOwn(const Stream& stream, const SentBy& by) {
  if (!stream.owned) return false;
  const Speaker& own = stream.speakers.front();
  if (own.id != by.sender) return false;
  const auto ahead = static_cast<std::int32_t>(by.number - own.number);
  return !own.numbers || (ahead > -kBehind && ahead < kAhead);
}

/// False: a message of this number has come.
bool StreamGuard::NoteNumber(Stream& stream, std::uint32_t number) {
  Speaker& own = stream.speakers.front();
  if (!own.numbers) return true;
  if (HasCome(stream, number)) return false;
  const auto ahead = static_cast<std::int32_t>(number - own.number);
  for (std::int32_t i = 1; i <= std::min(ahead, kBehind); ++i) {
    stream.came[Slot(own.number + static_cast<std::uint32_t>(i))] = false;
  }
  if (ahead > 0) own.number = number;
  stream.came[Slot(number)] = true;
  return true;
}

bool StreamGuard::Rises(const Place& a, const Place& b) {
  return a.session == b.session && b.time > a.time && b.end >= a.end;
}

/// `b` is what comes right behind `a`.
bool StreamGuard::Joins(const Place& a, const Place& b) {
  if (!Rises(a, b) || b.begin <= a.begin || b.begin > a.end) return false;
  // Times are within reach, and the numbers less than a batch apart.
  const std::int64_t off = b.time - a.time - (b.begin - a.begin) * a.period;
  return a.period == 0 || std::abs(off) <= a.period / 2;
}

/// Notes that `place` came from the speaker; false where that is no way on.
bool StreamGuard::Continue(Speaker& speaker, const Place& place, bool own) {
  const std::optional<Place> before = std::exchange(speaker.last, place);
  if (before == place) return true;
  const bool rises = before && Rises(*before, place);
  if (rises && Joins(*before, place)) {
    speaker.in_order = std::min(speaker.in_order + 1, kOrderMost);
  } else {
    speaker.in_order = own ? std::max(speaker.in_order - kOrderBroken, 0) : 1;
  }
  speaker.rising = rises ? std::min(speaker.rising + 1, kRising) : own ? speaker.rising / 2 : 1;
  return rises;
}

void StreamGuard::Hear(Speaker& speaker, std::int64_t received_us) {
  const std::int64_t since = speaker.heard_us > 0 ? received_us - speaker.heard_us : 0;
  speaker.interval_us = std::clamp(since, speaker.interval_us / 8 * 7, kIntervalMost);
  speaker.heard_us = received_us;
}

/// Beyond what the own sender has said.
bool StreamGuard::IsNews(const Stream& stream, const Place& place, std::int64_t received_us) {
  if (!stream.owned) return true;
  const Speaker& own = stream.speakers.front();
  if (!own.last || !own.proven() || received_us - own.heard_us > kSilentAgain * kSilentUs)
    return true;
  if (place.period == 0) return place.time > own.last->time;
  return place.session != own.last->session || place.end > own.last->end;
}

bool StreamGuard::MayTakeOver(const Stream& stream, const Speaker& speaker,
                              std::int64_t received_us) {
  if (!speaker.proven()) return false;
  if (!stream.owned || !stream.speakers.front().proven()) return true;
  const Speaker& own = stream.speakers.front();
  const std::int64_t silent = std::max(kSilentUs, kUsualIntervals * own.interval_us);
  const bool same_address = AddressOf(own.id) == AddressOf(speaker.id);
  return received_us - own.heard_us > (same_address ? silent : kOtherAddress * silent);
}

void StreamGuard::TakeOwn(Stream& stream, const Place& place, const Message& message) {
  if (!NoteNumber(stream, message.by.number)) return Leave(message);
  Speaker& own = stream.speakers.front();
  Continue(own, place, true);
  Hear(own, message.received_us);
  use_(message);
}

/// Who says this, of those whose stream it is not: a sender whose numbers do not continue is
/// another one at the same address and port. None: it has said it before, or something older.
StreamGuard::Speaker* StreamGuard::OtherOf(Stream& stream, const Place& place, const SentBy& by) {
  const bool own = stream.owned && stream.speakers.front().id == by.sender;
  for (const std::uint64_t id : {by.sender, by.sender | kElsewhere}) {
    if (own && id == by.sender) continue;
    Speaker& speaker = SpeakerOf(stream, id);
    if (!speaker.last) return &speaker;
    const auto ahead = static_cast<std::int32_t>(by.number - speaker.number);
    // One that does not count its messages shows it before it is believed.
    if (ahead == 0 && Joins(*speaker.last, place)) speaker.numbers = false;
    if (!speaker.numbers || (ahead > 0 && ahead < kAhead)) return &speaker;
    if (ahead > -kBehind && ahead <= 0) return nullptr;
  }
  // Neither continues: the second begins anew.
  Speaker& speaker = SpeakerOf(stream, by.sender | kElsewhere);
  Forget(speaker);
  speaker.last.reset();
  return &speaker;
}

void StreamGuard::TakeOther(const Key& key, Stream& stream, const Place& place,
                            const Message& message) {
  Speaker* other = OtherOf(stream, place, message.by);
  if (other == nullptr) return Leave(message);
  Speaker& speaker = *other;
  if (stream.owned) TellOf(key, stream, speaker, message.by);
  if (!IsNews(stream, place, message.received_us)) {
    Forget(speaker);
    return Leave(message);
  }
  speaker.number = message.by.number;
  if (!Continue(speaker, place, false)) DropHeld(speaker);
  Hear(speaker, message.received_us);
  Hold(speaker, message);
  if (IsAlone(key, stream, speaker) || MayTakeOver(stream, speaker, message.received_us)) {
    if (stream.owned && tell_) {
      tell_(
          fmt::format("{} is read from {} from now on: who sent it before is silent, or out of "
                      "order",
                      message.channel, NameOf(message.by)));
    }
    Own(stream, speaker);
  }
}

/// Nobody else has sent the stream, and it comes so rarely that its order shows too late. Averages
/// at rest come every few minutes.
bool StreamGuard::IsAlone(const Key& key, const Stream& stream, const Speaker& speaker) {
  if (stream.owned || stream.speakers.size() > 1) return false;
  if (key.first == MessageType::kStillWindow) return true;
  return key.first == MessageType::kDepth &&
         speaker.heard_us - speaker.held.front().received_us >= kSilentUs;
}

/// The stream is `speaker`'s from now on, with what it said before.
void StreamGuard::Own(Stream& stream, const Speaker& speaker) {
  const auto at = std::ranges::find(stream.speakers, speaker.id, &Speaker::id);
  stream.speakers.splice(stream.speakers.begin(), stream.speakers, at);
  stream.owned = true;
  // What was sent before that has come, or comes too late.
  stream.came.assign(kBehind, true);
  Speaker& own = stream.speakers.front();
  own.id &= ~kElsewhere;
  // Whoever was this address and port before is nobody now.
  for (auto other = std::next(stream.speakers.begin()); other != stream.speakers.end(); ++other) {
    Forget(*other);
    if (other->id == own.id) other->id |= kElsewhere;
  }
  if (!own.held.empty()) own.number = own.held.front().by.number - 1;
  for (const Held& held : std::exchange(own.held, {})) {
    held_bytes_ -= held.bytes.size();
    NoteNumber(stream, held.by.number);
    use_({held.channel, held.bytes, held.received_us, held.by});
  }
}

void StreamGuard::Leave(const Message& message) {
  ++left_out_;
  if (leave_) leave_(message);
}

void StreamGuard::Hold(Speaker& speaker, const Message& message) {
  if (held_bytes_ + message.bytes.size() > kHeldMax) {
    // Of what waits, so much is of those who never come to an order.
    for (auto& [key, stream] : streams_) {
      for (Speaker& one : stream.speakers) {
        if (!one.held.empty() && &one != &speaker) Forget(one);
      }
    }
    if (held_bytes_ > kHeldMax / 2) Forget(speaker);
  }
  held_bytes_ += message.bytes.size();
  speaker.held.push_back({std::string(message.channel),
                          {message.bytes.begin(), message.bytes.end()},
                          message.received_us,
                          message.by});
}

/// Of those whose stream it is not: the longest unheard of what has no order yet.
void StreamGuard::DropWeakest(Stream& stream) {
  const auto others = stream.owned ? std::next(stream.speakers.begin()) : stream.speakers.begin();
  const auto weakest =
      std::ranges::min_element(others, stream.speakers.end(), {},
                               [](const auto& s) { return std::pair(s.in_order > 1, s.heard_us); });
  Forget(*weakest);
  stream.speakers.erase(weakest);
}

void StreamGuard::DropHeld(Speaker& speaker) {
  for (const Held& held : std::exchange(speaker.held, {})) {
    held_bytes_ -= held.bytes.size();
    Leave({held.channel, held.bytes, held.received_us, held.by});
  }
}

void StreamGuard::Forget(Speaker& speaker) {
  DropHeld(speaker);
  speaker.in_order = speaker.rising = 0;
}

void StreamGuard::TellOf(const Key& key, Stream& stream, Speaker& speaker, const SentBy& by) {
  if (!tell_ || stream.told >= kToldOf || std::exchange(speaker.told, true)) return;
  ++stream.told;
  const SentBy own{stream.speakers.front().id, 0};
  const std::string& channel = NameOf(channels_, key.first);
  if (own.sender == by.sender) {
    tell_(fmt::format("{}: messages of {} whose numbers do not continue its others' are not read",
                      channel, NameOf(by)));
  } else if (key.first == MessageType::kDepth) {
    tell_(fmt::format("{} comes from {}; {} sends it too and is not read while the first speaks",
                      channel, NameOf(own), NameOf(by)));
  } else {
    tell_(fmt::format("two senders on {} for tool {}: {} is read, {} is not while the first speaks",
                      channel, key.second, NameOf(own), NameOf(by)));
  }
}

void StreamGuard::Flush() {
  // Beside a stream that is known, what never came to an order is invented.
  const bool known = std::ranges::any_of(streams_, [](const auto& s) {
    const bool samples =
        s.first.first == MessageType::kImuBatch || s.first.first == MessageType::kRawBatch;
    return samples && s.second.owned && s.second.speakers.front().proven();
  });
  for (auto& [key, stream] : streams_) {
    const bool timed = key.first == MessageType::kDepth || key.first == MessageType::kStillWindow;
    if ((known && !timed) || stream.owned || stream.speakers.empty()) continue;
    const auto best = std::ranges::max_element(
        stream.speakers, {}, [](const Speaker& s) { return std::pair(s.in_order, s.rising); });
    Own(stream, *best);
  }
}

}  // namespace wellgyro
