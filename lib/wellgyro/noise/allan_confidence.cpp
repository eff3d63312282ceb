#include "wellgyro/noise/allan_confidence.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/drift.h"
#include "wellgyro/math/statistics.h"

namespace wellgyro {
namespace {

constexpr std::array<double, 3> kSecondDifference{1, -2, 1};

// Generalised covariance of the phase at lag t: that of the process less any even parabola, which
// second differences take away. White phase is left out: it lives at lag 0 alone.
double PhaseCovariance(const NoiseModel& model, double t) {
  const auto& c = model.coefficient;
  t = std::abs(t);
  double g = -0.5 * c[NoiseTerm::kAngleRandomWalk] * c[NoiseTerm::kAngleRandomWalk] * t;
  const double k = c[NoiseTerm::kRateRandomWalk];
  g += k * k * t * t * t / 12;
  const double b = c[NoiseTerm::kBiasInstability];
  if (b == 0) return g;
  if (!model.shape.correlation_time) {
    return t > 0 ? g + b * b / (2 * kPi) * t * t * std::log(t) : g;
  }
  const double time = *model.shape.correlation_time;
  const double u = t / time;
  // The parabola u^2/2 is taken off so that short lags do not cancel.
  const double bent = u < 1e-2 ? u * u * u * (-1 / 6. + u / 24) : std::expm1(-u) + u - u * u / 2;
  return g - std::pow(kMarkovSigmaPerInstability * b * time, 2) * bent;
}

// Lags are sampled `per_average` to the shorter averaging time, or at every sample where that is
// fewer.
struct LagGrid {
  LagGrid(std::int64_t factor, std::int64_t per_average)
      : points(std::min(factor, per_average)),
        step(static_cast<double>(factor) / static_cast<double>(points)) {}
  std::int64_t points;  // of the grid in the shorter averaging time
  double step;          // in samples
};

// How many pairs of terms, one of each sequence, lie `lag` apart: a trapezium.
double PairsAt(double lag, double terms_i, double terms_j) {
  return std::max(0., std::min(terms_i, terms_j - lag) - std::max(0., -lag));
}

// How many lie within half a step of it; exact where few terms are left, which a sample of the
// trapezium would miss.
double PairsAround(double lag, double step, double terms_i, double terms_j) {
  if (step == 1) return PairsAt(lag, terms_i, terms_j);
  const double flat = std::min(terms_i, terms_j);
  const auto up_to = [&](double x) {
    const auto ramp = [](double t) { return t > 0 ? t * t / 2 : 0; };
    return ramp(x + terms_i) - ramp(x + terms_i - flat) - ramp(x - terms_j + flat) +
           ramp(x - terms_j);
  };
  return up_to(lag + step / 2) - up_to(lag - step / 2);
}

// Sums over all pairs of differences, one of each averaging time, of their covariance and of its
// square. In samples; `step` of them apart.
struct PairSums {
  double covariance = 0;
  double square = 0;
};

class PairSummer {
 public:
  PairSummer(const NoiseModel& model, double period, const LagGrid& grid, std::int64_t reach)
      : grid_(grid), white_phase_(std::pow(model.coefficient[NoiseTerm::kQuantization], 2)) {
    lags_.reserve(static_cast<std::size_t>(reach) + 1);
    for (std::int64_t q = 0; q <= reach; ++q) {
      lags_.push_back(PhaseCovariance(model, static_cast<double>(q) * grid.step * period));
    }
  }

  // Over every sample: the terms of both begin one sample apart.
  PairSums Overlapped(std::int64_t ratio, double terms_i, double terms_j) {
    const std::int64_t p_i = grid_.points;
    const std::int64_t p_j = p_i * ratio;
    const std::int64_t tail = kTail * p_j;
    FillOuter(p_j, -2 * p_j - tail - 2 * p_i, 2 * p_i + tail);
    PairSums sums;
    for (std::int64_t q = -2 * p_j - tail; q <= 2 * p_i + tail; ++q) {
      const double pairs =
          PairsAround(static_cast<double>(q) * grid_.step, grid_.step, terms_i, terms_j);
      if (pairs <= 0) continue;
      const double r = Outer(q) - 2 * Outer(q - p_i) + Outer(q - 2 * p_i);
      sums.covariance += pairs * r;
      sums.square += pairs * r * r;
    }
    if (white_phase_ > 0) AddWhitePhase(p_i, p_j, terms_i, terms_j, sums);
    return sums;
  }

