#include "wellgyro/estimate/onset_scan.h"

namespace wellgyro {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

}  // namespace

Vector3d ColumnOf(const Factor& f, const Layout& layout, int i) {
  Vector3d c = Vector3d::Zero();
  for (int j = 0; j < f.columns; ++j) {
    if (f.column[static_cast<std::size_t>(j)] == 2 * layout.node + i) {
      c.head(f.rows) += f.J.col(j).head(f.rows);
    }
  }
  return c;
}

EndInfluence::EndInfluence(const LinearRun& run, std::span<const Eigen::Matrix3d> end_by_phi_W)
    : layout_(run.layout()) {
  solved_.border = Eigen::MatrixXd::Zero(layout_.border, 3);
  for (const Eigen::Matrix3d& slope : end_by_phi_W) {
    Eigen::MatrixXd& node = solved_.nodes.emplace_back(Eigen::MatrixXd::Zero(layout_.node, 3));
    node.middleRows<3>(layout_.phi) = slope.transpose();
  }
  run.SolveFor(solved_);
}

Eigen::Matrix3d EndInfluence::Of(std::size_t knot, const Factor& f) const {
  const int n = layout_.node;
  Eigen::Matrix3d influence = Eigen::Matrix3d::Zero();  // a column a row of the factor
  for (int j = 0; j < f.columns; ++j) {
    const int at = f.column[static_cast<std::size_t>(j)];
    const Vector3d x = at < n       ? solved_.nodes[knot].row(at)
                       : at < 2 * n ? solved_.nodes[knot + 1].row(at - n)
                                    : solved_.border.row(at - 2 * n);
    for (int i = 0; i < f.rows; ++i) influence.col(i) += f.J(i, j) * x;
  }
  return influence;
}

Vector3d EndInfluence::Of(std::size_t knot, const NormalBlock::Vector& x) const {
  const int n = layout_.node, b = layout_.border;
  return solved_.nodes[knot].transpose() * x.head(n) +
         solved_.nodes[knot + 1].transpose() * x.segment(n, n) +
         solved_.border.transpose() * x.tail(b);
}

OnsetScan::OnsetScan(const LinearRun& run, std::vector<int> unknowns)
    : run_(run), unknowns_(std::move(unknowns)), now_(unknowns_.size()) {
  const Layout& layout = run.layout();
  edge_.setZero(layout.node + layout.border, static_cast<Index>(unknowns_.size()));
  for (std::size_t i = 0; i < unknowns_.size(); ++i) {
    const int at = unknowns_[i];
    edge_.col(static_cast<Index>(i)).tail(layout.border) = layout.information.col(at);
    now_[i].score = run.PriorScore(at);
    now_[i].information = layout.information(at, at);
  }
}

/// Keeps the scores of onsets at this node, their information still without edge' cov edge, which
/// Backward() takes off.
void OnsetScan::Record() {
  edges_.push_back(edge_);
  scores_.push_back(now_);
}

void OnsetScan::Forward(std::size_t knot, const NormalBlock& rows, const EndInfluence& influence) {
  const int n = run_.layout().node, b = run_.layout().border;
  if (unknowns_.empty()) return;
  if (knot == 0) {
    for (std::size_t i = 0; i < unknowns_.size(); ++i) {
      now_[i].shift_W = -influence.OfPrior(unknowns_[i]);
    }
    Record();
  }
  work_.setZero(2 * n + b, edge_.cols());
  work_.topRows(n) = edge_.topRows(n);
  work_.bottomRows(b) = edge_.bottomRows(b);
  const NormalBlock::Vector step = run_.StepOf(knot);
  for (std::size_t i = 0; i < unknowns_.size(); ++i) {
    const int at = rows.border() + unknowns_[i];
    const NormalBlock::Vector column = rows.Column(at);
    now_[i].score += rows.gradient()[at] + column.dot(step);
    now_[i].information += column[at];
    now_[i].shift_W -= influence.Of(knot, column);
    work_.col(static_cast<Index>(i)) += column;
  }
  run_.elimination().Eliminate(knot, work_);
  for (std::size_t i = 0; i < unknowns_.size(); ++i) {
    now_[i].information -= work_.col(static_cast<Index>(i)).head(n).squaredNorm();
  }
  edge_ = work_.bottomRows(n + b);
  Record();
}

void OnsetScan::Backward(std::size_t node, const EdgeMatrix& covariance) {
  if (unknowns_.empty()) return;
  const Eigen::MatrixXd& edge = edges_[node];
  const Eigen::MatrixXd solved = covariance * edge;
  for (std::size_t i = 0; i < unknowns_.size(); ++i) {
    const auto at = static_cast<Index>(i);
    scores_[node][i].information -= edge.col(at).dot(solved.col(at));
  }
}

}  // namespace wellgyro
