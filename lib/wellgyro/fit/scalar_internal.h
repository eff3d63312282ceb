#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/result.h"
#include "wellgyro/calibration/bench_table.h"
#include "wellgyro/fit/attitude_table_internal.h"
#include "wellgyro/fit/nonlinear_internal.h"

namespace wellgyro {

/// Vectors of one length: v and, of a reading, sigma.
struct ScalarReadings {
  std::vector<int> lines;
  Eigen::MatrixX3d v;
  double length = 1;
  std::optional<double> sigma;  ///< of a reading [unit of v]
};

/// |M (v - b)| = length. Parameters: M (6, lower triangle by rows), b (3).
Result<NonlinearProblem::Solution> SolveScalar(const ScalarReadings& readings);

/// Bad rows of a table of vectors that should have one length.
std::optional<Fault> BadVectors(const BenchTable& data, const Eigen::MatrixX3d& v,
                                const std::vector<std::string>& channels, std::string_view units);

/// Readings that lie on a second quadric as closely as on the ellipsoid: what only noise
/// determines.
std::optional<Fault> OnlyCones(const BenchTable& data, const ScalarReadings& readings,
                               const std::vector<int>& outlier_lines);

/// Readings v = sensitivity u in m/s2 where gravity is given in g, or the other way round.
std::optional<Fault> OtherUnit(const BenchTable& data, const std::vector<std::string>& channels,
                               const Eigen::Matrix3d& sensitivity, const BenchReference& reference);

}  // namespace wellgyro
