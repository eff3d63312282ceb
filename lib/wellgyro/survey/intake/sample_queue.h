#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/time.h"
#include "wellgyro/record/sample_block.h"

namespace wellgyro {

/// Puts one tool's samples in the order of their sequence numbers and holds each back until a
/// sample at least `hold` younger has come, so that whatever belongs to its time has come too.
///
/// Overlapping and repeated samples are skipped, late ones sorted in. A sample that comes after a
/// younger one was handed out is refused. What comes out depends only on the set of samples and
/// never on how they were batched. Nothing is allocated per sample once the buffer has grown to
/// `hold`; of more than kWaitingMax the oldest no longer wait.
///
/// Samples of another session, or whose number, tool clock and UTC contradict those before, are put
/// aside. When such that agree with each other fill kAgree in which none of the others comes, the
/// session is new or the clock has jumped: they follow the others, which no longer wait, and none
/// is lost. When the others go on for kAgree instead, they are strays.
///
/// A sample that comes again is compared with the first: with each that waits still, with one in
/// kKeptEvery of those handed out, the last kKept of them. It is other where it differs by more
/// than a calibration at another temperature would make it; so are those behind it that come again,
/// until one compares as the same.
class WELLGYRO_EXPORT SampleQueue {
 public:
  static constexpr std::size_t kWaitingMax = std::size_t{1} << 21;  ///< 20 s at 100 kHz
  /// Longer than a network holds datagrams up; so long stations wait behind a new session.
  static constexpr Duration kAgree{10'000'000'000};
  static constexpr std::size_t kAgreeMax = std::size_t{1} << 15;  ///< enough too: 3.3 s at 10 kHz
  static constexpr std::int64_t kKeptEvery = 64;  ///< of a batch of a hundred one or two
  static constexpr std::size_t kKept = std::size_t{1} << 13;  ///< 7 h at 20 Hz

  struct Counts {
    std::int64_t accepted = 0;
    std::int64_t duplicates = 0;
    std::int64_t late = 0;     ///< came after a younger sample had been used
    std::int64_t refused = 0;  ///< impossible values
    std::int64_t strays = 0;   ///< whose times contradict all others'
    std::int64_t others = 0;   ///< of a number and time that came with another content before
  };

  explicit SampleQueue(Duration hold) : hold_(hold) {}

  /// Takes `sample` unless it is known, late or makes no sense; the return and the counts say
  /// which. kAside: what follows will tell.
  enum class Verdict { kTaken, kDuplicate, kLate, kRefused, kAside, kOther };
  Verdict Push(const ImuSample& sample);
  /// Takes from the begin of `batch` what comes right behind the newest sample, and says how many:
  /// as Push of each would, at less cost.
  std::size_t Append(std::span<const ImuSample> batch);

  /// The next samples in order, those that wait no longer; not all where they lie in two pieces or
  /// the clock jumps among them. Valid until the next Push.
  std::span<const ImuSample> Ready() const;
  /// Whatever is at the front does not wait.
  bool hurries() const { return flushing_ || old_session_ > 0 || size_ > kWaitingMax; }
  /// By how much the newest sample is younger than one that waits.
  Duration Age(const SampleStamp& stamp) const { return back_->tool_time - stamp.tool_time; }
  /// Within its session the clock jumps before the sample at the front.
  bool Jumps() const { return !jumps_.empty() && jumps_.front() == counts_.accepted - Waiting(); }
  /// Takes the first of Ready() away, or so many that follow each other by number. They stay where
  /// they are until they are let go.
  void Pop(std::size_t count = 1);
  /// Those taken away and not yet let go, in order; not all where they lie in two pieces. Valid
  /// until the next Push.
  std::span<ImuSample> Held();
  /// Lets the first of Held() go.
  void Release(std::size_t count) { held_ -= count; }

  /// From now on nothing waits: the end of the stream.
  void Flush() {
    flushing_ = true;
    Drop(stories_.size());
  }

  const Counts& counts() const { return counts_; }
  /// Latest begin of any sample taken.
  UtcTime newest() const { return newest_; }
  std::size_t waiting() const { return size_; }

 private:
  ImuSample& At(std::size_t i) { return ring_[(head_ + i) & mask_]; }
  const ImuSample& At(std::size_t i) const { return ring_[(head_ + i) & mask_]; }
  /// Samples put aside that agree with each other, by number.
  struct Story {
    std::vector<ImuSample> samples;
    ToolTime begun;         ///< of the newest of the others when it began
    ToolTime heard;         ///< and when its newest came
    std::size_t alone = 1;  ///< samples since then
  };

  /// Of a sample in the order of all.
  struct Place {
    std::int64_t seq = 0;
    std::int32_t session = 0;
  };

  /// Of a sample handed out, what tells it from another.
  struct Content {
    std::int64_t seq = -1;  ///< kept are others
    ToolTime time;
    std::int32_t session = 0;
    Eigen::Vector3f w_IT_T = Eigen::Vector3f::Zero();  ///< [rad/s]
    Eigen::Vector3f f_T = Eigen::Vector3f::Zero();     ///< [m/s^2]
  };

  static Content ContentOf(const ImuSample& sample);
  void Keep(const ImuSample& sample);
  Verdict Again(const ImuSample& sample, const Content* first);

  std::size_t room() const { return ring_.size() - held_ - size_; }
  std::int64_t Waiting() const { return static_cast<std::int64_t>(size_); }
  Verdict Sort(const ImuSample& sample);
  Verdict PutAside(const ImuSample& sample);
  Verdict Join(Story& story, const ImuSample& sample);
  void Begin();
  void Believe(Story story);
  void Drop(std::size_t stories);
  void DropOld();
  void Take(std::size_t position, const ImuSample& sample);
  void Grow();
  void NoteGap(const SampleStamp& next, bool jumps);
  bool InGap(std::int64_t seq) const;

  Duration hold_;
  std::vector<ImuSample> ring_;  ///< its size is a power of two
  std::size_t mask_ = 0;         ///< one less
  std::size_t head_ = 0;
  std::size_t size_ = 0;
  std::size_t held_ = 0;         ///< samples before the head
  std::size_t old_session_ = 0;  ///< waiting samples, from the front, of sessions that have ended
  bool last_is_old_ = false;     ///< the sample handed out last is of such a one
  bool flushing_ = false;
  UtcTime newest_;
  std::optional<SampleStamp> back_;  ///< the newest of the story that is believed
  std::optional<Place> last_;        ///< of the sample handed out last
  /// Numbers that were missing when younger samples were handed out: [first, second), the latest
  /// kGapsKept of this session.
  /// A sample of one forgotten counts as a duplicate in place of late.
  static constexpr std::size_t kGapsKept = 256;
  std::vector<std::pair<std::int64_t, std::int64_t>> gaps_;
  /// A tool that starts again twice while a stray comes leaves one to spare; of more the oldest
  /// goes, its samples as strays.
  static constexpr std::size_t kStoriesMax = 4;
  std::vector<Content> kept_;        ///< by number
  bool other_ = false;               ///< what was compared last, and what follows it
  std::vector<Story> stories_;       ///< put aside, the oldest first
  std::vector<std::int64_t> jumps_;  ///< samples taken before each, not yet handed out
  Counts counts_;
};

}  // namespace wellgyro
