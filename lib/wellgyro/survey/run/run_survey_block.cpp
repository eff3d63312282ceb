// Samples by the block, where none of them is more than one to be summed.
#include <algorithm>

#include "wellgyro/survey/intake/sample_counts.h"
#include "wellgyro/survey/run/run_survey.h"

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
  if (!depth_.now()) return 0;
  const SampleStamp& first = block.samples.samples[at].stamp;
  std::size_t count = std::min({end - at, cutter_.Room(block, at), stops_.Room(first)});
  if (count > 0) count = PlainByPlace(block, at, at + count);
  if (count == 0) return 0;
  const std::optional<double> furthest = depth_.FurthestWithin(Part(block.begin.md, at, count));
  return furthest && cutter_.IsPlain(block.utc[at + count - 1], *furthest) ? count : 0;
}

/// Of samples [at, end), how many from the begin on have a depth, are no place where the tool comes
/// to rest, and are at the last stop where its fix still waits for the tool to leave.
std::size_t RunSurvey::PlainByPlace(const LocatedBlock& block, std::size_t at,
                                    std::size_t end) const {
  const StationMarks& marks = cutter_.marks();
  for (std::size_t i = at; i < end; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const double md = block.begin.md[k];
    const bool known = block.begin.known[k] && block.middle.known[k];
    const bool moves = StationMarks::Moves(block.begin.speed[k], block.begin.sigma_speed[k]);
    const bool there = stops_.Stays(block.samples.samples[i].stamp.tool_time, md);
    if (!known || !(moves || marks.IsMarked(md)) || !there) return i - at;
  }
  return end - at;
}

void RunSurvey::TakePlain(const LocatedBlock& block, std::size_t at, std::size_t count) {
  const SampleBlock samples = block.samples.Part(at, count);
  CountSamples(samples.first(), static_cast<std::int64_t>(count), summary_);
  cutter_.Heed(samples.first());
  cutter_.Sum();
  StepReady(false);
  stops_.Append(samples, block.middle, at);
  const std::span<const UtcTime> utc(block.utc.data() + at, count);
  cutter_.Append(block, at, count, depth_.Push(utc, Part(block.begin.md, at, count)));
}

}  // namespace wellgyro