  // Of one averaging time, the terms that far apart.
  PairSums SideBySide(double terms) {
    PairSums sums;
    const std::int64_t p = grid_.points;
    FillOuter(p, -(kTail + 4) * p, (kTail + 4) * p);
    for (std::int64_t lag = -kTail; lag <= kTail; ++lag) {
      const double pairs = terms - static_cast<double>(std::abs(lag));
      if (pairs <= 0) continue;
      const std::int64_t q = lag * p;
      double r = Outer(q) - 2 * Outer(q - p) + Outer(q - 2 * p);
      for (std::size_t a = 0; a < 3; ++a) {
        const std::int64_t b = static_cast<std::int64_t>(a) - lag;
        if (b >= 0 && b < 3) {
          r += white_phase_ * kSecondDifference[a] * kSecondDifference[static_cast<std::size_t>(b)];
        }
      }
      sums.covariance += pairs * r;
      sums.square += pairs * r * r;
    }
    return sums;
  }

  // Of means of `factor` successive differences of one averaging time.
  PairSums Modified(double terms) {
    const std::int64_t p = grid_.points;
    // White phase spread evenly over the grid's step.
    lags_[0] += white_phase_ / grid_.step;
    const std::int64_t tail = (kTail + 2) * p;
    FillOuter(p, -tail - 4 * p, tail + 4 * p);
    std::vector<double> r;
    for (std::int64_t q = -tail; q <= tail; ++q) {
      r.push_back(Outer(q) - 2 * Outer(q - p) + Outer(q - 2 * p));
    }
    PairSums sums;
    for (std::int64_t q = -tail + p; q <= tail - p; ++q) {
      const double pairs =
          PairsAround(static_cast<double>(q) * grid_.step, grid_.step, terms, terms);
      if (pairs <= 0 && q != 0) continue;
      double mean = 0;
      for (std::int64_t s = 1 - p; s < p; ++s) {
        mean += static_cast<double>(p - std::abs(s)) * r[static_cast<std::size_t>(q + s + tail)];
      }
      mean /= static_cast<double>(p * p);
      if (q == 0) mean_square_ = mean;
      sums.covariance += pairs * mean;
      sums.square += pairs * mean * mean;
    }
    return sums;
  }

  double mean_square() const { return mean_square_; }

  static constexpr std::int64_t kTail = 6;  // flicker's correlation is below 1e-3 there

 private:
  double Lag(std::int64_t q) const { return lags_[static_cast<std::size_t>(std::abs(q))]; }
  double Outer(std::int64_t q) const { return outer_[static_cast<std::size_t>(q - outer_begin_)]; }

  // The difference over the longer averaging time, for every lag from begin to end.
  void FillOuter(std::int64_t p_j, std::int64_t begin, std::int64_t end) {
    outer_begin_ = begin;
    outer_.clear();
    for (std::int64_t q = begin; q <= end; ++q) {
      outer_.push_back(Lag(q) - 2 * Lag(q + p_j) + Lag(q + 2 * p_j));
    }
  }

  // White phase meets itself at single samples, wherever a corner of one difference meets one of
  // the other.
  void AddWhitePhase(std::int64_t p_i, std::int64_t p_j, double terms_i, double terms_j,
                     PairSums& sums) const {
    std::vector<std::int64_t> seen;
    const auto weight = [&](std::int64_t q) {
      double w = 0;
      for (std::int64_t a = 0; a < 3; ++a) {
        for (std::int64_t b = 0; b < 3; ++b) {
          if (a * p_i - b * p_j == q) {
            w += kSecondDifference[static_cast<std::size_t>(a)] *
                 kSecondDifference[static_cast<std::size_t>(b)];
          }
        }
      }
      return w * white_phase_;
    };
    for (std::int64_t a = 0; a < 3; ++a) {
      for (std::int64_t b = 0; b < 3; ++b) {
        const std::int64_t q = a * p_i - b * p_j;
        if (std::find(seen.begin(), seen.end(), q) != seen.end()) continue;
        seen.push_back(q);
        const double pairs = PairsAt(static_cast<double>(q) * grid_.step, terms_i, terms_j);
        if (pairs <= 0) continue;
        const double white = weight(q);
        const double r = Outer(q) - 2 * Outer(q - p_i) + Outer(q - 2 * p_i);
        sums.covariance += pairs * white;
        sums.square += pairs * white * (white + 2 * r);
      }
    }
  }

