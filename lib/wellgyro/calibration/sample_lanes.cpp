#include <cstring>
#include <type_traits>

#include <Eigen/Core>

#include "wellgyro/calibration/sample_lanes_internal.h"

namespace wellgyro {
namespace {

static_assert(RawSample::kChannelsMax % 4 == 0);
using Wholes4 [[gnu::vector_size(16)]] = std::int32_t;

// Four channels of four samples.
void TransposeFour(const RawSample* raw, std::size_t c, std::size_t at, Counts& counts) {
  std::array<Wholes4, 4> rows;
  for (std::size_t k = 0; k < 4; ++k) std::memcpy(&rows[k], &raw[k].counts[c], sizeof(Wholes4));
  const Wholes4 a = __builtin_shufflevector(rows[0], rows[1], 0, 4, 1, 5);
  const Wholes4 b = __builtin_shufflevector(rows[2], rows[3], 0, 4, 1, 5);
  const Wholes4 d = __builtin_shufflevector(rows[0], rows[1], 2, 6, 3, 7);
  const Wholes4 e = __builtin_shufflevector(rows[2], rows[3], 2, 6, 3, 7);
  const std::array<Wholes4, 4> columns{
      __builtin_shufflevector(a, b, 0, 1, 4, 5), __builtin_shufflevector(a, b, 2, 3, 6, 7),
      __builtin_shufflevector(d, e, 0, 1, 4, 5), __builtin_shufflevector(d, e, 2, 3, 6, 7)};
  for (std::size_t k = 0; k < 4; ++k) std::memcpy(&counts[c + k][at], &columns[k], sizeof(Wholes4));
}

static_assert(std::is_trivially_copyable_v<SampleStamp> && sizeof(SampleStamp) >= 32 &&
              sizeof(SampleStamp) <= 64 &&
              offsetof(ImuSample, has_mag) == offsetof(ImuSample, has_gz) + 1);

// A sample's three vectors are nine numbers in a row.
constexpr std::size_t kRow = 9;
static_assert(sizeof(Eigen::Vector3d) == 3 * sizeof(double) &&
              offsetof(ImuSample, f_T) == offsetof(ImuSample, w_IT_T) + 3 * sizeof(double) &&
              offsetof(ImuSample, b_T) == offsetof(ImuSample, w_IT_T) + 6 * sizeof(double));
double* RowOf(ImuSample& sample) {
  return reinterpret_cast<double*>(reinterpret_cast<std::byte*>(&sample) +
                                   offsetof(ImuSample, w_IT_T));
}

using Rows = std::array<const double*, kRow>;

// Two samples from k on.
void PutTwo(const Rows& rows, std::size_t k, double* to, double* to_next) {
#pragma GCC unroll 4
  for (std::size_t i = 0; i + 2 <= kRow; i += 2) {
    Doubles2 x, y;
    std::memcpy(&x, rows[i] + k, sizeof x);
    std::memcpy(&y, rows[i + 1] + k, sizeof y);
    const Doubles2 one = __builtin_shufflevector(x, y, 0, 2);
    const Doubles2 next = __builtin_shufflevector(x, y, 1, 3);
    std::memcpy(to + i, &one, sizeof one);
    std::memcpy(to_next + i, &next, sizeof next);
  }
  to[kRow - 1] = rows[kRow - 1][k];
  to_next[kRow - 1] = rows[kRow - 1][k + 1];
}

#if defined(__x86_64__)
// Four channels of eight samples.
[[gnu::target("avx2")]] inline void TransposeEight(const RawSample* raw, std::size_t c,
                                                   std::size_t at, Counts& counts) {
  __m256i rows[4];
#pragma GCC unroll 4
  for (std::size_t k = 0; k < 4; ++k) {
    const __m128i low = _mm_loadu_si128(reinterpret_cast<const __m128i*>(&raw[k].counts[c]));
    const __m128i high = _mm_loadu_si128(reinterpret_cast<const __m128i*>(&raw[k + 4].counts[c]));
    rows[k] = _mm256_inserti128_si256(_mm256_castsi128_si256(low), high, 1);
  }
  const __m256i a = _mm256_unpacklo_epi32(rows[0], rows[1]);
  const __m256i b = _mm256_unpacklo_epi32(rows[2], rows[3]);
  const __m256i d = _mm256_unpackhi_epi32(rows[0], rows[1]);
  const __m256i e = _mm256_unpackhi_epi32(rows[2], rows[3]);
  const __m256i columns[4] = {_mm256_unpacklo_epi64(a, b), _mm256_unpackhi_epi64(a, b),
                              _mm256_unpacklo_epi64(d, e), _mm256_unpackhi_epi64(d, e)};
#pragma GCC unroll 4
  for (std::size_t k = 0; k < 4; ++k) {
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(&counts[c + k][at]), columns[k]);
  }
}

// Gives how many samples.
[[gnu::target("avx2")]] std::size_t TransposeByEight(std::span<const RawSample> raw,
                                                     std::size_t channels, std::size_t at,
                                                     Counts& counts) {
  std::size_t k = 0;
  for (; k + 8 <= raw.size(); k += 8) {
    for (std::size_t c = 0; c < channels; c += 4) TransposeEight(&raw[k], c, at + k, counts);
  }
  return k;
}

// A stamp is two overlapping halves.
[[gnu::target("avx2")]] void StampByHalves(std::span<const RawSample> raw,
                                           const double* temperature,
                                           const std::array<bool, 2>& has, ImuSample* out) {
  constexpr std::size_t kHalf = sizeof(__m256i), kSecond = sizeof(SampleStamp) - kHalf;
  for (std::size_t k = 0; k < raw.size(); ++k) {
    const auto* from = reinterpret_cast<const std::byte*>(&raw[k].stamp);
    auto* to = reinterpret_cast<std::byte*>(&out[k].stamp);
    const __m256i first = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
    const __m256i second = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from + kSecond));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), first);
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(to + kSecond), second);
    out[k].stamp.temperature = static_cast<float>(temperature[k]);
    std::memcpy(&out[k].has_gz, has.data(), sizeof has);
  }
}

