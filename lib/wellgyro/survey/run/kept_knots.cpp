#include "wellgyro/survey/run/kept_knots.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <iterator>

#include "wellgyro/math/plane.h"

namespace wellgyro {
namespace {

using Eigen::Vector2d;

// Numbers of a knot and its attitude, each a word of 64 bits, in pairs.
constexpr std::size_t kNumbers = 109, kWords = kNumbers + kNumbers % 2;
using KnotWords = std::array<std::uint64_t, kWords>;

std::uint64_t Bits(double value) { return std::bit_cast<std::uint64_t>(value); }
std::uint64_t Bits(std::int64_t value) { return static_cast<std::uint64_t>(value); }
void Take(std::uint64_t bits, double& value) { value = std::bit_cast<double>(bits); }
void Take(std::uint64_t bits, std::int64_t& value) { value = static_cast<std::int64_t>(bits); }

/// Bits of a prediction. 0 for a NaN: its sign depends on the order in which a compiler has
/// operands.
std::uint64_t Base(double expected) { return std::isfinite(expected) ? Bits(expected) : 0; }
std::uint64_t Base(std::int64_t expected) { return Bits(expected); }

/// Zigzag code: a small difference of either sign is a small number.
std::uint64_t Folded(std::uint64_t difference) {
  return difference << 1 ^ (difference >> 63 != 0 ? ~std::uint64_t{0} : 0);
}
std::uint64_t Unfolded(std::uint64_t folded) {
  return folded >> 1 ^ ((folded & 1) != 0 ? ~std::uint64_t{0} : 0);
}

/// Codes each number of a knot as the difference of its bits from those predicted.
struct Measure {
  KnotWords words{};
  std::size_t n = 0;
  template <class Number>
  void operator()(Number& value, Number expected) {
    words[n++] = Folded(Bits(value) - Base(expected));
  }
};

/// Decodes what Measure has coded.
struct Restore {
  KnotWords words{};
  std::size_t n = 0;
  template <class Number>
  void operator()(Number& value, Number expected) {
    Take(Base(expected) + Unfolded(words[n++]), value);
  }
};

template <class Code, class Vector, class Expected>
void Each(Code& code, Vector&& vector, const Expected& expected) {
  for (Eigen::Index i = 0; i < expected.size(); ++i) code(vector(i), double{expected(i)});
}

/// The derivatives by errors: half of them are others turned by a right angle, some follow from
/// others but for rounding, or nearly (FillErrors in attitude/), and are predicted so.
template <class Code>
void GoThroughErrors(Code& code, Increment& inc, const Increment& before) {
  auto& turn = inc.turn_by_error;
  const auto& turn_before = before.turn_by_error;
  const auto expect = [&](ErrorSource source, const Vector2d& expected) {
    Each(code, turn.col(source), expected);
  };
  expect(kGyroBiasX, turn_before.col(kGyroBiasX));
  expect(kGyroBiasY, QuarterTurned(turn.col(kGyroBiasX)));
  expect(kMassUnbalance, inc.seconds * inc.force_M.head<2>());
  expect(kQuadrature, -QuarterTurned(turn.col(kMassUnbalance)));
  expect(kGyroScaleX, turn_before.col(kGyroScaleX));
  expect(kGyroScaleY, inc.turn_M - turn.col(kGyroScaleX));
  expect(kMisalignmentY, {std::cos(inc.roll_after) - std::cos(inc.roll_before),
                          std::sin(inc.roll_after) + std::sin(inc.roll_before)});
  expect(kMisalignmentX, -QuarterTurned(turn.col(kMisalignmentY)));
  expect(kToolfaceOffset, QuarterTurned(inc.turn_M));
  expect(kTimeSkew, turn_before.col(kTimeSkew));
  const auto across = [&](ErrorSource source, const Vector2d& expected) {
    auto column = inc.ForceBy(source);
    Each(code, column, Eigen::Vector3d(expected.x(), expected.y(), before.ForceBy(source).z()));
  };
  const auto along = [&](ErrorSource source, double expected) {
    auto column = inc.ForceBy(source);
    Each(code, column, Eigen::Vector3d(0, 0, expected));
  };
  const auto of = [&inc](ErrorSource source) -> Vector2d {
    return inc.ForceBy(source).template head<2>();
  };
  across(kAccelBiasX, turn.col(kGyroBiasX) / inc.seconds);
  across(kAccelBiasY, QuarterTurned(of(kAccelBiasX)));
  along(kAccelBiasZ, before.ForceBy(kAccelBiasZ).z());
  across(kAccelScaleX, before.ForceBy(kAccelScaleX).head<2>());
  across(kAccelScaleY, turn.col(kMassUnbalance) / inc.seconds - of(kAccelScaleX));
  along(kAccelScaleZ, inc.force_M.z());
  across(kAccelMisalignmentX, inc.ForceBy(kAccelScaleZ).z() * of(kAccelBiasX));
  across(kAccelMisalignmentY, QuarterTurned(of(kAccelMisalignmentX)));
  across(kAccelShear, QuarterTurned(of(kAccelScaleX) - of(kAccelScaleY)));
  along(kAccelMisalignmentZX, before.ForceBy(kAccelMisalignmentZX).z());
  along(kAccelMisalignmentZY, before.ForceBy(kAccelMisalignmentZY).z());
}

template <class Code>
void GoThrough(Code& code, Increment& inc, const Increment& before) {
  code(inc.seconds, before.seconds);
  code(inc.time.ns, (before.time + Duration::Seconds(std::clamp(inc.seconds, 0.0, 1e9))).ns);
  code(inc.roll_before, before.roll_before);
  code(inc.roll_after, before.roll_after);
  Each(code, inc.turn_M, before.turn_M);
  Each(code, inc.turn_before_M, Vector2d(0.5 * inc.turn_M));
  Each(code, inc.force_M, before.force_M);
  Each(code, inc.turn_per_roll, before.turn_per_roll);
  Each(code, inc.force_per_roll, before.force_per_roll);
  GoThroughErrors(code, inc, before);
  Each(code, inc.wobble_followed, before.wobble_followed);
  for (int i = 0; i < inc.turn_by_harmonic.cols(); ++i) {
    auto column = inc.turn_by_harmonic.col(i);
    Each(code, column, before.turn_by_harmonic.col(i));
  }
  code(inc.var_turn, before.var_turn);
  code(inc.sigma_roll, before.sigma_roll);
  code(inc.lateral, before.lateral);
  code(inc.gap_seconds, before.gap_seconds);
  code(inc.seq_begin, before.seq_end);
  code(inc.seq_end, before.seq_end);
  code(inc.samples_lost, before.samples_lost);
}

template <class Code>
void GoThrough(Code& code, AlongHole& along, const AlongHole& before, double seconds) {
  code(along.speed, before.speed);
  code(along.md, before.md + seconds * 0.5 * (before.speed + along.speed));
  code(along.acceleration, before.acceleration);
  code(along.sigma_md, before.sigma_md);
  code(along.sigma_speed, before.sigma_speed);
  code(along.sigma_acceleration, before.sigma_acceleration);
}

template <class Code>
void GoThrough(Code& code, AttitudeSample& attitude, const AttitudeSample& before, ToolTime time) {
  code(attitude.time.ns, time.ns);
  code(attitude.inclination, before.inclination);
  code(attitude.azimuth, before.azimuth);
  code(attitude.toolface, before.toolface);
  Eigen::Matrix3d& cov = attitude.cov_attitude;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j <= i; ++j) code(cov(i, j), double{before.cov_attitude(i, j)});
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = i + 1; j < 3; ++j) code(cov(i, j), double{cov(j, i)});
  }
}