  LagGrid grid_;
  double white_phase_;
  std::vector<double> lags_;
  std::vector<double> outer_;
  std::int64_t outer_begin_ = 0;
  double mean_square_ = 0;
};

// What the ramp adds to every difference at `tau`.
double RampDifference(const NoiseModel& model, double tau) {
  return model.coefficient[NoiseTerm::kRateRamp] * tau * tau;
}

// Covariance of the means of squares of two jointly normal sequences of constant means.
double MeanSquareCovariance(const PairSums& sums, double ramp_i, double ramp_j, double terms_i,
                            double terms_j) {
  return (2 * sums.square + 4 * ramp_i * ramp_j * sums.covariance) / (terms_i * terms_j);
}

double WithoutSinusoid(const NoiseModel& model, double tau) {
  NoiseModel plain = model;
  plain.coefficient[NoiseTerm::kSinusoid] = 0;
  return ModelAllanVariance(plain, tau);
}

}  // namespace

double EquivalentDof(const NoiseModel& model, double period, std::int64_t factor,
                     std::int64_t terms, Deviation deviation) {
  if (terms <= 0) return 0;
  const double tau = static_cast<double>(factor) * period;
  const auto n = static_cast<double>(terms);
  const LagGrid grid(factor, 16);
  const std::int64_t reach = (PairSummer::kTail + 8) * grid.points;
  PairSummer summer(model, period, grid, reach);
  const double ramp = RampDifference(model, tau);
  double mean = 2 * tau * tau * WithoutSinusoid(model, tau);
  PairSums sums;
  switch (deviation) {
    case Deviation::kOverlapped:
      sums = summer.Overlapped(1, n, n);
      break;
    case Deviation::kAllan:
      sums = summer.SideBySide(n);
      break;
    case Deviation::kModified:
      sums = summer.Modified(n);
      mean = summer.mean_square() + ramp * ramp;
      break;
  }
  const double variance = MeanSquareCovariance(sums, ramp, ramp, n, n);
  return variance > 0 ? 2 * mean * mean / variance : 0;
}

Eigen::MatrixXd OctaveCovariance(const NoiseModel& model, double period,
                                 std::span<const std::int64_t> factors,
                                 std::span<const std::int64_t> terms) {
  // Ratio of octaves whose variances are taken as independent beyond it. The correlation at 256,
  // full overlap, int S_m S_M df over the root of both squares' integrals: 0.0004 of white noise,
  // 0.0007 of flicker, 0.09 of a rate random walk, which at 64 has 0.17.
  constexpr std::int64_t kFarthest = 256;
  const auto size = static_cast<Eigen::Index>(factors.size());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(size, size);
  const auto tau = [&](std::size_t i) { return static_cast<double>(factors[i]) * period; };
  for (std::size_t i = 0; i < factors.size(); ++i) {
    if (terms[i] <= 0) continue;
    const std::int64_t farthest = std::min(kFarthest, factors.back() / factors[i]);
    const LagGrid grid(factors[i], 8);
    const std::int64_t reach = grid.points * ((PairSummer::kTail + 4) * farthest + 8);
    PairSummer summer(model, period, grid, reach);
    for (std::size_t j = i; j < factors.size() && factors[j] <= kFarthest * factors[i]; ++j) {
      if (terms[j] <= 0) continue;
      const auto n_i = static_cast<double>(terms[i]);
      const auto n_j = static_cast<double>(terms[j]);
      const PairSums sums = summer.Overlapped(factors[j] / factors[i], n_i, n_j);
      const double of_squares = MeanSquareCovariance(sums, RampDifference(model, tau(i)),
                                                     RampDifference(model, tau(j)), n_i, n_j);
      const double value = of_squares / std::pow(2 * tau(i) * tau(j), 2);
      covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = value;
      covariance(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(i)) = value;
    }
  }
  return covariance;
}

VarianceInterval ChiSquareInterval(double variance, double edf, double confidence) {
  const double tail = (1 - confidence) / 2;
  return {edf * variance / ChiSquareQuantile(1 - tail, edf),
          edf * variance / ChiSquareQuantile(tail, edf)};
}

std::vector<AllanRow> AllanTable(const AllanResult& result, const NoiseModel& model) {
  std::vector<AllanRow> rows;
  for (const auto& point : result.points) {
    if (point.terms < 1 || !(point.variance > 0)) continue;
    AllanRow row;
    row.point = point;
    row.edf = EquivalentDof(model, result.period, point.factor, point.terms, result.deviation);
    row.interval95 = ChiSquareInterval(point.variance, row.edf, 0.95);
    row.model = ModelAllanVariance(model, point.tau);
    row.dominant = DominantTerm(model, point.tau);
    rows.push_back(row);
  }
  return rows;
}

}  // namespace wellgyro
