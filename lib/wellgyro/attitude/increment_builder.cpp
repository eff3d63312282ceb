#include "wellgyro/attitude/increment_builder.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "wellgyro/attitude/knot_sum_internal.h"
#include "wellgyro/attitude/phase_reader_internal.h"

namespace wellgyro {
namespace {

using increment::Block;
using increment::Blocks;
using increment::BlockSum;
using increment::KnotSpan;
using increment::PhaseReader;
using increment::Ring;
using increment::RollSmoother;

// A block: short against a roll of 20 rpm (0.02 rad to its ends) and against whirls of some Hz.
constexpr double kBlockSeconds = 0.02;
// A stretch whose roll is smoothed at once, and what is looked at beyond it: three times the memory
// (R / q^2)^(1/4) = 2 s of the slowest walk q = 1e-3 rad/s/sqrt(s) in phases of white noise R^(1/2)
// = 4e-3 rad sqrt(s), which 35 ug/sqrt(Hz) make of gravity 0.5 deg from vertical. Blocks are longer
// than 10 ms but beside gaps: 600 in it, 2000 in a knot of 20 s.
constexpr std::int64_t kStretchNs = 6'000'000'000;
constexpr std::uint64_t kStretchBlocks = 800;
// A knot that nobody ends, so that memory stays bounded: the stretch at hand, the one beyond it and
// such a knot are half of what there is room for.
constexpr std::int64_t kKnotNs = 20'000'000'000;
constexpr std::uint64_t kKnotBlocks = 2000;
constexpr std::size_t kCapacity = 8192;
constexpr std::size_t kCutsMost = 1024;  // 12 s of knots and stations wait: 85 a second
// A clock that leaps by more is wrong, and sums of leaps must not overflow: a month.
constexpr std::int64_t kGapMostNs = 30 * 86400 * std::int64_t{1'000'000'000};

bool IsFinite(const ImuSample& s) {
  const double w = s.w_IT_T.x() + s.w_IT_T.y() + (s.has_gz ? s.w_IT_T.z() : 0);
  return std::isfinite(w + s.f_T.x() + s.f_T.y() + s.f_T.z());
}

void CheckNotNegative(const char* name, double value) {
  if (value >= 0 && std::isfinite(value)) return;
  throw std::invalid_argument(std::string("IncrementOptions.") + name +
                              " must not be negative, is " + std::to_string(value));
}

// How a sample follows the one before it.
struct Following {
  bool late = false, breaks = false;
  std::int64_t gap_ns = 0, lost = 0;
};
Following Follows(const SampleStamp& before, const SampleStamp& next) {
  Following f;
  if (next.session != before.session || next.tool != before.tool) {
    f.breaks = true;
    f.gap_ns =
        std::clamp<std::int64_t>((next.utc - before.utc).ns - before.period_ns, 0, kGapMostNs);
    return f;
  }
  const std::int64_t apart = (next.tool_time - before.tool_time).ns - before.period_ns;
  const std::int64_t tolerance = before.period_ns / 2;
  f.late = apart < -tolerance || next.seq <= before.seq;
  f.gap_ns = apart > tolerance ? std::min(apart, kGapMostNs) : 0;
  f.lost = next.seq - before.seq - 1;
  f.breaks = f.gap_ns > 0 || f.lost > 0 || next.period_ns != before.period_ns;
  return f;
}

}  // namespace

struct IncrementBuilder::State {
  explicit State(const IncrementOptions& o)
      : options(o), phase({o.accel_noise, o.accel_bias, o.gravity}) {}

  struct KnotEnd {
    std::int64_t ns;
    ToolTime time;
  };

