#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/bus/feed.h"

namespace wellgyro {

/// Watches the sequence numbers of samples, SI and counts, tool by tool: which are missing, by
/// range, and whether two senders speak at once. What comes out of order fills its gap; a gap is
/// told of once sixteen batches more have come, or at Settle.
class WELLGYRO_EXPORT LossWatch : public Listener {
 public:
  using Tell = std::function<void(const Fault&)>;
  static constexpr std::size_t kStreamsMax = 4096;  ///< of tool and session; further ones unseen
  static constexpr std::size_t kGapsMax = 1000;  ///< open ones of a stream, 16 kB; then told early

  explicit LossWatch(Tell tell) : tell_(std::move(tell)) {}

  void OnImu(std::span<const ImuSample> batch) override;
  void OnRaw(std::span<const RawSample> batch) override;
  /// The end: tells of the gaps still open.
  void Settle();

  std::int64_t samples() const { return samples_; }
  std::int64_t lost() const { return lost_; }  ///< in gaps told of
  std::int64_t duplicates() const { return duplicates_; }

 private:
  struct Gap {
    std::int64_t begin, end;
  };
  struct Stream {
    std::int64_t next = 0;
    std::vector<Gap> gaps;
  };
  /// The sessions of one tool as they followed one another.
  struct Senders {
    std::deque<std::int32_t> sessions;  ///< the last few, the present one last
    int returns = 0;                    ///< of a session that another had followed
  };
  using Key = std::tuple<bool, std::int32_t, std::int32_t>;  ///< counts, tool, session

  void Take(bool counts, const SampleStamp& first, std::size_t size);
  void WatchSender(bool counts, const SampleStamp& stamp);
  std::int64_t Fill(Stream& stream, std::int64_t begin, std::int64_t end);
  void TellOf(const Key& key, const Gap& gap);

  Tell tell_;
  std::map<Key, Stream> streams_;
  std::map<std::pair<bool, std::int32_t>, Senders> senders_;
  std::int64_t samples_ = 0, lost_ = 0, duplicates_ = 0;
};

}  // namespace wellgyro