// Bits from the lowest on: flags, the knot's quality, the attitude's.
constexpr int kQualityAt = 8, kAttitudeQualityAt = 32;

std::int64_t FlagsOf(const KeptKnot& kept) {
  const Increment& inc = kept.knot.increment;
  return static_cast<std::int64_t>(inc.quality) << kQualityAt |
         static_cast<std::int64_t>(kept.attitude.quality) << kAttitudeQualityAt |
         (inc.has_axial ? 1 : 0) | (inc.roll_seen ? 2 : 0) | (inc.level ? 4 : 0) |
         (kept.knot.still ? 8 : 0) | (kept.knot.along.known ? 16 : 0) |
         (kept.attitude.azimuth_known ? 32 : 0);
}
void SetFlags(std::int64_t flags, KeptKnot& kept) {
  Increment& inc = kept.knot.increment;
  inc.quality = static_cast<Quality>(flags >> kQualityAt & 0xffffff);
  kept.attitude.quality = static_cast<Quality>(flags >> kAttitudeQualityAt);
  inc.has_axial = (flags & 1) != 0;
  inc.roll_seen = (flags & 2) != 0;
  inc.level = (flags & 4) != 0;
  kept.knot.still = (flags & 8) != 0;
  kept.knot.along.known = (flags & 16) != 0;
  kept.attitude.azimuth_known = (flags & 32) != 0;
}

