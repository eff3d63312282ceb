#include "wellgyro/noise/noise_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "wellgyro/noise/octave_table_internal.h"

namespace wellgyro {
namespace {

constexpr double kConfidence = 0.95;        // [1] of ranges, both sides together
constexpr double kOneSidedDeviance = 2.71;  // 1.645^2: chi-square of one degree at 0.90
constexpr double kNormal95 = 1.959964;      // standard normal at 0.975
constexpr double kNormal99 = 2.575829;      // at 0.995
// Half a 95 % range, in values, up to which it is symmetric: e^0.2 - 1 and 1 - e^-0.2, that of a
// logarithm, differ from it by 0.02.
constexpr double kNarrow = 0.2;
// Their limit of 5 % is one of 5 +- 1.8 %, sqrt(.05 .95 / 150).
constexpr int kTestReplicates = 150;
constexpr int kBoundRounds = 3;  // a bound, and twice again with the limit that holds there

Eigen::Index At(NoiseTerm term) { return static_cast<Eigen::Index>(term); }
unsigned Bit(NoiseTerm term) { return 1u << static_cast<unsigned>(term); }

double Quantile(std::vector<double> values, double p) {
  std::sort(values.begin(), values.end());
  const double at = p * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (at - static_cast<double>(below)) * (values[above] - values[below]);
}

class Fitter {
 public:
  Fitter(OctaveGrid grid, Eigen::VectorXd s, const NoiseFitOptions& options)
      : grid_(std::move(grid)), s_(std::move(s)), options_(options) {
    shape_.sinusoid_frequency = options.sinusoid_frequency;
    if (options.gauss_markov) shape_.correlation_time = std::sqrt(grid_.tau(0) * LastTau());
    used_ = (1u << kNoiseTerms) - 1;
    if (shape_.sinusoid_frequency == 0) used_ &= ~Bit(NoiseTerm::kSinusoid);
    problem_.offset = Eigen::VectorXd::Zero(grid_.size());
  }

  /// Nothing where the model that fits best has no noise, only a ramp or a sinusoid.
  std::optional<NoiseFit> Fit() {
    NoiseFit fit;
    if (!FitWithOwnDof()) return std::nullopt;
    TestTerm(NoiseTerm::kRateRamp, fit.term[NoiseTerm::kRateRamp]);
    if (!fit.term[NoiseTerm::kRateRamp].observable) {
      used_ &= ~Bit(NoiseTerm::kRateRamp);
      if (!FitWithOwnDof()) return std::nullopt;
    }
    Report(0.2);
    for (const auto term : kAllNoiseTerms) {
      if (term != NoiseTerm::kRateRamp && (used_ & Bit(term))) TestTerm(term, fit.term[term]);
    }
    fit.model = ModelOf(best_.weight, shape_);
    fit.deviance = best_.deviance;
    fit.points = static_cast<int>(grid_.size());
    Report(0.5);
    Bootstrap(fit);
    BoundUnobservable(fit);
    Report(1);
    return fit;
  }

 private:
  double LastTau() const { return grid_.tau(grid_.size() - 1); }

  void Report(double part) const {
    if (options_.progress) options_.progress(part);
  }

  // The degrees of freedom depend on the model and the model on them; both settle at once. False
  // where there are none: a model without noise has no sample variances that vary.
  bool FitWithOwnDof() {
    NoiseModel model =
        ModelOf(TermVector::Unit(kNoiseTerms, At(NoiseTerm::kAngleRandomWalk)), shape_);
    for (int round = 0; round < 3; ++round) {
      problem_.edf = grid_.Dof(model);
      if (!(problem_.edf.minCoeff() > 0)) return false;
      best_ = FitShape(s_);
      model = ModelOf(best_.weight, shape_);
    }
    return grid_.Dof(model).minCoeff() > 0;
  }

  // Fits the weights and, for Gauss-Markov, the correlation time; leaves the shape in place.
  WeightFit FitShape(const Eigen::VectorXd& s) {
    if (!options_.gauss_markov) return FitAt(s);
    const double low = std::log(grid_.tau(0));
    const double high = std::log(LastTau());
    double best_at = low;
    double least = std::numeric_limits<double>::infinity();
    const auto deviance = [&](double log_time) {
      shape_.correlation_time = std::exp(log_time);
      const double value = FitAt(s).deviance;
      if (value < least) {
        least = value;
        best_at = log_time;
      }
      return value;
    };
    constexpr double kStep = 0.7;  // [ln s], an octave: the peak is two decades wide
    for (double at = low; at <= high; at += kStep) deviance(at);
    for (double step = kStep / 2; step > 1e-3; step /= 2) {
      const double centre = best_at;
      deviance(std::max(low, centre - step));
      deviance(std::min(high, centre + step));
    }
    shape_.correlation_time = std::exp(best_at);
    return FitAt(s);
  }

