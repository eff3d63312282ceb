#include "wellgyro/plan/expected_end.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include <Eigen/Geometry>

#include "wellgyro/estimate/diagnosis.h"
#include "wellgyro/estimate/end_of_run.h"
#include "wellgyro/plan/synthetic_run.h"
#include "wellgyro/survey/run_diagnosis.h"
#include "wellgyro/uncertainty/ellipse.h"

namespace wellgyro {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// What attitudes alone make of a place's covariance, of how it moves with every node's phi.
Matrix3d CovarianceOf(const LinearRun& run, std::span<const Matrix3d> by_phi) {
  LinearRun::Columns columns;
  const Layout& layout = run.layout();
  for (const Matrix3d& of_node : by_phi) {
    Eigen::MatrixXd node = Eigen::MatrixXd::Zero(layout.node, 3);
    node.middleRows<3>(layout.phi) = of_node.transpose();
    columns.nodes.push_back(std::move(node));
  }
  columns.border = Eigen::MatrixXd::Zero(layout.border, 3);
  run.SolveFor(columns);
  Matrix3d cov = Matrix3d::Zero();
  for (std::size_t k = 0; k < by_phi.size(); ++k) {
    cov += by_phi[k] * columns.nodes[k].middleRows<3>(layout.phi);
  }
  return 0.5 * (cov + cov.transpose());
}

std::size_t DeepestOf(std::span<const Node> nodes) {
  const auto deepest = std::max_element(nodes.begin(), nodes.end(),
                                        [](const Node& a, const Node& b) { return a.md < b.md; });
  return static_cast<std::size_t>(deepest - nodes.begin());
}

double SigmaAzimuth(const LinearRun& run, const SyntheticRun& rows) {
  const std::size_t at = DeepestOf(rows.nodes());
  LinearRun::Columns columns;
  const Layout& layout = run.layout();
  columns.nodes.assign(rows.nodes().size(), Eigen::MatrixXd::Zero(layout.node, 1));
  columns.border = Eigen::MatrixXd::Zero(layout.border, 1);
  // d azimuth = e . (phi x e3 in L), e across the hole over the sine of its inclination.
  const Matrix3d& R = rows.nodes()[at].R_LT;
  const Vector3d t = R.col(2);
  const double horizontal = std::max(std::hypot(t.x(), t.y()), 1e-6);
  const Vector3d across = Vector3d(-t.y(), t.x(), 0) / (horizontal * horizontal);
  const Vector3d by_phi = (R.transpose() * across).cross(Vector3d::UnitZ()) * -1;
  columns.nodes[at].middleRows<3>(layout.phi) = by_phi;
  run.SolveFor(columns);
  return std::sqrt(std::max(0.0, columns.nodes[at].col(0).segment<3>(layout.phi).dot(by_phi)));
}

void TakeFaults(const PlanCase& c, SyntheticRun& rows, std::span<const Matrix3d> end,
                ExpectedEnd& expected) {
  const EstimateSetup setup = SetupOfPlan(c);
  const Diagnosis tests = Diagnose(rows, setup.causes, end, setup.false_alarm_rate);
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
  const Vector3d path = scale * (end.position - begin.position);
  const Vector3d there = path - scale * (end.md - begin.md) * end.tangent;
  const Vector3d offset = c.errors.depth_sigma * begin.tangent;
  const Vector3d offset_there = offset - c.errors.depth_sigma * end.tangent;
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
  const ErrorEllipse ellipse = HorizontalEllipse(expected.cov_p_WT_W, 0.95);
  expected.semi_major = ellipse.semi_major;
  expected.semi_minor = ellipse.semi_minor;
  expected.azimuth_major = ellipse.azimuth_major;
  expected.sigma_azimuth = SigmaAzimuth(run, rows);
  if (with_faults) TakeFaults(c, rows, end, expected);
  return expected;
}

std::vector<ExpectedPlace> ExpectAlong(const PlanCase& c, std::span<const PlannedStop> stops,
                                       double spacing) {
  if (!(spacing > 0)) throw std::invalid_argument("ExpectAlong: a spacing must be positive");
  SyntheticRun rows(c, stops, SetupOfPlan(c));
  LinearRun run(rows);
  std::vector<ExpectedPlace> places;
  if (!run.Solve()) return places;
  const std::size_t nodes = rows.nodes().size(), deepest = DeepestOf(rows.nodes());
  PlanCase part = c;
  double next = c.way.begin_md + spacing;
  for (std::size_t k = 1; k <= deepest; ++k) {
    const double md = rows.nodes()[k].md;
    if (md < next && k < deepest) continue;
    std::vector<Matrix3d> by_phi = EndByPhi(rows.nodes().first(k + 1));
    by_phi.resize(nodes, Matrix3d::Zero());
    part.way.end_md = md;
    places.push_back({md, DepthCovariance(part) + CovarianceOf(run, by_phi)});
    while (next <= md) next += spacing;
  }
  return places;
}

}  // namespace wellgyro