/// All numbers of `kept`, each with what is expected of it, from the knot before and from those
/// already gone through.
template <class Code>
void GoThrough(Code& code, KeptKnot& kept, const KeptKnot& before) {
  std::int64_t flags = FlagsOf(kept);
  code(flags, FlagsOf(before));
  SetFlags(flags, kept);
  RunKnot& knot = kept.knot;
  Increment& inc = knot.increment;
  GoThrough(code, inc, before.knot.increment);
  code(knot.utc.ns, (before.knot.utc + (inc.time - before.knot.increment.time)).ns);
  GoThrough(code, knot.along, before.knot.along, inc.seconds);
  double temperature = knot.temperature;
  code(temperature, double{before.knot.temperature});
  knot.temperature = static_cast<float>(temperature);
  code(knot.unseen, before.knot.unseen);
  code(knot.var_unseen, before.knot.var_unseen);
  GoThrough(code, kept.attitude, before.attitude, inc.time);
}

int BytesIn(std::uint64_t word) { return static_cast<int>(std::bit_width(word) + 7) / 8; }

/// How many bytes each word has, two in one, then these.
void Write(const KnotWords& words, std::vector<std::byte>& to) {
  for (std::size_t i = 0; i < kWords; i += 2) {
    to.push_back(static_cast<std::byte>(BytesIn(words[i]) << 4 | BytesIn(words[i + 1])));
  }
  for (const std::uint64_t word : words) {
    for (int k = 0; k < BytesIn(word); ++k) to.push_back(static_cast<std::byte>(word >> 8 * k));
  }
}

/// Returns where the next ones stand.
std::size_t Read(const std::vector<std::byte>& from, std::size_t at, KnotWords& words) {
  std::size_t next = at + kWords / 2;
  for (std::size_t i = 0; i < kWords; ++i) {
    const auto both = static_cast<unsigned>(from[at + i / 2]);
    const unsigned count = i % 2 == 0 ? both >> 4 : both & 15;
    words[i] = 0;
    for (unsigned k = 0; k < count; ++k) {
      words[i] |= static_cast<std::uint64_t>(from[next++]) << 8 * k;
    }
  }
  return next;
}

}  // namespace

void KeptKnots::Add(const RunKnot& knot, const AttitudeSample& attitude) {
  KeptKnot kept{knot, attitude};
  Measure measure;
  GoThrough(measure, kept, open_.empty() ? KeptKnot{} : last_);
  assert(measure.n == kNumbers);
  Write(measure.words, open_);
  last_ = kept;
  ++size_;
  if (size_ % kBlock != 0) return;
  blocks_.push_back({{open_.begin(), open_.end()}, knot.increment.time});
  open_.clear();
}

KeptKnots::Reader::Reader(const KeptKnots& kept, std::size_t from)
    : kept_(kept), block_(from / kBlock) {
  for (std::size_t i = 0; i < from % kBlock; ++i) Next();
}

const KeptKnot* KeptKnots::Reader::Next() {
  if (at_ == kept_.BytesOf(block_).size()) {
    if (block_ == kept_.blocks_.size()) return nullptr;
    ++block_;
    at_ = 0;
    if (kept_.BytesOf(block_).empty()) return nullptr;
  }
  const KeptKnot before = at_ == 0 ? KeptKnot{} : last_;
  Restore restore;
  at_ = Read(kept_.BytesOf(block_), at_, restore.words);
  GoThrough(restore, last_, before);
  return &last_;
}

void KeptKnots::Revise(std::size_t from, std::span<const AttitudeSample> attitude) {
  const std::size_t block = from / kBlock;  // of those before it nothing changes
  KeptKnots revised;
  Reader reader(*this, block * kBlock);
  while (const KeptKnot* kept = reader.Next()) {
    const std::size_t i = block * kBlock + revised.size();
    revised.Add(kept->knot, i < from ? kept->attitude : attitude[i - from]);
  }
  blocks_.resize(block);
  std::ranges::move(revised.blocks_, std::back_inserter(blocks_));
  open_ = std::move(revised.open_);
  last_ = revised.last_;
}

std::optional<AttitudeSample> KeptKnots::KnownAt(ToolTime time) const {
  const auto block =
      std::ranges::partition_point(blocks_, [time](const Block& b) { return b.end <= time; });
  std::optional<AttitudeSample> known;
  const auto begin = static_cast<std::size_t>(block - blocks_.begin());
  Reader reader(*this, begin > 0 ? (begin - 1) * kBlock : 0);
  for (const KeptKnot* kept = reader.Next(); kept != nullptr && kept->attitude.time <= time;
       kept = reader.Next()) {
    known = kept->attitude;
  }
  return known;
}

std::size_t KeptKnots::bytes() const {
  std::size_t bytes = open_.capacity() + blocks_.capacity() * sizeof(Block);
  for (const Block& block : blocks_) bytes += block.bytes.capacity();
  return bytes;
}

}  // namespace wellgyro