  IncrementOptions options;
  BlockSum open;
  std::int64_t open_begin_ns = 0;
  int block_samples = 1;
  bool started = false, breaks = true, anew = false;
  std::int64_t lost = 0, last_begin_ns = 0;
  std::int64_t gap_begin_ns = 0, gap_ns = 0;  // before the last sample
  ToolTime gap_begin;
  Blocks blocks{kCapacity};
  PhaseReader phase;
  RollSmoother smoother{kCapacity};
  std::uint64_t smoothed = 0, turned = 0;  // blocks that are
  std::uint64_t stretch_end = 0;           // of the next stretch, as far as it is known
  std::int64_t final_ns = 0;               // up to here knots can be summed
  Ring<KnotEnd> cuts{kCutsMost};
  std::int64_t last_cut_ns = 0, begin_ns = 0;
  std::uint64_t begin_block = 0, last_cut_block = 0;

  Block& NewBlock();
  void CloseBlock();
  void CloseFull();
  void Join(const SampleStamp& stamp);
  void AddGap(std::int64_t ns);
  void Advance(bool to_end);
  double BendOf(std::uint64_t k) const;
  void Turn(std::uint64_t begin, std::uint64_t end);
  void EndLongKnot();
  void AddCut(std::int64_t ns, ToolTime time);
};

Block& IncrementBuilder::State::NewBlock() {
  if (blocks.full()) throw std::logic_error("IncrementBuilder: increments wait to be fetched");
  Block& block = blocks.Append();
  block.begin_ns = open_begin_ns;
  block.breaks = breaks;
  block.anew = anew;
  block.lost = lost;
  breaks = anew = false;
  lost = 0;
  return block;
}

void IncrementBuilder::State::CloseBlock() {
  if (open.samples() == 0) return;
  Block& block = NewBlock();
  open.Close(block);
  open_begin_ns = block.end_ns();
  phase.Read(blocks);
}

inline void IncrementBuilder::State::CloseFull() {
  if (open.samples() < block_samples) return;
  CloseBlock();
  Advance(false);
}

// Before a sample that can follow, but perhaps behind a gap or with another period.
void IncrementBuilder::State::Join(const SampleStamp& stamp) {
  Following f;
  if (started) f = Follows(open.last(), stamp);
  EndLongKnot();
  if (started && !f.breaks) {
    CloseFull();
    return;
  }
  const SampleStamp& last = open.last();
  gap_begin = started ? last.tool_time + Duration{last.period_ns} : stamp.tool_time;
  CloseBlock();
  gap_begin_ns = open_begin_ns;
  gap_ns = f.gap_ns;
  if (f.gap_ns > 0) AddGap(f.gap_ns);
  lost += f.lost;
  breaks = true;
  block_samples = std::max(1, static_cast<int>(kBlockSeconds / (1e-9 * stamp.period_ns) + 1e-6));
  Advance(false);
}

void IncrementBuilder::State::AddGap(std::int64_t ns) {
  Block& gap = NewBlock();
  const bool first = gap.anew;
  gap = Block();
  gap.anew = first;
  gap.begin_ns = open_begin_ns;
  gap.length_ns = ns;
  gap.seconds = 1e-9 * static_cast<double>(ns);
  gap.breaks = true;
  open_begin_ns += ns;
  phase.Read(blocks);
}

// psi'' of a block from the rates of its neighbours: of those that adjoin to the fourth order.
double IncrementBuilder::State::BendOf(std::uint64_t k) const {
  const std::uint64_t a = k > blocks.begin() ? k - 1 : k, c = k + 1 < smoothed ? k + 1 : k;
  const double inner = blocks[c].rate - blocks[a].rate;
  const double apart = 1e-9 * static_cast<double>(blocks[c].begin_ns - blocks[a].begin_ns) +
                       blocks[c].middle() - blocks[a].middle();
  if (a == c) return 0;
  if (k < blocks.begin() + 2 || k + 2 >= smoothed) return inner / apart;
  for (std::uint64_t j = k - 2; j < k + 2; ++j) {
    if (!increment::Adjoin(blocks[j], blocks[j + 1])) return inner / apart;
  }
  const double outer = blocks[k + 2].rate - blocks[k - 2].rate;
  // Rates by a third gyro are means, smoothed ones are of the middle.
  const double by = blocks[k].has_gz ? (34 * inner - 5 * outer) / 48 : (8 * inner - outer) / 12;
  return by / blocks[k].seconds;
}

// Means of the phase to its values at the middles, and the sums to U.
void IncrementBuilder::State::Turn(std::uint64_t begin, std::uint64_t end) {
  for (std::uint64_t k = begin; k < end; ++k) {
    Block& b = blocks[k];
    b.bend = BendOf(k);
    if (b.weight > 0) b.roll -= b.bend * b.seconds * b.seconds / (b.has_gz ? 8 : 24);
    if (b.samples > 0) increment::TurnBlock(options.order == IncrementOptions::kThird, b);
    b.carried = k > blocks.begin() ? blocks[k - 1].carried : 0;
    if (b.samples > 0) {
      b.carried += (b.turn() / b.seconds - b.carried) * std::min(1., b.seconds);
    }
  }
}

void IncrementBuilder::State::Advance(bool to_end) {
  while (smoothed < blocks.end()) {
    const std::int64_t begin = blocks[smoothed].begin_ns;
    while (stretch_end < blocks.end() && stretch_end - smoothed < kStretchBlocks &&
           blocks[stretch_end].begin_ns - begin < kStretchNs) {
      ++stretch_end;
    }
    const bool far = blocks.end() - stretch_end >= kStretchBlocks ||
                     (blocks.end() >= stretch_end + 3 &&
                      blocks[blocks.end() - 3].begin_ns - begin >= 2 * kStretchNs);
    if (!far && !to_end) break;
    // The phases of the two youngest are not final.
    smoother.Smooth(smoothed, stretch_end, to_end ? blocks.end() : blocks.end() - 2, blocks);
    smoothed = stretch_end;
    const std::uint64_t upto = to_end && smoothed == blocks.end()
                                   ? smoothed
                                   : std::max(turned, std::max<std::uint64_t>(smoothed, 2) - 2);
    Turn(turned, upto);
    turned = upto;
    // The slopes across a block look at two beyond it.
    if (turned == blocks.end()) {
      final_ns = blocks.back().end_ns();
    } else if (turned > blocks.begin() + 2) {
      final_ns = std::max(final_ns, blocks[turned - 3].end_ns());
    }
  }
}

inline void IncrementBuilder::State::EndLongKnot() {
  if (!started) return;
  if (last_begin_ns - last_cut_ns >= kKnotNs || blocks.end() - last_cut_block >= kKnotBlocks) {
    AddCut(last_begin_ns, open.last().tool_time);
  }
}

void IncrementBuilder::State::AddCut(std::int64_t ns, ToolTime time) {
  if (cuts.full()) throw std::logic_error("IncrementBuilder: increments wait to be fetched");
  cuts.Push({ns, time});
  last_cut_ns = ns;
  last_cut_block = blocks.end();
}

IncrementBuilder::IncrementBuilder(const IncrementOptions& options) {
  CheckNotNegative("accel_noise", options.accel_noise);
  CheckNotNegative("angle_random_walk", options.angle_random_walk);
  CheckNotNegative("accel_bias", options.accel_bias);
  state_ = std::make_unique<State>(options);
}
IncrementBuilder::~IncrementBuilder() = default;
IncrementBuilder::IncrementBuilder(IncrementBuilder&&) noexcept = default;
IncrementBuilder& IncrementBuilder::operator=(IncrementBuilder&&) noexcept = default;
IncrementBuilder::IncrementBuilder(const IncrementBuilder& other)
    : state_(std::make_unique<State>(other.state_->options)) {
  *this = other;
}
IncrementBuilder& IncrementBuilder::operator=(const IncrementBuilder& other) {
  *state_ = *other.state_;
  return *this;
}

bool CanFollow(const SampleStamp* before, const ImuSample& sample) {
  if (sample.stamp.period_ns <= 0 || !IsFinite(sample)) return false;
  return before == nullptr || !Follows(*before, sample.stamp).late;
}

bool IncrementBuilder::Push(const ImuSample& sample, bool rests) {
  State& s = *state_;
  if (s.started && IsNext(s.open.last(), sample.stamp)) {
    // Nearly every sample of a fast stream: the next, and no more is to be asked.
    if (!IsFinite(sample)) return false;
    s.EndLongKnot();
    s.CloseFull();
  } else {
    if (!CanFollow(s.started ? &s.open.last() : nullptr, sample)) return false;
    s.Join(sample.stamp);
  }
  s.last_begin_ns = s.open_begin_ns + s.open.samples() * std::int64_t{sample.stamp.period_ns};
  s.open.Add(sample, rests);
  s.started = true;
  return true;
}

std::size_t IncrementBuilder::Room(const SampleStamp& next) const {
  const State& s = *state_;
  if (!s.started || s.open.samples() == 0 || s.open.samples() >= s.block_samples) return 0;
  const Following f = Follows(s.open.last(), next);
  if (f.late || f.breaks) return 0;
  const std::int64_t left = kKnotNs - 1 - (s.last_begin_ns - s.last_cut_ns);
  if (left < 0 || s.blocks.end() - s.last_cut_block >= kKnotBlocks) return 0;
  return static_cast<std::size_t>(
      std::min<std::int64_t>(s.block_samples - s.open.samples(), left / next.period_ns + 1));
}

void IncrementBuilder::Append(const SampleBlock& samples, bool rest) {
  State& s = *state_;
  s.open.Add(samples, rest);
  s.last_begin_ns =
      s.open_begin_ns + (s.open.samples() - 1) * std::int64_t{samples.last().period_ns};
}

void IncrementBuilder::Cut(double fraction) {
  State& s = *state_;
  if (!(fraction > 0 && fraction <= 1) || !s.started) {
    throw std::invalid_argument("IncrementBuilder::Cut: no part " + std::to_string(fraction) +
                                " of a sample");
  }
  const Duration into{std::llround(fraction * s.open.last().period_ns)};
  const std::int64_t ns = s.last_begin_ns + into.ns;
  if (ns <= s.last_cut_ns) throw std::invalid_argument("IncrementBuilder::Cut: before another");
  s.AddCut(ns, s.open.last().tool_time + into);
}

void IncrementBuilder::CutGap(Duration into) {
  State& s = *state_;
  const std::int64_t ns = s.gap_begin_ns + into.ns;
  if (s.gap_ns == 0 || into.ns < 0 || into.ns > s.gap_ns || ns <= s.last_cut_ns) {
    throw std::invalid_argument("IncrementBuilder::CutGap: no gap that is cut by " +
                                std::to_string(into.seconds()) + " s");
  }
  s.AddCut(ns, s.gap_begin + into);
}

void IncrementBuilder::Flush() {
  State& s = *state_;
  s.CloseBlock();
  s.breaks = s.anew = true;
  s.Advance(true);
}

bool IncrementBuilder::Ready() const {
  return !state_->cuts.empty() && state_->cuts.front().ns <= state_->final_ns;
}

Increment IncrementBuilder::Pop() {
  State& s = *state_;
  if (!Ready()) throw std::logic_error("IncrementBuilder::Pop: none is ready");
  const State::KnotEnd cut = s.cuts.front();
  s.cuts.DropBefore(s.cuts.begin() + 1);
  std::uint64_t end = s.begin_block;
  while (s.blocks[end].end_ns() < cut.ns) ++end;
  const KnotSpan span{s.begin_ns, cut.ns, s.begin_block, end};
  Increment out = increment::SumKnot(span, s.options.order == IncrementOptions::kThird,
                                     s.options.accel_noise, s.blocks);
  out.time = cut.time;
  s.begin_ns = cut.ns;
  s.begin_block = end + (s.blocks[end].end_ns() == cut.ns ? 1 : 0);
  s.blocks.DropBefore(std::max<std::uint64_t>(s.begin_block, 3) - 3);
  return out;
}

}  // namespace wellgyro