  WeightFit FitAt(const Eigen::VectorXd& s) {
    problem_.columns = grid_.Columns(shape_);
    return FitVariances(problem_, s, used_);
  }

  // Whether the term gains more than it would in logs of the model without it.
  void TestTerm(NoiseTerm term, TermFit& result) {
    const unsigned others = used_ & ~Bit(term);
    const WeightFit without = FitVariances(problem_, s_, others);
    result.gain = without.deviance - best_.deviance;
    result.gain_limit = kOneSidedDeviance;
    const NoiseModel rest = ModelOf(without.weight, shape_);
    const bool varies = std::isfinite(without.deviance) && grid_.Dof(rest).minCoeff() > 0;
    if (result.gain > kOneSidedDeviance / 2 && varies) {
      const TableSampler sampler(grid_, rest);
      VarianceProblem problem = problem_;
      problem.edf = sampler.dof();
      Random random(options_.seed);
      std::vector<double> gains;
      for (int i = 0; i < kTestReplicates; ++i) {
        const Eigen::VectorXd s = sampler.Draw(random);
        gains.push_back(FitVariances(problem, s, others).deviance -
                        FitVariances(problem, s, used_).deviance);
      }
      result.gain_limit = std::max(kOneSidedDeviance, Quantile(gains, kConfidence));
    }
    result.observable = result.gain > result.gain_limit;
  }

  void Bootstrap(NoiseFit& fit) {
    const TableSampler sampler(grid_, fit.model);
    const NoiseShape shape = shape_;
    Random random(options_.seed + 1);
    const int replicates = std::max(40, options_.replicates);
    Eigen::MatrixXd draws(replicates, kNoiseTerms);
    std::vector<double> times;
    for (int i = 0; i < replicates; ++i) {
      const NoiseModel drawn = ModelOf(FitShape(sampler.Draw(random)).weight, shape_);
      for (const auto term : kAllNoiseTerms) draws(i, At(term)) = drawn.coefficient[term];
      times.push_back(shape_.correlation_time.value_or(0));
      if (i % 32 == 0) Report(0.5 + 0.4 * i / replicates);
    }
    shape_ = shape;
    for (const auto term : kAllNoiseTerms) {
      TermFit& of = fit.term[term];
      if (!of.observable) continue;
      const Eigen::VectorXd column = draws.col(At(term));
      const std::vector<double> values(column.begin(), column.end());
      of.value = fit.model.coefficient[term];
      // The range of 99 % tells the width of a skew distribution best; where it is narrow the
      // distribution is nearly normal, where not it leans on zero and its own bounds are taken.
      of.sigma = (Quantile(values, 0.995) - Quantile(values, 0.005)) / (2 * kNormal99);
      of.lower95 = Quantile(values, (1 - kConfidence) / 2);
      of.upper95 = Quantile(values, (1 + kConfidence) / 2);
      if (kNormal95 * of.sigma < kNarrow * of.value) {
        of.lower95 = of.value - kNormal95 * of.sigma;
        of.upper95 = of.value + kNormal95 * of.sigma;
      }
    }
    if (options_.gauss_markov) {
      fit.sigma_correlation_time = (Quantile(times, 0.8413) - Quantile(times, 0.1587)) / 2;
    }
  }

  // The largest coefficient at which the rest can still explain the table.
  void BoundUnobservable(NoiseFit& fit) {
    for (const auto term : kAllNoiseTerms) {
      TermFit& of = fit.term[term];
      const bool asked = term != NoiseTerm::kSinusoid || shape_.sinusoid_frequency > 0;
      if (!of.observable && asked) of.upper95 = UpperBound(term);
    }
  }

