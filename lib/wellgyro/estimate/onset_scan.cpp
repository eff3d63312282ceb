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

void AddTransposed(const Factor& f, const Vector3d& c, Eigen::Ref<Eigen::VectorXd> sum) {
  for (int j = 0; j < f.columns; ++j) {
    sum[f.column[static_cast<std::size_t>(j)]] += f.J.col(j).head(f.rows).dot(c.head(f.rows));
  }
}

EndInfluence::EndInfluence(const LinearRun& run, std::span<const Eigen::Matrix3d> end_by_phi)
    : layout_(run.layout()) {
  solved_.border = Eigen::MatrixXd::Zero(layout_.border, 3);
  for (const Eigen::Matrix3d& slope : end_by_phi) {
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

OnsetScan::OnsetScan(const LinearRun& run, std::vector<int> unknowns)
    : run_(run), unknowns_(std::move(unknowns)), now_(unknowns_.size()) {
  const Layout& layout = run.layout();
  edge_.setZero(layout.node + layout.border, static_cast<Index>(unknowns_.size()));
  for (std::size_t i = 0; i < unknowns_.size(); ++i) {
    const double sigma = layout.sigma[unknowns_[i]];
    edge_(layout.node + unknowns_[i], static_cast<Index>(i)) = 1 / (sigma * sigma);
    now_[i].score = run.PriorResidual(unknowns_[i]) / sigma;
    now_[i].information = 1 / (sigma * sigma);
  }
}

/// The part of M that is known before node t's covariance is.
void OnsetScan::Record() {
  edges_.push_back(edge_);
  scores_.push_back(now_);
}

void OnsetScan::Forward(std::size_t knot, std::span<const Factor> rows,
                        const EndInfluence& influence) {
  const int n = run_.layout().node, b = run_.layout().border;
  if (unknowns_.empty()) return;
  if (knot == 0) {
    for (std::size_t i = 0; i < unknowns_.size(); ++i) {
      const double sigma = run_.layout().sigma[unknowns_[i]];
      now_[i].shift = -influence.OfBorder(unknowns_[i]) / (sigma * sigma);
    }
    Record();
  }
  Eigen::MatrixXd block = Eigen::MatrixXd::Zero(2 * n + b, edge_.cols());
  block.topRows(n) = edge_.topRows(n);
  block.bottomRows(b) = edge_.bottomRows(b);
  for (const Factor& f : rows) {
    Eigen::Matrix3d moved = Eigen::Matrix3d::Zero();
    bool known = false;
    for (std::size_t i = 0; i < unknowns_.size(); ++i) {
      const Vector3d c = ColumnOf(f, run_.layout(), unknowns_[i]);
      if (c.isZero(0)) continue;
      if (!known) moved = influence.Of(knot, f);
      known = true;
      now_[i].score += c.head(f.rows).dot(f.r.head(f.rows));
      now_[i].information += c.squaredNorm();
      now_[i].shift -= moved * c;
      AddTransposed(f, c, block.col(static_cast<Index>(i)));
    }
  }
  const Eigen::MatrixXd node = block.topRows(n);
  const Eigen::MatrixXd solved = run_.elimination().Remainder(knot) * node;
  for (std::size_t i = 0; i < unknowns_.size(); ++i) {
    const auto at = static_cast<Index>(i);
    now_[i].information -= node.col(at).dot(solved.col(at));
  }
  edge_ = block.bottomRows(n + b) + run_.elimination().Gain(knot).transpose() * node;
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
