#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/time.h"
#include "wellgyro/record/sample.h"

namespace wellgyro {

/// Puts one tool's samples in the order of their sequence numbers and holds each back until a
/// sample at least `hold` younger has come, so that whatever belongs to its time has come too.
///
/// Overlapping and repeated samples are skipped, late ones sorted in. A sample that comes after a
/// younger one was handed out is refused. A new session flushes the old one. What comes out depends
/// only on the set of samples and never on how they were batched. Nothing is allocated per sample
/// once the buffer has grown to `hold`; of more than kWaitingMax the oldest no longer wait.
class WELLGYRO_EXPORT SampleQueue {
 public:
  static constexpr std::size_t kWaitingMax = std::size_t{1} << 21;  ///< 20 s at 100 kHz

  struct Counts {
    std::int64_t accepted = 0;
    std::int64_t duplicates = 0;
    std::int64_t late = 0;     ///< came after a younger sample had been used
    std::int64_t refused = 0;  ///< impossible values, or time against number
  };

  explicit SampleQueue(Duration hold) : hold_(hold) {}

  /// Takes `sample` unless it is known, late or makes no sense; the return and the counts say
  /// which.
  enum class Verdict { kTaken, kDuplicate, kLate, kRefused };
  Verdict Push(const ImuSample& sample);

  /// The next sample in order, or nullptr while it has to wait. Valid until the next Push.
  const ImuSample* Front() const {
    if (size_ == 0) return nullptr;
    const ImuSample& front = At(0);
    const bool old = At(size_ - 1).stamp.tool_time - front.stamp.tool_time >= hold_;
    return old || flushing_ || old_session_ > 0 || size_ > kWaitingMax ? &front : nullptr;
  }
  void Pop() {
    const SampleStamp& stamp = At(0).stamp;
    const bool next = stamp.seq == last_.seq + 1 && stamp.session == last_.session;
    if (popped_ && !next) NoteGap(stamp);
    last_ = stamp;
    popped_ = true;
    head_ = (head_ + 1) & mask_;
    --size_;
    if (old_session_ > 0) --old_session_;
  }

  /// From now on nothing waits: the end of the stream.
  void Flush() { flushing_ = true; }

  const Counts& counts() const { return counts_; }
  /// Latest begin of any sample taken.
  UtcTime newest() const { return newest_; }
  std::size_t waiting() const { return size_; }

 private:
  ImuSample& At(std::size_t i) { return ring_[(head_ + i) & mask_]; }
  const ImuSample& At(std::size_t i) const { return ring_[(head_ + i) & mask_]; }
  Verdict Sort(const ImuSample& sample);
  void Take(std::size_t position, const ImuSample& sample);
  void Grow();
  void NoteGap(const SampleStamp& next);
  bool IsNext(const SampleStamp& stamp) const;
  bool Contradicts(const ImuSample& sample) const;
  bool InGap(std::int64_t seq) const;

  Duration hold_;
  std::vector<ImuSample> ring_;  ///< its size is a power of two
  std::size_t mask_ = 0;         ///< one less
  std::size_t head_ = 0;
  std::size_t size_ = 0;
  std::size_t old_session_ = 0;  ///< waiting samples, from the front, of sessions that have ended
  bool flushing_ = false;
  bool popped_ = false;
  UtcTime newest_;
  SampleStamp last_;  ///< of the sample handed out last
  /// Numbers that were missing when younger samples were handed out: [first, second), the latest
  /// kGapsKept of this session.
  static constexpr std::size_t kGapsKept = 256;
  std::vector<std::pair<std::int64_t, std::int64_t>> gaps_;
  Counts counts_;
};

}  // namespace wellgyro
