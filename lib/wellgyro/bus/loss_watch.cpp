#include "wellgyro/bus/loss_watch.h"

#include <algorithm>

#include <fmt/format.h>

namespace wellgyro {
namespace {

// Batches behind a gap after which nothing fills it any more: a network changes the order of a few.
constexpr std::int64_t kSettleBatches = 16;
// Sessions of a tool that one may come back from, and then there are two senders.
constexpr std::size_t kSessionsKept = 4;
// A session that comes back once may be one message delayed over a restart; thrice it is a sender.
constexpr int kReturnsOfTwoSenders = 3;

}  // namespace

void LossWatch::OnImu(std::span<const ImuSample> batch) {
  if (!batch.empty()) Take(false, batch.front().stamp, batch.size());
}

void LossWatch::OnRaw(std::span<const RawSample> batch) {
  if (!batch.empty()) Take(true, batch.front().stamp, batch.size());
}

void LossWatch::WatchSender(bool counts, const SampleStamp& stamp) {
  if (senders_.size() >= kStreamsMax && !senders_.contains({counts, stamp.tool})) return;
  Senders& senders = senders_[{counts, stamp.tool}];
  std::deque<std::int32_t>& sessions = senders.sessions;
  if (!sessions.empty() && sessions.back() == stamp.session) return;
  const auto before = std::find(sessions.begin(), sessions.end(), stamp.session);
  if (before != sessions.end()) {
    if (++senders.returns == kReturnsOfTwoSenders) {
      tell_({FaultCode::kConflict,
             fmt::format("two senders speak for tool {} at once: sessions {} and {} alternate; "
                         "stop one, or give it a channel of its own",
                         stamp.tool, sessions.back(), stamp.session)});
    }
    sessions.erase(before);
  }
  sessions.push_back(stamp.session);
  if (sessions.size() > kSessionsKept) sessions.pop_front();
}

void LossWatch::Take(bool counts, const SampleStamp& first, std::size_t size) {
  WatchSender(counts, first);
  const Key key{counts, first.tool, first.session};
  auto found = streams_.find(key);
  if (found == streams_.end()) {
    if (streams_.size() >= kStreamsMax) return;
    found = streams_.try_emplace(key, Stream{first.seq, {}}).first;
  }
  Stream& stream = found->second;
  const auto n = static_cast<std::int64_t>(size);
  const std::int64_t begin = first.seq, end = first.seq + n;
  std::int64_t fresh = Fill(stream, begin, end);
  if (begin > stream.next) stream.gaps.push_back({stream.next, begin});
  fresh += std::max<std::int64_t>(end - std::max(begin, stream.next), 0);
  stream.next = std::max(stream.next, end);
  samples_ += fresh;
  duplicates_ += n - fresh;
  std::size_t settled = 0;
  while (settled < stream.gaps.size() &&
         (stream.next - stream.gaps[settled].end > kSettleBatches * n ||
          stream.gaps.size() - settled > kGapsMax)) {
    TellOf(key, stream.gaps[settled++]);
  }
  stream.gaps.erase(stream.gaps.begin(),
                    stream.gaps.begin() + static_cast<std::ptrdiff_t>(settled));
}

/// Takes [begin, end) out of the gaps; how many samples that were missing it brings.
std::int64_t LossWatch::Fill(Stream& stream, std::int64_t begin, std::int64_t end) {
  std::int64_t filled = 0;
  std::vector<Gap>& gaps = stream.gaps;
  for (std::size_t i = 0; i < gaps.size();) {
    const Gap gap = gaps[i];
    const std::int64_t from = std::max(gap.begin, begin), to = std::min(gap.end, end);
    if (from >= to) {
      ++i;
      continue;
    }
    filled += to - from;
    gaps.erase(gaps.begin() + static_cast<std::ptrdiff_t>(i));
    for (const Gap& rest : {Gap{gap.begin, from}, Gap{to, gap.end}}) {
      if (rest.begin >= rest.end) continue;
      gaps.insert(gaps.begin() + static_cast<std::ptrdiff_t>(i++), rest);
    }
  }
  return filled;
}

void LossWatch::TellOf(const Key& key, const Gap& gap) {
  lost_ += gap.end - gap.begin;
  const auto& [counts, tool, session] = key;
  tell_({FaultCode::kLost, fmt::format("samples {} to {} of tool {}, session {}, did not come",
                                       gap.begin, gap.end - 1, tool, session)});
}

void LossWatch::Settle() {
  for (auto& [key, stream] : streams_) {
    for (const Gap& gap : std::exchange(stream.gaps, {})) TellOf(key, gap);
  }
}

}  // namespace wellgyro
