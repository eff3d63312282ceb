#include "wellgyro/plan/expected_end.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include <Eigen/Geometry>

#include "wellgyro/estimate/diagnosis.h"
#include "wellgyro/estimate/end_of_run.h"
#include "wellgyro/estimate/way_behind.h"
#include "wellgyro/plan/synthetic_run.h"
#include "wellgyro/survey/verdict/run_diagnosis.h"
#include "wellgyro/uncertainty/ellipse.h"

namespace wellgyro {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Regression of `kRows` sums of B_k phi_k on the unknowns that are left: y = by' [node; border] +
/// e, cov(e) = cov, carried on as the nodes before are eliminated.
template <int kRows>
class EliminatedSum {
 public:
  using Covariances = Eigen::Matrix<double, kRows, kRows>;

  /// Empty, and before node `first`.
  EliminatedSum(const LinearRun& run, std::size_t first)
      : run_(run),
        node_(first),
        by_(By::Zero(2 * run.layout().node + run.layout().border, kRows)) {}

  /// B of the node at hand.
  void Add(const Eigen::Matrix<double, kRows, 3>& B) {
    by_.template middleRows<3>(run_.layout().phi) += B.transpose();
  }
  /// To the next one.
  void Advance() {
    const int n = run_.layout().node;
    run_.elimination().Eliminate(node_++, by_);
    cov_ += by_.topRows(n).transpose() * by_.topRows(n);
    by_.topRows(n) = by_.middleRows(n, n).eval();
    by_.middleRows(n, n).setZero();
  }
  void AdvanceTo(std::size_t node) {
    while (node_ < node) Advance();
  }
  /// By the covariance of [node at hand; border].
  Covariances Covariance(const EdgeMatrix& of_edge) const {
    const Layout& layout = run_.layout();
    By by(layout.node + layout.border, kRows);
    by << by_.topRows(layout.node), by_.bottomRows(layout.border);
    const Covariances cov = cov_ + by.transpose() * of_edge * by;
    return 0.5 * (cov + cov.transpose());
  }

 private:
  using By = Eigen::Matrix<double, Eigen::Dynamic, kRows>;
  const LinearRun& run_;
  std::size_t node_;
  By by_;  ///< of [node at hand | next node | border]
  Covariances cov_ = Covariances::Zero();
};

/// What attitudes alone make of the end's covariance, of how it moves with every node's phi.
Matrix3d CovarianceOf(const LinearRun& run, std::span<const Matrix3d> by_phi) {
  EliminatedSum<3> sum(run, 0);
  for (std::size_t k = 0; k < by_phi.size(); ++k) {
    sum.AdvanceTo(k);
    sum.Add(by_phi[k]);
  }
  return sum.Covariance(run.elimination().LastCovariance());
}

std::size_t DeepestOf(std::span<const Node> nodes) {
  const auto deepest = std::max_element(nodes.begin(), nodes.end(),
                                        [](const Node& a, const Node& b) { return a.md < b.md; });
  return static_cast<std::size_t>(deepest - nodes.begin());
}

double SigmaAzimuth(const LinearRun& run, const SyntheticRun& rows) {
  const std::size_t deepest = DeepestOf(rows.nodes());
  // d azimuth = e . (phi x e3 in L), e across the hole over the sine of its inclination.
  const Matrix3d& R = rows.nodes()[deepest].R_LT;
  const Vector3d t = R.col(2);
  const double horizontal = std::max(std::hypot(t.x(), t.y()), 1e-6);
  const Vector3d across = Vector3d(-t.y(), t.x(), 0) / (horizontal * horizontal);
  EliminatedSum<1> sum(run, deepest);
  sum.Add((Vector3d::UnitZ().cross(R.transpose() * across)).transpose());
  sum.AdvanceTo(run.knots());
  return std::sqrt(std::max(0.0, sum.Covariance(run.elimination().LastCovariance()).value()));
}

/// The way to a node, regressed on it.
struct WayTo {
  std::size_t node = 0;
  WayBehind way;
};

/// At the first node past every `spacing` and at the deepest.
std::vector<WayTo> WaysAlong(const LinearRun& run, std::span<const Node> nodes, double spacing) {
  const Elimination& e = run.elimination();
  WayBehind way = WayFrom(run.layout(), nodes.front());
  std::vector<WayTo> ways;
  const std::size_t deepest = DeepestOf(nodes);
  double next = nodes.front().md + spacing;
  for (std::size_t k = 1; k <= deepest; ++k) {
    CarryWay(run.layout(), nodes[k - 1], nodes[k], e.Gain(k - 1), e.Remainder(k - 1), way);
    if (nodes[k].md < next && k < deepest) continue;
    ways.push_back({k, way});
    while (next <= nodes[k].md) next += spacing;
  }
  return ways;
}

void TakeFaults(const PlanCase& c, const LinearRun& run, const SyntheticRun& rows,
                std::span<const Matrix3d> end, ExpectedEnd& expected) {
  const EstimateSetup setup = SetupOfPlan(c);
  const Diagnosis tests = Diagnose(run, setup.causes, end, setup.false_alarm_rate);
  const RunDiagnosis diagnosis = DiagnosisOf(tests, rows.knots());
  expected.reliability = diagnosis.reliability;
  for (const RunReliability& fault : diagnosis.reliability) {
    if (!(fault.shift_W.head<2>().norm() > expected.hidden)) continue;
    expected.hidden = fault.shift_W.head<2>().norm();
    expected.hidden_cause = fault.code;
  }
}

}  // namespace

