#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/SparseCore>

#include "wellgyro/attitude/filter.h"
#include "wellgyro/fit/adjust_layout_internal.h"
#include "wellgyro/fit/adjust_span_internal.h"
#include "wellgyro/record/run_fit.h"

namespace wellgyro {

/// A run's adjustment as a whole: nodes at the ends of the spans, and what ties them.
struct AdjustProblem {
  const FilterHistory* history = nullptr;
  AdjustLayout layout;
  std::vector<AdjustSpan> spans;
  /// Pairs of nodes at one depth.
  struct Repeat {
    std::size_t first, second;
    double sigma_azimuth, sigma_inclination, sine;
  };
  std::vector<Repeat> repeats;
  /// Azimuth at the end of an epoch that ends a span, as if measured.
  struct Hold {
    std::size_t epoch;
    double azimuth, sigma;
  };
  std::vector<Hold> holds;
  double huber = 4;  ///< residuals beyond so many sigma count less

  // The unknowns.
  std::vector<double> nodes;   ///< layout.node each, one more than spans
  std::vector<double> common;  ///< layout.common

  std::size_t node_count() const { return spans.size() + 1; }
  double* node(std::size_t k) { return &nodes[k * static_cast<std::size_t>(layout.node)]; }
  const double* node(std::size_t k) const {
    return &nodes[k * static_cast<std::size_t>(layout.node)];
  }
  double azimuth(std::size_t k) const { return node(k)[AdjustLayout::kAzimuth]; }
};

/// Every residual where the unknowns stand, as the loss counts it.
struct AdjustRows {
  /// By nodes first, the common unknowns last.
  Eigen::SparseMatrix<double, Eigen::RowMajor> jacobian;
  std::vector<double> residual;
  std::vector<RunFit::Part> part;  ///< kParts: none of them
};

struct AdjustOutcome {
  double chi_square = 0;  ///< sum of the squared residuals, as the loss counts them
  int residuals = 0;
  int iterations = 0;
  bool converged = false;
};

/// Starts every unknown from the azimuth of each node and the tracker's inclination.
void StartFrom(const std::vector<double>& azimuths, AdjustProblem* problem);

/// Least squares from where the unknowns stand. With `rows`, also all residuals there.
AdjustOutcome Solve(AdjustProblem* problem, AdjustRows* rows);

}  // namespace wellgyro
