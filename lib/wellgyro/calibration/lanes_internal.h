#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

/// Numbers of several samples side by side: what the processor does with one number it does with
/// several at once. Whether they are four or eight, each is treated alike and rounded alike.
///
/// Vectors are handed on by reference alone: by value, how they travel would depend on what the
/// function is compiled for.
namespace wellgyro {

using Doubles2 [[gnu::vector_size(16)]] = double;
using Doubles4 [[gnu::vector_size(32)]] = double;
using Singles4 [[gnu::vector_size(16)]] = float;
using Singles8 [[gnu::vector_size(32)]] = float;
using Longs2 [[gnu::vector_size(16)]] = std::int64_t;
using Longs4 [[gnu::vector_size(32)]] = std::int64_t;

/// A number that is the same for every sample.
union SameDouble {
  Doubles4 four{};
  Doubles2 two;
  void operator=(double n) { four = Doubles4{n, n, n, n}; }
};
union SameSingle {
  Singles8 eight{};
  Singles4 four;
  void operator=(double number) {
    const auto n = static_cast<float>(number);
    eight = Singles8{n, n, n, n, n, n, n, n};
  }
};

inline float SingleAt(const std::byte* from) {
  float n;
  std::memcpy(&n, from, sizeof n);
  return n;
}

/// Four samples, 128 bits of singles, by what every processor has.
struct Lanes4 {
  static constexpr std::size_t kCount = 4;
  using Single = Singles4;
  using Half = Doubles2;   ///< half of the samples
  using Double = Half[2];  ///< all of them
  using Mask = Longs2;     ///< of half: all bits of a sample for which something holds, else none
  [[gnu::always_inline]] static const Single& Of(const SameSingle& n) { return n.four; }
  [[gnu::always_inline]] static const Half& Of(const SameDouble& n) { return n.two; }

  [[gnu::always_inline]] static void Load(const float* from, Single& to) {
    std::memcpy(&to, from, sizeof to);
  }
  [[gnu::always_inline]] static void Load(const double* from, Double& to) {
    std::memcpy(&to[0], from, sizeof(Half));
    std::memcpy(&to[1], from + 2, sizeof(Half));
  }
  /// Of numbers that stand `step` bytes apart.
  [[gnu::always_inline]] static void Gather(const std::byte* from, std::size_t step, Single& to) {
    to = Single{SingleAt(from), SingleAt(from + step), SingleAt(from + 2 * step),
                SingleAt(from + 3 * step)};
  }
  [[gnu::always_inline]] static void Store(const Single& from, float* to) {
    std::memcpy(to, &from, sizeof from);
  }
  [[gnu::always_inline]] static void Store(const Double& from, double* to) {
    std::memcpy(to, &from[0], sizeof(Half));
    std::memcpy(to + 2, &from[1], sizeof(Half));
  }
  [[gnu::always_inline]] static void ToDouble(const std::int32_t* n, Double& to) {
#if defined(__x86_64__)
    to[0] = _mm_cvtepi32_pd(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(n)));
    to[1] = _mm_cvtepi32_pd(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(n + 2)));
#else
    to[0] = Half{static_cast<double>(n[0]), static_cast<double>(n[1])};
    to[1] = Half{static_cast<double>(n[2]), static_cast<double>(n[3])};
#endif
  }
  [[gnu::always_inline]] static void ToDouble(const Single& n, Double& to) {
#if defined(__x86_64__)
    to[0] = _mm_cvtps_pd(n);
    to[1] = _mm_cvtps_pd(_mm_movehl_ps(n, n));
#else
    to[0] = Half{static_cast<double>(n[0]), static_cast<double>(n[1])};
    to[1] = Half{static_cast<double>(n[2]), static_cast<double>(n[3])};
#endif
  }
  [[gnu::always_inline]] static void ToSingle(const Double& n, Single& to) {
#if defined(__x86_64__)
    to = _mm_movelh_ps(_mm_cvtpd_ps(n[0]), _mm_cvtpd_ps(n[1]));
#else
    to = Single{static_cast<float>(n[0][0]), static_cast<float>(n[0][1]),
                static_cast<float>(n[1][0]), static_cast<float>(n[1][1])};
#endif
  }
  [[gnu::always_inline]] static void ToSingle(const std::int32_t* n, Single& to) {
#if defined(__x86_64__)
    to = _mm_cvtepi32_ps(_mm_loadu_si128(reinterpret_cast<const __m128i*>(n)));
#else
    to = Single{static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2]),
                static_cast<float>(n[3])};
