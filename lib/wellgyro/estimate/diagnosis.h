#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/estimate/cause.h"
#include "wellgyro/estimate/linear_run.h"

namespace wellgyro {

/// What a run's rows say of one cause.
struct CauseTest {
  bool tested = false;  ///< false: nothing in the run can tell it
  /// Somewhere the largest fault there is moves the rows by a sigma. Where it does not, its column
  /// is mostly noise, which looks like the fault: there are no size and no evidence then.
  bool told = false;
  double ln_bayes = 0;   ///< ln of its Bayes factor against no fault, onset and size integrated out
  std::size_t node = 0;  ///< the likeliest onset
  int row = 0;           ///< there, of what compares one thing by several rows
  double size = 0;       ///< found there
  double sigma = 0;      ///< of that
  /// What such a fault does to the end of the run: as found less as it is [m].
  Eigen::Vector3d shift_W = Eigen::Vector3d::Zero();
  /// External reliability (Baarda): the smallest size that the test detects with power 80 %, and
  /// how far it shifts the end, at the onset where the shift is largest. `noticeable` false: even
  /// five times the spec's size has less power, and the shift is that of five times.
  bool noticeable = false;
  double smallest = 0;
  std::size_t smallest_node = 0;
  Eigen::Vector3d hidden_W = Eigen::Vector3d::Zero();
};

/// Knots of a second that are looked at as one: two rows each tell a variance to
/// sqrt(2 / 40) = 22 %, and a
/// disturbance of some twenty seconds shows in few of them.
inline constexpr std::size_t kStretchKnots = 20;

/// Squares of whitened residuals, each over its own variance, and how many they are.
struct ResidualSum {
  double squares = 0, count = 0;
};

/// Which fault explains a run.
struct Diagnosis {
  bool done = false;
  /// ln of the odds of some cause against none, were both as likely before: the mean of the Bayes
  /// factors. Without fault it exceeds ln(1/a) in at most a share a of runs (Markov).
  double ln_odds = 0;
  /// The same of the causes of another kind once the likeliest is taken out, see RowsWithout: of
  /// something else beside it. 0 where the odds pass no limit, and of a likeliest that has no size.
  double ln_odds_without_first = 0;
  std::optional<std::size_t> first;   ///< the spec that was taken out
  std::optional<std::size_t> second;  ///< the likeliest beside it
  std::vector<CauseTest> tests;       ///< of each spec
  /// Of every stretch of kStretchKnots, of the gyros' and of the accelerometers' rows.
  std::vector<ResidualSum> turns, forces;
  /// Correlation of the signatures of constants and onsets, each at its likeliest node; 0 of
  /// others.
  Eigen::MatrixXd alike;
};

/// Tests every cause from one factorisation of the run's rows, by the algebra of linear models:
/// score s = c'P r, information M = c'P c, size s / M, Bayes factor
/// ln B = s^2 / (2 (M + 1/S^2)) - ln(1 + S^2 M) / 2 with size ~ N(0, S^2); over onsets the mean.
/// P J = 0, so that c and c + J v have the same score and information for every v: the column of a
/// constant beyond its prior reduces to its prior's row, that of a step at node t to that row and
/// the columns of the knots before t. One forward pass then serves all onsets.
/// Baarda (1968); de Jong and Penzer, "Diagnosing shocks in time series", JASA 93 (1998).
/// `end_by_phi_W`: derivative of the end by every node's phi [m]; `end_by_depth_scale_W`: what an
/// error of the depth's scale moves it by beside that. `false_alarm_rate`: of `ln_odds` above which
/// a fault is taken as noticed. Time and memory are proportional to the knots.
WELLGYRO_EXPORT Diagnosis Diagnose(
    RunRows& rows, std::span<const CauseSpec> specs, std::span<const Eigen::Matrix3d> end_by_phi_W,
    double false_alarm_rate, const Eigen::Vector3d& end_by_depth_scale_W = Eigen::Vector3d::Zero());
/// The same of a run that has been solved.
Diagnosis Diagnose(const LinearRun& solved, std::span<const CauseSpec> specs,
                   std::span<const Eigen::Matrix3d> end_by_phi_W, double false_alarm_rate,
                   const Eigen::Vector3d& end_by_depth_scale_W = Eigen::Vector3d::Zero());

}  // namespace wellgyro
