#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "wellgyro/noise/variance_fit_internal.h"

namespace wellgyro {
namespace {

// Solves for the free unknowns alone; the others are 0.
TermVector SolveFree(const TermMatrix& gram, const TermVector& rhs, unsigned free) {
  std::array<Eigen::Index, kFitTermsMax> index{};
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < rhs.size(); ++i) {
    if (free >> i & 1u) index[static_cast<std::size_t>(count++)] = i;
  }
  TermMatrix part(count, count);
  TermVector right(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index row = index[static_cast<std::size_t>(i)];
    right(i) = rhs(row);
    for (Eigen::Index j = 0; j < count; ++j) {
      part(i, j) = gram(row, index[static_cast<std::size_t>(j)]);
    }
  }
  const TermVector solved = part.ldlt().solve(right);
  TermVector x = TermVector::Zero(rhs.size());
  for (Eigen::Index i = 0; i < count; ++i) x(index[static_cast<std::size_t>(i)]) = solved(i);
  return x;
}

double Deviance(const Eigen::VectorXd& mu, const Eigen::VectorXd& s, const Eigen::VectorXd& edf) {
  double deviance = 0;
  for (Eigen::Index i = 0; i < s.size(); ++i) {
    const double excess = (s(i) - mu(i)) / mu(i);
    deviance += edf(i) * (excess - std::log1p(excess));
  }
  return deviance;
}

// Half the sum of weight (s - A x)^2 with weights edf/(2 mu^2), in columns scaled to `scale`.
TermVector Reweighted(const VarianceProblem& problem, const Eigen::VectorXd& s,
                      const Eigen::VectorXd& mu, unsigned used) {
  const auto& columns = problem.columns;
  const Eigen::Index terms = columns.cols();
  TermMatrix gram = TermMatrix::Zero(terms, terms);
  TermVector rhs = TermVector::Zero(terms);
  for (Eigen::Index i = 0; i < s.size(); ++i) {
    const double root = std::sqrt(problem.edf(i) / 2) / mu(i);
    for (Eigen::Index a = 0; a < terms; ++a) {
      const double x = columns(i, a) * root;
      rhs(a) += x * (s(i) - problem.offset(i)) * root;
      for (Eigen::Index b = 0; b <= a; ++b) gram(a, b) += x * columns(i, b) * root;
    }
  }
  TermVector scale(terms);
  for (Eigen::Index a = 0; a < terms; ++a) {
    scale(a) = (used >> a & 1u) && gram(a, a) > 0 ? 1 / std::sqrt(gram(a, a)) : 0;
  }
  for (Eigen::Index a = 0; a < terms; ++a) {
    rhs(a) *= scale(a);
    for (Eigen::Index b = 0; b <= a; ++b) {
      gram(a, b) *= scale(a) * scale(b);
      gram(b, a) = gram(a, b);
    }
    if (scale(a) == 0) gram(a, a) = 1;  // its right side is 0, so it stays 0
  }
  TermVector weight = NonnegativeLeastSquares(gram, rhs);
  for (Eigen::Index a = 0; a < terms; ++a) weight(a) *= scale(a);
  return weight;
}

}  // namespace

TermVector NonnegativeLeastSquares(const TermMatrix& gram, const TermVector& rhs) {
  const Eigen::Index size = rhs.size();
  // Of a gradient over its right side: six products of doubles are rounded by 6 eps = 1.3e-15, and
  // each may be 75 times the right side that their sum cancels.
  constexpr double kTolerance = 1e-13;
  TermVector x = TermVector::Zero(size);
  unsigned free = 0;
  for (int round = 0; round < 3 * kFitTermsMax; ++round) {
    const TermVector gradient = rhs - gram * x;
    Eigen::Index best = -1;
    for (Eigen::Index i = 0; i < size; ++i) {
      const double least = kTolerance * std::abs(rhs(i));
      if (!(free >> i & 1u) && gradient(i) > least && (best < 0 || gradient(i) > gradient(best))) {
        best = i;
      }
    }
    if (best < 0) break;
    free |= 1u << best;
    TermVector trial = SolveFree(gram, rhs, free);
    while (true) {
      double step = 1;
      Eigen::Index blocking = -1;
      for (Eigen::Index i = 0; i < size; ++i) {
        if (!(free >> i & 1u) || trial(i) > 0) continue;
        const double reach = x(i) / (x(i) - trial(i));
        if (x(i) == 0 || reach < step) {
          step = x(i) == 0 ? 0 : reach;
          blocking = i;
        }
      }
      if (blocking < 0) break;
      x += step * (trial - x);
      x(blocking) = 0;
      free &= ~(1u << blocking);
      trial = SolveFree(gram, rhs, free);
    }
    x = trial;
  }
  return x;
}

namespace {

// Each reading levelled with its neighbours: a first model that one low reading cannot draw down.
Eigen::VectorXd Levelled(const Eigen::VectorXd& s, const Eigen::VectorXd& edf) {
  Eigen::VectorXd level(s.size());
  for (Eigen::Index i = 0; i < s.size(); ++i) {
    const Eigen::Index from = std::max<Eigen::Index>(0, i - 1);
    const Eigen::Index count = std::min(s.size(), i + 2) - from;
    level(i) =
        s.segment(from, count).dot(edf.segment(from, count)) / edf.segment(from, count).sum();
  }
  return level;
}

}  // namespace

WeightFit FitVariances(const VarianceProblem& problem, const Eigen::VectorXd& s, unsigned used) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const auto model = [&](const TermVector& weight) -> Eigen::VectorXd {
    return problem.offset + problem.columns * weight;
  };
  const auto deviance_of = [&](const Eigen::VectorXd& mu) {
    return mu.minCoeff() > 0 ? Deviance(mu, s, problem.edf) : kNever;
  };
  WeightFit fit;
  Eigen::VectorXd mu = Levelled(s, problem.edf);
  fit.weight = Reweighted(problem, s, mu, used);
  fit.deviance = deviance_of(model(fit.weight));
  if (fit.deviance < kNever) mu = model(fit.weight);
  for (int i = 0; i < 100; ++i) {
    TermVector next = Reweighted(problem, s, mu, used);
    Eigen::VectorXd mu_next = model(next);
    double deviance = deviance_of(mu_next);
    for (int halving = 0; halving < 30 && deviance > fit.deviance * (1 + 1e-14); ++halving) {
      next = (next + fit.weight) / 2;
      mu_next = model(next);
      deviance = deviance_of(mu_next);
    }
    if (!(deviance < fit.deviance)) break;
    const double gain = fit.deviance - deviance;
    fit.weight = next;
    fit.deviance = deviance;
    mu = mu_next;
    if (gain <= 1e-10 * (1 + deviance)) break;
  }
  return fit;
}

}  // namespace wellgyro