#endif
  }
  [[gnu::always_inline]] static bool AnyAbove(const Single& n, float limit) {
    const auto above = n > limit;
    return (above[0] | above[1] | above[2] | above[3]) != 0;
  }
  [[gnu::always_inline]] static bool All(const Mask& mask) { return (mask[0] & mask[1]) != 0; }
  /// Takes from `to` what the mask has not.
  [[gnu::always_inline]] static void And(const Mask& mask, std::int64_t* to) {
    Mask both;
    std::memcpy(&both, to, sizeof both);
    both &= mask;
    std::memcpy(to, &both, sizeof both);
  }
};

#if defined(__x86_64__)
/// Eight, 256 bits, by AVX2: only for functions compiled for it.
struct Lanes8 {
  static constexpr std::size_t kCount = 8;
  using Single = Singles8;
  using Half = Doubles4;
  using Double = Half[2];
  using Mask = Longs4;
  [[gnu::always_inline]] static const Single& Of(const SameSingle& n) { return n.eight; }
  [[gnu::always_inline]] static const Half& Of(const SameDouble& n) { return n.four; }

  [[gnu::target("avx2")]] static inline void Load(const float* from, Single& to) {
    to = _mm256_loadu_ps(from);
  }
  [[gnu::target("avx2")]] static inline void Load(const double* from, Double& to) {
    to[0] = _mm256_loadu_pd(from);
    to[1] = _mm256_loadu_pd(from + 4);
  }
  [[gnu::target("avx2")]] static inline void Gather(const std::byte* from, std::size_t step,
                                                    Single& to) {
    Singles4 low, high;
    Lanes4::Gather(from, step, low);
    Lanes4::Gather(from + 4 * step, step, high);
    to = _mm256_insertf128_ps(_mm256_castps128_ps256(low), high, 1);
  }
  [[gnu::target("avx2")]] static inline void Store(const Single& from, float* to) {
    _mm256_storeu_ps(to, from);
  }
  [[gnu::target("avx2")]] static inline void Store(const Double& from, double* to) {
    _mm256_storeu_pd(to, from[0]);
    _mm256_storeu_pd(to + 4, from[1]);
  }
  [[gnu::target("avx2")]] static inline void ToDouble(const std::int32_t* n, Double& to) {
    to[0] = _mm256_cvtepi32_pd(_mm_loadu_si128(reinterpret_cast<const __m128i*>(n)));
    to[1] = _mm256_cvtepi32_pd(_mm_loadu_si128(reinterpret_cast<const __m128i*>(n + 4)));
  }
  [[gnu::target("avx2")]] static inline void ToDouble(const Single& n, Double& to) {
    to[0] = _mm256_cvtps_pd(_mm256_castps256_ps128(n));
    to[1] = _mm256_cvtps_pd(_mm256_extractf128_ps(n, 1));
  }
  [[gnu::target("avx2")]] static inline void ToSingle(const Double& n, Single& to) {
    to = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm256_cvtpd_ps(n[0])), _mm256_cvtpd_ps(n[1]),
                              1);
  }
  [[gnu::target("avx2")]] static inline void ToSingle(const std::int32_t* n, Single& to) {
    to = _mm256_cvtepi32_ps(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(n)));
  }
  [[gnu::target("avx2")]] static inline bool AnyAbove(const Single& n, float limit) {
    return _mm256_movemask_ps(_mm256_cmp_ps(n, _mm256_set1_ps(limit), _CMP_GT_OQ)) != 0;
  }
  [[gnu::target("avx2")]] static inline bool All(const Mask& mask) {
    return _mm256_movemask_epi8(reinterpret_cast<__m256i>(mask)) == -1;
  }
  [[gnu::target("avx2")]] static inline void And(const Mask& mask, std::int64_t* to) {
    __m256i* at = reinterpret_cast<__m256i*>(to);
    _mm256_storeu_si256(at,
                        _mm256_and_si256(_mm256_loadu_si256(at), reinterpret_cast<__m256i>(mask)));
  }
};
#endif

}  // namespace wellgyro
