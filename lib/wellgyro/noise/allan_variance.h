#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "wellgyro/base/export.h"

namespace wellgyro {

/// How differences of neighbouring means are taken.
enum class Deviation {
  kAllan,       ///< averages side by side: the doubling procedure, at octaves
  kOverlapped,  ///< every pair of neighbouring averages there is
  kModified,    ///< overlapped, with the phase averaged as well
};

/// Samples that are not there, [begin, end) by their place in the even sequence.
struct SampleGap {
  std::int64_t begin = 0;
  std::int64_t end = 0;
};

/// The variance at one averaging time.
struct AllanPoint {
  std::int64_t factor = 0;  ///< samples averaged, m
  double tau = 0;           ///< averaging time [s]
  std::int64_t terms = 0;   ///< squared differences in the mean
  double variance = 0;      ///< [square of the data's unit]; 0 where terms = 0
};

struct AllanResult {
  Deviation deviation = Deviation::kOverlapped;
  double period = 0;         ///< between samples [s]
  std::int64_t samples = 0;  ///< in the even sequence, missing ones included
  std::int64_t missing = 0;
  std::vector<SampleGap> not_finite;  ///< stretches found to be NaN, infinite or beyond 1e140
  std::vector<AllanPoint> points;     ///< as the factors were asked for
};

struct AllanOptions {
  Deviation deviation = Deviation::kOverlapped;
  /// A difference counts when at most this share of its samples is missing; what is missing is then
  /// bridged by the mean of the samples around. The variance of white noise so bridged reads too
  /// high by about this share at most. 0: only whole differences count.
  double max_missing = 0.01;
  std::function<void(double)> progress;  ///< called now and then with the part done, 0 to 1
};

/// 1, 2, 4 ... as far as one difference of two averages fits into `samples`.
WELLGYRO_EXPORT std::vector<std::int64_t> OctaveFactors(std::int64_t samples);
/// 1, 2, 3 ... 9, 10, 20 ... 90, 100 ... likewise.
WELLGYRO_EXPORT std::vector<std::int64_t> DecadeFactors(std::int64_t samples);
/// The whole numbers of samples nearest to averaging times [s], sorted, each once; those that do
/// not fit are left out. Throws std::invalid_argument for one that is not positive.
WELLGYRO_EXPORT std::vector<std::int64_t> FactorsOf(std::span<const double> taus, double period,
                                                    std::int64_t samples);

/// Allan variance of `rate`, mean rates over successive periods, at the given averaging factors.
///
///   s2(m) = 1/(2 m^2 n) sum_k (x[k+2m] - 2 x[k+m] + x[k])^2,   x[0] = 0, x[k+1] = x[k] + rate[k],
/// over all k = 0 .. M-2m (overlapped), over k = 0, m, 2m ... (Allan); modified as in Riley, NIST
/// SP 1065 (2008), eq. 14. Every term counts, also at M = 2m. Exact: the sums are taken from block
/// to block without cancellation, to a relative 1e-12 for biases up to 1e6 times the scatter and
/// 1e8 samples. One pass; beside the data it needs about 10 MiB when overlapped.
///
/// Samples in `gaps` (sorted, apart) are missing, whatever stands in their place; those that are
/// not finite are found and treated alike. Throws std::invalid_argument for a period or a factor
/// that is not positive and for gaps that are not in order.
WELLGYRO_EXPORT AllanResult AllanVariance(std::span<const double> rate, double period,
                                          std::span<const std::int64_t> factors,
                                          const AllanOptions& options = {},
                                          std::span<const SampleGap> gaps = {});

}  // namespace wellgyro