// Four numbers from i on of four samples from k on.
[[gnu::target("avx2")]] inline void PutSquare(const Rows& rows, std::size_t i, std::size_t k,
                                              const std::array<double*, 4>& to) {
  const __m256d a = _mm256_loadu_pd(rows[i] + k), b = _mm256_loadu_pd(rows[i + 1] + k);
  const __m256d c = _mm256_loadu_pd(rows[i + 2] + k), d = _mm256_loadu_pd(rows[i + 3] + k);
  const __m256d ab_even = _mm256_unpacklo_pd(a, b), ab_odd = _mm256_unpackhi_pd(a, b);
  const __m256d cd_even = _mm256_unpacklo_pd(c, d), cd_odd = _mm256_unpackhi_pd(c, d);
  _mm256_storeu_pd(to[0] + i, _mm256_insertf128_pd(ab_even, _mm256_castpd256_pd128(cd_even), 1));
  _mm256_storeu_pd(to[1] + i, _mm256_insertf128_pd(ab_odd, _mm256_castpd256_pd128(cd_odd), 1));
  _mm256_storeu_pd(to[2] + i, _mm256_permute2f128_pd(ab_even, cd_even, 0x31));
  _mm256_storeu_pd(to[3] + i, _mm256_permute2f128_pd(ab_odd, cd_odd, 0x31));
}

// Gives how many samples.
[[gnu::target("avx2")]] std::size_t PutByFour(const Rows& rows, std::span<ImuSample> out) {
  std::size_t k = 0;
  for (; k + 4 <= out.size(); k += 4) {
    const std::array<double*, 4> to{RowOf(out[k]), RowOf(out[k + 1]), RowOf(out[k + 2]),
                                    RowOf(out[k + 3])};
    PutSquare(rows, 0, k, to);
    PutSquare(rows, 4, k, to);
#pragma GCC unroll 4
    for (std::size_t j = 0; j < 4; ++j) to[j][8] = rows[8][k + j];
  }
  return k;
}
#endif

}  // namespace

void Transpose(Lanes lanes, std::span<const RawSample> raw, std::size_t channels, std::size_t at,
               Counts& counts) {
  std::size_t k = 0;
#if defined(__x86_64__)
  if (lanes == Lanes::kEight) k = TransposeByEight(raw, channels, at, counts);
#endif
  static_cast<void>(lanes);
  for (; k + 4 <= raw.size(); k += 4) {
    for (std::size_t c = 0; c < channels; c += 4) TransposeFour(&raw[k], c, at + k, counts);
  }
  for (; k < raw.size(); ++k) {
    for (std::size_t c = 0; c < channels; ++c) counts[c][at + k] = raw[k].counts[c];
  }
}

void Stamp(Lanes lanes, std::span<const RawSample> raw, const double* temperature, bool has_gz,
           bool has_mag, ImuSample* out) {
#if defined(__x86_64__)
  if (lanes == Lanes::kEight) return StampByHalves(raw, temperature, {has_gz, has_mag}, out);
#endif
  static_cast<void>(lanes);
  for (std::size_t k = 0; k < raw.size(); ++k) {
    out[k].stamp = raw[k].stamp;
    out[k].stamp.temperature = static_cast<float>(temperature[k]);
    out[k].has_gz = has_gz;
    out[k].has_mag = has_mag;
  }
}

void Put(Lanes lanes, const Vectors& w_IT_T, const Vectors& f_T, const Vectors& b_T,
         std::span<ImuSample> out) {
  const Rows rows{w_IT_T[0].data(), w_IT_T[1].data(), w_IT_T[2].data(),
                  f_T[0].data(),    f_T[1].data(),    f_T[2].data(),
                  b_T[0].data(),    b_T[1].data(),    b_T[2].data()};
  std::size_t k = 0;
#if defined(__x86_64__)
  if (lanes == Lanes::kEight) k = PutByFour(rows, out);
#endif
  static_cast<void>(lanes);
  for (; k + 2 <= out.size(); k += 2) PutTwo(rows, k, RowOf(out[k]), RowOf(out[k + 1]));
  if (k == out.size()) return;
  for (std::size_t i = 0; i < kRow; ++i) RowOf(out[k])[i] = rows[i][k];
}

}  // namespace wellgyro
