// Samples by the block, where none of them is more than one to be summed.
#include <algorithm>
#include <cmath>

#include "wellgyro/survey/choose.h"
#include "wellgyro/survey/run_survey.h"
#include "wellgyro/survey/run_survey_internal.h"

namespace wellgyro {
namespace {

std::span<const double> Part(const AlongHoleBlock::Values& values, std::size_t at,
                             std::size_t count) {
  return {values.data() + at, count};
}

}  // namespace

std::size_t RunSurvey::Push(const LocatedBlock& block, std::size_t at, std::size_t end) {
  while (at < end && !has_news()) {
    if (const std::size_t count = Plain(block, at, end); count > 0) {
      TakePlain(block, at, count);
      at += count;
    } else {
      Push(block.samples.samples[at], block.utc[at], block.begin.At(at), block.middle.At(at));
      ++at;
    }
  }
  return at;
}

/// How many samples from `at` on follow the current one and neither make nor end a knot, a pass or
/// a stop, nor close any sum: nothing but counts and sums is to be done for them.
std::size_t RunSurvey::Plain(const LocatedBlock& block, std::size_t at, std::size_t end) {
  const SampleStamp& first = block.samples.samples[at].stamp;
  if (!current_ || asked_ || !gap_cuts_.empty() || !depth_seen_ || seconds_unknown_ > 0) return 0;
  const Current& c = *current_;
  if (!c.along.known || c.pass.begins || c.begin + Duration{c.period_ns} != first.tool_time)
    return 0;
  // The samples given to the builder are those from the current to the last but one.
  const std::int64_t second = (c.begin.ns / kKnotNs + 1) * kKnotNs;
  const std::int64_t before = (second - c.begin.ns - 1) / c.period_ns;
  std::size_t count = std::min({end - at, static_cast<std::size_t>(before),
                                builder_.Room(c.sample.stamp), still_.Room(first)});
  if (count > 0) count = PlainByPlace(block, at, at + count);
  if (count == 0) return 0;
  const std::optional<UtcTime>& at_utc = job_.alignment.at_utc;
  if (at_utc && *at_utc >= c.utc && *at_utc < block.utc[at + count - 1]) return 0;
  const std::optional<double> furthest = passes_.FurthestWithin(Part(block.begin.md, at, count));
  if (!furthest) return 0;
  if (c.pass.pass != Pass::kStationary && *furthest != c.pass.md) {
    plan_.Between(c.pass.md, *furthest, false, targets_);
    if (!targets_.empty()) return 0;
  }
  return count;
}

/// Of samples [at, end), how many from the begin on have a depth, are no place where the tool comes
/// to rest, and are at the last stop where its fix still waits for the tool to leave.
std::size_t RunSurvey::PlainByPlace(const LocatedBlock& block, std::size_t at,
                                    std::size_t end) const {
  for (std::size_t i = at; i < end; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const double md = block.begin.md[k];
    const bool known = block.begin.known[k] && block.middle.known[k];
    const bool moves =
        std::abs(block.begin.speed[k]) > std::max(kRestSpeed, 2 * block.begin.sigma_speed[k]);
    const bool marked = marked_ && std::abs(md - last_mark_md_) <= kSameDepth;
    const bool there = group_.empty() || SamePlace(block.samples.samples[i].stamp.tool_time, md);
    if (!known || !(moves || marked) || !there) return i - at;
  }
  return end - at;
}

void RunSurvey::TakePlain(const LocatedBlock& block, std::size_t at, std::size_t count) {
  const SampleBlock samples = block.samples.Part(at, count);
  const std::size_t last = at + count - 1;
  Current& c = *current_;
  Count(samples.first(), static_cast<std::int64_t>(count));
  temperature_outside_ |= samples.first().temperature_outside;
  end_unsynced_ = samples.first().utc_unsynced;
  Eigen::Vector2d from = c.sample.f_T.head<2>();
  for (const SixAxes& axes : samples.axes) {
    const Eigen::Vector2d to = axes.segment<2>(3);
    summary_.samples_aliased += TurnsFar(from, to);
    from = to;
  }
  builder_.Push(c.sample, c.rests);
  TakeIncrements();
  StepReady(false);
  const auto rests = [&block](std::size_t i) {
    return std::abs(block.middle.speed[static_cast<Eigen::Index>(i)]) < kRestSpeed;
  };
  if (count > 1) {
    bool rest = true;
    for (std::size_t i = at; i < last; ++i) rest &= rests(i);
    builder_.Append(samples.Part(0, count - 1), rest);
  }
  still_.Append(samples, block.middle, at);
  const std::span<const UtcTime> utc(block.utc.data() + at, count);
  c.pass = passes_.Push(utc, Part(block.begin.md, at, count));
  c.begin = samples.last().tool_time;
  c.rests = rests(last);
  c.sample = samples.samples.back();
  c.utc = block.utc[last];
  c.utc_end = c.utc + Duration{c.period_ns};
  c.along = block.begin.At(last);
  last_taken_ = samples.last();
  summary_.end = c.utc_end;
}

}  // namespace wellgyro
