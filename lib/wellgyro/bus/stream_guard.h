#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/bus/lcm_live.h"
#include "wellgyro/bus/message.h"
#include "wellgyro/record/channels.h"

namespace wellgyro {

/// Gives each stream (the samples, counts or averages of one tool, the depths) to one sender, so
/// that altered copies and what others invent change nothing, though no sample is signed.
///
/// A stream is a sender's own once kInOrder of its messages continue each other by number, without
/// a hole, and by time, so that no copy whose number was altered does (or kRising by time alone).
/// They wait for that, so that what was heard before the tool is not its begin; depths of a sender
/// that is alone wait for kSilentUs at most, averages do not. From then on what others send is not
/// read. Another takes over when the own sender has been silent for kSilentUs (four of its usual
/// intervals where that is longer; five times that from another address) or has lost its order, and
/// the other continues beyond what was heard: what it sent meanwhile is used then. An own message
/// whose LCM number came before is not read again; numbers that do not continue count as another
/// sender's.
///
/// Not told apart: who sends from the tool's own address and port with fresh numbers, and who
/// speaks where the tool is silent. Time is that of the messages. Memory is bounded by kStreams,
/// kSpeakers and kHeldMax, whatever comes.
class WELLGYRO_EXPORT StreamGuard {
 public:
  /// A number drawn at random continues another with 2^-32, and four messages are there within four
  /// periods. By time alone eight times as many, since numbers that never continue say less.
  static constexpr int kInOrder = 4, kRising = 32;
  /// [us]: marks come once a second and batches oftener, so that one lost is no silence.
  static constexpr std::int64_t kSilentUs = 2'000'000;
  static constexpr std::size_t kStreams = 256, kSpeakers = 1024;  ///< the latter of each stream
  static constexpr std::size_t kHeldMax = std::size_t{8} << 20;   ///< bytes, of all that wait

  struct Message {
    std::string_view channel;
    std::span<const std::byte> bytes;
    std::int64_t received_us = 0;
    SentBy by;
  };
  using Use = std::function<void(const Message&)>;
  using Tell = std::function<void(const std::string& sentence)>;

  /// `leave` hears what is not used; `tell` of each stream the first that send it beside its own
  /// sender, and who takes it over. Both may be empty.
  StreamGuard(const Channels& channels, Use use, Tell tell = {}, Use leave = {})
      : channels_(channels),
        use_(std::move(use)),
        tell_(std::move(tell)),
        leave_(std::move(leave)) {}

  void Take(const Message& message);
  /// Hands on what still waits for its sender to be known: the end.
  void Flush();

  std::int64_t left_out() const { return left_out_; }  ///< messages not used
  std::size_t held_bytes() const { return held_bytes_; }

 private:
  struct Held {
    std::string channel;
    std::vector<std::byte> bytes;
    std::int64_t received_us = 0;
    SentBy by;
  };
  /// Where in its stream a message stands: its numbers [begin, end) and its time.
  struct Place {
    std::int64_t begin = 0, end = 0;
    std::int64_t time = 0, period = 0;  ///< of the first number, and to the next; 0: not known
    std::int32_t session = 0;
    bool operator==(const Place&) const = default;
  };
  struct Speaker {
    std::uint64_t id = 0;
    std::optional<Place> last;
    int in_order = 0, rising = 0;
    std::int64_t heard_us = 0, interval_us = 0;
    std::uint32_t number = 0;
    bool numbers = true;     ///< it counts its messages
    bool told = false;       ///< that it is not read
    std::vector<Held> held;  ///< since its order was broken last

    bool proven() const { return in_order >= kInOrder || rising >= kRising; }
  };
  struct Stream {
    std::list<Speaker> speakers;  ///< the own one first, where there is one
    bool owned = false;
    std::int64_t heard_us = 0;
    std::vector<bool> came;  ///< by number, of the own sender's last ones
    int told = 0;
  };
  using Key = std::pair<MessageType, std::int32_t>;  ///< and the tool

  std::optional<Key> Find(const Message& message, Place& place) const;
  Stream& StreamOf(const Key& key, std::int64_t received_us);
  Speaker& SpeakerOf(Stream& stream, std::uint64_t id);
  static bool IsOwn(const Stream& stream, const SentBy& by);
  static bool HasCome(const Stream& stream, std::uint32_t number);
  static bool NoteNumber(Stream& stream, std::uint32_t number);
  static bool Rises(const Place& a, const Place& b);
  static bool Joins(const Place& a, const Place& b);
  Speaker* OtherOf(Stream& stream, const Place& place, const SentBy& by);
  static bool Continue(Speaker& speaker, const Place& place, bool own);
  static void Hear(Speaker& speaker, std::int64_t received_us);
  static bool IsNews(const Stream& stream, const Place& place, std::int64_t received_us);
  static bool MayTakeOver(const Stream& stream, const Speaker& speaker, std::int64_t received_us);
  static bool IsAlone(const Key& key, const Stream& stream, const Speaker& speaker);
  void TakeOwn(Stream& stream, const Place& place, const Message& message);
  void TakeOther(const Key& key, Stream& stream, const Place& place, const Message& message);
  void Own(Stream& stream, const Speaker& speaker);
  /// Counts it as left out, and tells who wants to hear it.
  void Leave(const Message& message);
  void Hold(Speaker& speaker, const Message& message);
  void DropWeakest(Stream& stream);
  void DropHeld(Speaker& speaker);
  /// Its order so far, with what it held.
  void Forget(Speaker& speaker);
  bool IsForeign(const Message& message) const;
  void TellOf(const Key& key, Stream& stream, Speaker& speaker, const SentBy& by);

  Channels channels_;
  Use use_;
  Tell tell_;
  Use leave_;
  std::map<Key, Stream> streams_;
  std::size_t held_bytes_ = 0;
  std::int64_t left_out_ = 0;
};

}  // namespace wellgyro