  double UpperBound(NoiseTerm term) {
    const Eigen::VectorXd column = problem_.columns.col(At(term));
    const unsigned others = used_ & ~Bit(term);
    const WeightFit free = FitVariances(problem_, s_, used_ | Bit(term));
    VarianceProblem held = problem_;
    const auto hold = [&](double coefficient, const Eigen::VectorXd& s) {
      held.offset = coefficient * coefficient * column;
      return FitVariances(held, s, others);
    };
    double limit = kOneSidedDeviance;
    double bound = 0;
    for (int round = 0; round < kBoundRounds; ++round) {
      double high = std::sqrt(s_.cwiseQuotient(column).minCoeff());
      double low = std::sqrt(std::max(0., free.weight(At(term))));
      const auto excess = [&](double c) { return hold(c, s_).deviance - free.deviance - limit; };
      while (excess(high) < 0) high *= 2;
      while (high - low > 1e-3 * high) {
        const double middle = (low + high) / 2;
        (excess(middle) < 0 ? low : high) = middle;
      }
      bound = high;
      if (round + 1 < kBoundRounds) limit = ExcessLimit(term, bound, hold);
    }
    return bound;
  }

  // What the deviance at a term's true coefficient exceeds the least by, once in twenty logs, on
  // the side where the log shows too little of the term.
  template <class Hold>
  double ExcessLimit(NoiseTerm term, double coefficient, const Hold& hold) {
    NoiseModel truth = ModelOf(hold(coefficient, s_).weight, shape_);
    truth.coefficient[term] = coefficient;
    const TableSampler sampler(grid_, truth);
    Random random(options_.seed + 2);
    std::vector<double> excesses;
    for (int i = 0; i < kTestReplicates; ++i) {
      const Eigen::VectorXd s = sampler.Draw(random);
      const WeightFit free = FitVariances(problem_, s, used_ | Bit(term));
      const bool less = free.weight(At(term)) < coefficient * coefficient;
      excesses.push_back(less ? hold(coefficient, s).deviance - free.deviance : 0);
    }
    return std::max(kOneSidedDeviance, Quantile(excesses, kConfidence));
  }

  OctaveGrid grid_;
  Eigen::VectorXd s_;
  const NoiseFitOptions& options_;
  NoiseShape shape_;
  unsigned used_ = 0;
  VarianceProblem problem_;
  WeightFit best_;
};

void CheckOctaves(const AllanResult& octaves) {
  if (octaves.deviation != Deviation::kOverlapped) {
    throw std::invalid_argument("FitNoise: the variances must be overlapped ones");
  }
  for (std::size_t i = 1; i < octaves.points.size(); ++i) {
    if (octaves.points[i].factor != 2 * octaves.points[i - 1].factor) {
      throw std::invalid_argument("FitNoise: the averaging factors must be octaves, factor " +
                                  std::to_string(octaves.points[i].factor) + " is not");
    }
  }
}

}  // namespace

Result<NoiseFit> FitNoise(const AllanResult& octaves, const NoiseFitOptions& options) {
  CheckOctaves(octaves);
  OctaveGrid grid;
  grid.period = octaves.period;
  std::vector<double> variances;
  for (const auto& point : octaves.points) {
    // Fewer differences than half an averaging time are hardly more than one.
    if (point.terms < point.factor / 2 + 1 || !(point.variance > 0)) break;
    grid.factors.push_back(point.factor);
    grid.terms.push_back(point.terms);
    variances.push_back(point.variance);
  }
  if (variances.size() < 3) {
    return Fault{.code = FaultCode::kRange,
                 .text =
                     "fewer than three averaging times have a variance above zero: the log is "
                     "too short, or its values do not change"};
  }
  const Eigen::VectorXd s = Eigen::Map<const Eigen::VectorXd>(
      variances.data(), static_cast<Eigen::Index>(variances.size()));
  std::optional<NoiseFit> fit = Fitter(std::move(grid), s, options).Fit();
  if (fit) return *std::move(fit);
  return Fault{.code = FaultCode::kRange, .text = "no noise shows beside the log's straight drift"};
}

NoiseCoefficients CoefficientsOf(const NoiseFit& fit) {
  NoiseCoefficients c;
  c.quantization = fit.term[NoiseTerm::kQuantization].value;
  c.angle_random_walk = fit.term[NoiseTerm::kAngleRandomWalk].value;
  c.bias_instability = fit.term[NoiseTerm::kBiasInstability].value;
  c.rate_random_walk = fit.term[NoiseTerm::kRateRandomWalk].value;
  c.rate_ramp = fit.term[NoiseTerm::kRateRamp].value;
  if (fit.term[NoiseTerm::kBiasInstability].observable) {
    c.bias_instability_correlation_time = fit.model.shape.correlation_time;
  }
  return c;
}

}  // namespace wellgyro
