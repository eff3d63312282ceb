#pragma once

#include <vector>

#include <Eigen/Core>

#include "wellgyro/fit/bench_plan.h"

namespace wellgyro {

/// What readings at settings tell of the parameters, and what these do to the hole's azimuths.
struct BenchDesign {
  Eigen::MatrixXd rows;    ///< two for each candidate: readings by parameters, over their sigma
  Eigen::MatrixXd hole;    ///< one for each attitude of the hole: azimuth by parameters [rad]
  Eigen::MatrixXd before;  ///< information before any setting
};

BenchDesign DesignOf(const std::vector<BenchSetting>& candidates, const BenchPlanSetup& setup);

/// Variances of the azimuths of `hole` [rad^2].
Eigen::VectorXd AzimuthVariances(const Eigen::MatrixXd& hole, const Eigen::MatrixXd& cov);

/// The design of continuous weights that reaches a variance, and its bound.
struct DesignWeights {
  Eigen::VectorXd weights;  ///< of the candidates, in readings
  double fewest = 0;        ///< no weights of a smaller sum reach the variance
};

/// Weights w whose azimuths' largest variance (or their mean) is `variance`.
///
/// With M(w) = before + sum w x' x, C = M^-1 and weights mu of the hole's attitudes, sum 1, W =
/// sum mu g g', let phi = tr C W and d(x) = tr x C W C x'. For any other design M', by Cauchy and
/// Schwarz, tr M'^-1 W >= phi^2 / tr(M' C W C), and no mean of variances is above the largest: to
/// reach a variance v takes a sum of at least (phi^2 / v - tr(before C W C)) / max d. At the
/// optimum the two are alike (the equivalence theorem). w is multiplied by sqrt(d) (Silvey,
/// Titterington and Torsney 1978), mu towards the attitudes of large variance.
DesignWeights OptimalWeights(const BenchDesign& design, double variance, bool largest);

}  // namespace wellgyro
