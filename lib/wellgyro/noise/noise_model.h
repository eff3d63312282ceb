#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "wellgyro/base/export.h"
#include "wellgyro/record/noise.h"

namespace wellgyro {

/// What a rate's noise is made of, with its Allan variance at averaging time t:
enum class NoiseTerm : std::size_t {
  kQuantization,     ///< Q: 3 Q^2/t^2
  kAngleRandomWalk,  ///< N: N^2/t
  kBiasInstability,  ///< B: (2 ln2/pi) B^2, or a Gauss-Markov process of sigma 1.0760 B
  kRateRandomWalk,   ///< K: K^2 t/3
  kRateRamp,         ///< R: R^2 t^2/2
  kSinusoid,         ///< amplitude A at frequency f: A^2 (sin^2(pi f t)/(pi f t))^2
};
inline constexpr std::size_t kNoiseTerms = 6;
inline constexpr std::array<NoiseTerm, kNoiseTerms> kAllNoiseTerms{
    NoiseTerm::kQuantization,   NoiseTerm::kAngleRandomWalk, NoiseTerm::kBiasInstability,
    NoiseTerm::kRateRandomWalk, NoiseTerm::kRateRamp,        NoiseTerm::kSinusoid};

/// One value per term.
template <class T>
struct PerTerm : std::array<T, kNoiseTerms> {
  using Base = std::array<T, kNoiseTerms>;
  T& operator[](NoiseTerm term) { return Base::operator[](static_cast<std::size_t>(term)); }
  const T& operator[](NoiseTerm term) const {
    return Base::operator[](static_cast<std::size_t>(term));
  }
};

/// The shapes that two terms can take.
struct NoiseShape {
  /// Of bias instability as a Gauss-Markov process [s]; absent, it is flicker noise.
  std::optional<double> correlation_time;
  double sinusoid_frequency = 0;  ///< [Hz]; 0: none
};

/// Coefficients [the rate's unit times the power of s that the term has], with their shapes.
struct NoiseModel {
  PerTerm<double> coefficient{};
  NoiseShape shape;
};

/// Allan variance of one term of unit coefficient at averaging time `tau` > 0 [s] (IEEE 952-1997,
/// annex C; the process itself, not its samples: see AllanVariance for what sampling does to none).
WELLGYRO_EXPORT double UnitAllanVariance(NoiseTerm term, const NoiseShape& shape, double tau);
/// Of the whole model.
WELLGYRO_EXPORT double ModelAllanVariance(const NoiseModel& model, double tau);
/// The term that has the largest part at `tau`.
WELLGYRO_EXPORT NoiseTerm DominantTerm(const NoiseModel& model, double tau);

}  // namespace wellgyro
