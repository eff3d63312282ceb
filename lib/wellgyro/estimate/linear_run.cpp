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

void RunRows::BlockOf(std::size_t k, NormalBlock& block) {
  std::vector<Factor> rows;
  RowsOf(k, rows);
  block.Clear(layout());
  for (const Factor& f : rows) block.Add(f);
}

LinearRun::LinearRun(RunRows& rows) : rows_(rows), elimination_(rows.layout()) {}

bool LinearRun::Solve() {
  EdgeMatrix information;
  rows_.FirstRows(information, first_gradient_);
  elimination_.Start(knots(), information, first_gradient_);
  NormalBlock block;
  for (std::size_t k = 0; k < knots(); ++k) {
    BlockOf(k, block);
    if (!elimination_.Step(block)) return false;
  }
  return elimination_.Solve(step_, border_step_);
}

void LinearRun::RowsOf(std::size_t k, std::vector<Factor>& rows) const {
  rows.clear();
  rows_.RowsOf(k, rows);
  Weigh(rows);
  const NormalBlock::Vector step = StepOf(k);
  for (Factor& f : rows) {
    for (int j = 0; j < f.columns; ++j) {
      f.r.head(f.rows) += step[f.column[static_cast<std::size_t>(j)]] * f.J.col(j).head(f.rows);
    }
  }
}

void LinearRun::BlockOf(std::size_t k, NormalBlock& block) const {
  block.WithoutLoss(true);
  rows_.BlockOf(k, block);
}

NormalBlock::Vector LinearRun::StepOf(std::size_t k) const {
  NormalBlock::Vector step(2 * layout().node + layout().border);
  step << step_[k], step_[k + 1], border_step_;
  return step;
}

double LinearRun::PriorScore(int i) const {
  return first_gradient_[layout().node + i] + layout().information.col(i).dot(border_step_);
}

void LinearRun::SolveFor(Columns& columns) const {
  const int n = layout().node, b = layout().border;
  Eigen::MatrixXd x(2 * n + b, columns.border.cols());
  x.bottomRows(b) = columns.border;
  x.topRows(n) = columns.nodes[0];
  for (std::size_t k = 0; k < knots(); ++k) {
    x.middleRows(n, n) = columns.nodes[k + 1];
    elimination_.Eliminate(k, x);
    columns.nodes[k] = x.topRows(n);
    x.topRows(n) = x.middleRows(n, n).eval();
  }
  Eigen::MatrixXd last(n + b, x.cols());
  last << x.topRows(n), x.bottomRows(b);
  last = (elimination_.LastCovariance() * last).eval();
  columns.nodes.back() = last.topRows(n);
  columns.border = x.bottomRows(b) = last.bottomRows(b);
  for (std::size_t k = knots(); k-- > 0;) {
    x.middleRows(n, n) = columns.nodes[k + 1];
    x.topRows(n) = columns.nodes[k];
    elimination_.Substitute(k, x);
    columns.nodes[k] = x.topRows(n);
  }
}

}  // namespace wellgyro
