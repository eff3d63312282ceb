#include "wellgyro/estimate/linear_run.h"

#include <cmath>

namespace wellgyro {
namespace {

/// The roll's rows with the weights of their model.
void Weigh(std::vector<Factor>& rows) {
  for (Factor& f : rows) {
    if (f.kind != RowKind::kRoll) continue;
    const double weight = f.held > 0 ? f.held : RollWeight(f.r.head(f.rows).squaredNorm(), f.rows);
    f.J.leftCols(f.columns) *= std::sqrt(weight);
    f.r *= std::sqrt(weight);
  }
}

}  // namespace

LinearRun::LinearRun(RunRows& rows) : rows_(rows), elimination_(rows.layout()) {}

bool LinearRun::Solve() {
  EdgeMatrix information;
  rows_.FirstRows(information, first_gradient_);
  elimination_.Start(knots(), information, first_gradient_);
  NormalBlock block;
  std::vector<Factor> rows;
  for (std::size_t k = 0; k < knots(); ++k) {
    rows.clear();
    rows_.RowsOf(k, rows);
    Weigh(rows);
    block.Clear(layout());
    for (Factor& f : rows) {
      f.kind = RowKind::kPrior;  // the kind that no loss is for
      block.Add(f);
    }
    if (!elimination_.Step(block)) return false;
  }
  return elimination_.Solve(step_, border_step_);
}

void LinearRun::RowsOf(std::size_t k, std::vector<Factor>& rows) const {
  rows.clear();
  rows_.RowsOf(k, rows);
  Weigh(rows);
  const int n = layout().node;
  Eigen::VectorXd step(2 * n + layout().border);
  step << step_[k], step_[k + 1], border_step_;
  for (Factor& f : rows) {
    for (int j = 0; j < f.columns; ++j) {
      f.r.head(f.rows) += step[f.column[static_cast<std::size_t>(j)]] * f.J.col(j).head(f.rows);
    }
  }
}

double LinearRun::PriorResidual(int i) const {
  const double sigma = layout().sigma[i];
  return first_gradient_[layout().node + i] * sigma + border_step_[i] / sigma;
}

void LinearRun::SolveFor(Columns& columns) const {
  const int n = layout().node, b = layout().border;
  const Eigen::Index q = columns.border.cols();
  Eigen::MatrixXd edge(n + b, q), next(n + b, q);
  edge << columns.nodes[0], columns.border;
  for (std::size_t k = 0; k < knots(); ++k) {
    columns.nodes[k] = edge.topRows(n);
    next.noalias() = elimination_.Gain(k).transpose() * columns.nodes[k];
    next.topRows(n) += columns.nodes[k + 1];
    next.bottomRows(b) += edge.bottomRows(b);
    edge.swap(next);
  }
  Eigen::MatrixXd behind = elimination_.LastCovariance() * edge;
  columns.nodes.back() = behind.topRows(n);
  columns.border = behind.bottomRows(b);
  for (std::size_t k = knots(); k-- > 0;) {
    const Eigen::MatrixXd here =
        elimination_.Gain(k) * behind + elimination_.Remainder(k) * columns.nodes[k];
    columns.nodes[k] = here;
    behind.topRows(n) = here;
  }
}

}  // namespace wellgyro
