#include <algorithm>
#include <cmath>

#include "wellgyro/fit/tool_model_internal.h"
#include "wellgyro/fit/tool_observability_internal.h"
#include "wellgyro/math/linear_algebra.h"

namespace wellgyro {
namespace {

/// Information of the readings about `terms` at none of them, its diagonal brought to one.
Eigen::MatrixXd CorrelationsOf(const ToolReadings& readings, const ToolFitSetup& setup,
                               const std::vector<ToolTerm>& terms) {
  const ToolModel model(readings, setup, terms);
  const Eigen::Index n = model.n_terms();
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(model.size());
  Eigen::MatrixXd N = Eigen::MatrixXd::Zero(n, n);
  for (const ToolRow& row : readings.rows) {
    // A rate table's large rates are read with more noise than the Earth's: 25 times kNoise is
    // 0.5 deg/h, of 10 deg/s 14 ppm, to which tables hold their rate.
    constexpr double kTable = 0.04;
    const Eigen::MatrixXd A = (row.mount >= 0 ? kTable : 1) * model.At(row, zero).J.leftCols(n);
    N += A.transpose() * A;
  }
  // Against the noise of a reading, as far as that is guessed [deg/h]: of four minutes at
  // 0.005 deg/sqrt(h).
  constexpr double kNoise = 0.02;
  for (Eigen::Index k = 0; k < n; ++k) {
    const double sigma = terms[static_cast<std::size_t>(k)].prior_sigma;
    if (sigma > 0) N(k, k) += kNoise * kNoise / (sigma * sigma);
  }
  const Eigen::VectorXd scale = N.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  return scale.asDiagonal() * N * scale.asDiagonal();
}

}  // namespace

std::vector<int> SeenBundles(const ToolReadings& readings, const ToolFitSetup& setup,
                             const std::vector<TermBundle>& bundles) {
  std::vector<ToolTerm> terms;
  for (const TermBundle& bundle : bundles) {
    terms.insert(terms.end(), bundle.terms.begin(), bundle.terms.end());
  }
  const Eigen::MatrixXd N = CorrelationsOf(readings, setup, terms);
  // Row by row of a Cholesky decomposition: what is left of a column beside those before it.
  // Of one that is an angle a off their plane it is sin^2 a: 3e-5 rad.
  constexpr double kTold = 1e-9;
  std::vector<int> seen;
  std::vector<Eigen::Index> kept;
  Eigen::Index first = 0;
  for (std::size_t b = 0; b < bundles.size(); ++b) {
    const auto size = static_cast<Eigen::Index>(bundles[b].terms.size());
    std::vector<Eigen::Index> with = kept;
    for (Eigen::Index k = 0; k < size; ++k) with.push_back(first + k);
    first += size;
    const bool has_base =
        bundles[b].after < 0 || std::find(seen.begin(), seen.end(), bundles[b].after) != seen.end();
    const Cholesky root(N(with, with));
    const bool told =
        root.positive() && root.L().diagonal().cwiseAbs2().tail(size).minCoeff() > kTold;
    if (!has_base || size == 0 || (!told && !bundles[b].needed)) continue;
    seen.push_back(static_cast<int>(b));
    kept = std::move(with);
  }
  return seen;
}

std::optional<Fault> UnseenNeeded(const ToolReadings& readings, const ToolFitSetup& setup,
                                  const std::vector<TermBundle>& bundles) {
  std::vector<ToolTerm> terms;
  std::vector<std::string> names;
  for (const TermBundle& bundle : bundles) {
    if (!bundle.needed) continue;
    for (const ToolTerm& term : bundle.terms) {
      if (term.prior_sigma > 0) continue;
      terms.push_back(term);
      names.push_back(term.name);
    }
  }
  const SymmetricEigen eigen = EigenOfSymmetric(CorrelationsOf(readings, setup, terms));
  // What stated attitudes see no better than the bench is level is seen by its tilt alone.
  if (eigen.values[0] > setup.sigma_level * setup.sigma_level) return std::nullopt;
  return Undetermined(names, eigen.vectors.col(0));
}

Fault Undetermined(const std::vector<std::string>& names, const Eigen::VectorXd& direction) {
  std::string text;
  for (Eigen::Index i = 0; i < direction.size(); ++i) {
    constexpr double kMuch = 0.25;  // of a unit vector: of 16 terms that share it alike
    if (std::abs(direction[i]) < kMuch) continue;
    text += (text.empty() ? "" : ", ") + names[static_cast<std::size_t>(i)];
  }
  return {.code = FaultCode::kRange,
          .text = "the readings do not tell apart " + text +
                  ": measure inclinations every 45 deg, four azimuths and toolfaces every 60 "
                  "deg, or join a rate table's readings; with few readings state their sigmas "
                  "(--sigma-deg-per-h, --sigma-accel, --wobble-arcsec)"};
}

}  // namespace wellgyro
