#include <cstring>

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

[[gnu::always_inline]] inline void WriteStamp(const RawSample& raw, const Columns& from,
                                              std::size_t k, ImuSample& out) {
  out.stamp = raw.stamp;
  out.stamp.temperature_outside = raw.stamp.temperature_outside || from.inside[k] == 0;
  out.stamp.temperature = static_cast<float>(from.temperature[k]);
  out.has_gz = from.has_gz;
  out.has_mag = from.has_mag;
}

// Two samples from k on.
void PutTwo(const Vectors& u, std::size_t k, Eigen::Vector3d& to, Eigen::Vector3d& to_next) {
  Doubles2 x, y;
  std::memcpy(&x, &u[0][k], sizeof x);
  std::memcpy(&y, &u[1][k], sizeof y);
  const Doubles2 one = __builtin_shufflevector(x, y, 0, 2);
  const Doubles2 next = __builtin_shufflevector(x, y, 1, 3);
  std::memcpy(to.data(), &one, sizeof one);
  std::memcpy(to_next.data(), &next, sizeof next);
  to[2] = u[2][k];
  to_next[2] = u[2][k + 1];
}

// From the first-th on.
void WriteByTwo(std::span<const RawSample> raw, const Columns& from, std::size_t first,
                ImuSample* out) {
  std::size_t k = first;
  for (; k + 2 <= raw.size(); k += 2) {
    for (std::size_t i = k; i < k + 2; ++i) WriteStamp(raw[i], from, i, out[i]);
    PutTwo(from.w_IT_T, k, out[k].w_IT_T, out[k + 1].w_IT_T);
    PutTwo(from.f_T, k, out[k].f_T, out[k + 1].f_T);
    PutTwo(from.b_T, k, out[k].b_T, out[k + 1].b_T);
  }
  if (k == raw.size()) return;
  const auto put = [&](const Vectors& u, Eigen::Vector3d& to) { to = {u[0][k], u[1][k], u[2][k]}; };
  WriteStamp(raw[k], from, k, out[k]);
  put(from.w_IT_T, out[k].w_IT_T);
  put(from.f_T, out[k].f_T);
  put(from.b_T, out[k].b_T);
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

// Four samples from k on.
[[gnu::target("avx2")]] inline void PutFour(const Vectors& u, std::size_t k, ImuSample* out,
                                            Eigen::Vector3d ImuSample::*member) {
  const __m256d x = _mm256_loadu_pd(&u[0][k]), y = _mm256_loadu_pd(&u[1][k]);
  const __m256d even = _mm256_unpacklo_pd(x, y), odd = _mm256_unpackhi_pd(x, y);
  _mm_storeu_pd((out[0].*member).data(), _mm256_castpd256_pd128(even));
  _mm_storeu_pd((out[1].*member).data(), _mm256_castpd256_pd128(odd));
  _mm_storeu_pd((out[2].*member).data(), _mm256_extractf128_pd(even, 1));
  _mm_storeu_pd((out[3].*member).data(), _mm256_extractf128_pd(odd, 1));
#pragma GCC unroll 4
  for (std::size_t i = 0; i < 4; ++i) (out[i].*member).data()[2] = u[2][k + i];
}

// Gives how many samples.
[[gnu::target("avx2")]] std::size_t WriteByFour(std::span<const RawSample> raw, const Columns& from,
                                                ImuSample* out) {
  std::size_t k = 0;
  for (; k + 4 <= raw.size(); k += 4) {
    for (std::size_t i = k; i < k + 4; ++i) WriteStamp(raw[i], from, i, out[i]);
    PutFour(from.w_IT_T, k, out + k, &ImuSample::w_IT_T);
    PutFour(from.f_T, k, out + k, &ImuSample::f_T);
    PutFour(from.b_T, k, out + k, &ImuSample::b_T);
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

void Write(Lanes lanes, std::span<const RawSample> raw, const Columns& from, ImuSample* out) {
  std::size_t k = 0;
#if defined(__x86_64__)
  if (lanes == Lanes::kEight) k = WriteByFour(raw, from, out);
#endif
  static_cast<void>(lanes);
  WriteByTwo(raw, from, k, out);
}

}  // namespace wellgyro