Matrix3d DepthCovariance(const PlanCase& c) {
  const TrajectoryPoint begin = c.well.AtMd(std::max(c.way.begin_md, c.well.md_begin()));
  const TrajectoryPoint end = c.well.AtMd(std::min(c.way.end_md, c.well.md_end()));
  const double scale = c.errors.depth_scale_sigma;
  const Vector3d path = scale * (end.position_W - begin.position_W);
  const Vector3d there = path - scale * (end.md - begin.md) * end.tangent_W;
  const Vector3d offset = c.errors.depth_sigma * begin.tangent_W;
  const Vector3d offset_there = offset - c.errors.depth_sigma * end.tangent_W;
  return path * path.transpose() + there * there.transpose() + offset * offset.transpose() +
         offset_there * offset_there.transpose();
}

ExpectedEnd ExpectEnd(const PlanCase& c, std::span<const PlannedStop> stops, bool with_faults) {
  SyntheticRun rows(c, stops, SetupOfPlan(c));
  ExpectedEnd expected;
  expected.seconds = rows.seconds();
  LinearRun run(rows);
  if (!run.Solve()) return expected;
  expected.solved = true;
  const std::vector<Matrix3d> end = EndByPhi(rows.nodes());
  expected.cov_p_WT_W = DepthCovariance(c) + CovarianceOf(run, end);
  const ErrorEllipse ellipse = HorizontalEllipse(expected.cov_p_WT_W, kConfidence);
  expected.semi_major = ellipse.semi_major;
  expected.semi_minor = ellipse.semi_minor;
  expected.azimuth_major = ellipse.azimuth_major;
  expected.sigma_azimuth = SigmaAzimuth(run, rows);
  if (with_faults) TakeFaults(c, run, rows, end, expected);
  return expected;
}

std::vector<ExpectedPlace> ExpectAlong(const PlanCase& c, std::span<const PlannedStop> stops,
                                       double spacing) {
  if (!(spacing > 0)) throw std::invalid_argument("ExpectAlong: a spacing must be positive");
  SyntheticRun rows(c, stops, SetupOfPlan(c));
  LinearRun run(rows);
  std::vector<ExpectedPlace> places;
  if (!run.Solve()) return places;
  const Elimination& elimination = run.elimination();
  std::vector<WayTo> ways = WaysAlong(run, rows.nodes(), spacing);
  EdgeMatrix cov = elimination.LastCovariance();
  PlanCase part = c;
  for (std::size_t k = run.knots(); !ways.empty(); --k) {
    if (k == ways.back().node) {
      const WayBehind& way = ways.back().way;
      part.way.end_md = rows.nodes()[k].md;
      places.push_back(
          {part.way.end_md, DepthCovariance(part) + way.cov_W + way.by * cov * way.by.transpose()});
      ways.pop_back();
    }
    if (ways.empty()) break;
    BehindMatrix with_next;
    cov = elimination.CovarianceBefore(k - 1, elimination.Gain(k - 1), cov, with_next);
  }
  std::reverse(places.begin(), places.end());
  return places;
}

}  // namespace wellgyro
