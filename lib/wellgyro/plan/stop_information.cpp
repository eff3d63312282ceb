#include "wellgyro/plan/stop_information.h"

#include <algorithm>
#include <cmath>

#include "wellgyro/estimate/end_of_run.h"
#include "wellgyro/plan/expected_end.h"
#include "wellgyro/plan/synthetic_run.h"

namespace wellgyro {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Kind = CauseSpec::Kind;

// Steps of the gyros are looked for at every node; some eighty onsets of a run do not look alike
// (50 to 100 on simulated runs of 900 spans).
constexpr double kOnsets = 80;
// [places], 120 m or more: what a step does to the end changes little from one to the next.
constexpr std::size_t kStepEvery = 4;

/// Whether column `at` of [node; border] is an error of the gyros' own, which turns with the tool.
bool IsOfGyros(const Layout& layout, int at) {
  const auto in = [at](int column, int count) { return at >= column && at < column + count; };
  if (layout.walk != kAbsent && in(layout.walk, 2)) return true;
  if (layout.markov != kAbsent && in(layout.markov, 2)) return true;
  for (const int border : {layout.source[kGyroBiasX], layout.source[kGyroBiasY]}) {
    if (border != kAbsent && in(layout.node + border, 1)) return true;
  }
  return layout.ramp != kAbsent && in(layout.node + layout.ramp, 2);
}

/// The kBasis rows over [node; border] of rest at `node`.
MatrixXd RestRows(SyntheticRun& rows, std::size_t node) {
  const Layout& layout = rows.layout();
  const int n = layout.node;
  const Factor f = rows.RestAt(node);
  MatrixXd A = MatrixXd::Zero(StopInformation::kBasis, n + layout.border);
  for (int j = 0; j < f.columns; ++j) {
    // The next node is this one: the tool does not move.
    int at = f.column[static_cast<std::size_t>(j)];
    if (at >= n) at -= n;
    if (at == layout.roll) continue;  // as the turn about the axis is, free
    A.block(IsOfGyros(layout, at) ? 2 : 0, at, 2, 1) += f.J.col(j).head<2>();
  }
  return A;
}

}  // namespace

/// Backwards through the run, with E[x y'] of the node at hand and all rows y met so far. These,
/// and the node's covariance, are worked out where they are read: what lies between is one
/// conditional, x = gain [x of the last one; border] + e.
class StopInformation::Sweep {
 public:
  Sweep(StopInformation& info, const PlanCase& c, std::span<const PlannedStop> marks,
        const InformationOptions& options)
      : info_(info),
        so_far_(options.so_far),
        rows_(so_far_ != nullptr ? SyntheticRun(c, marks, *so_far_, options.knots)
                                 : SyntheticRun(c, marks, SetupOfPlan(c), options.knots)),
        run_(rows_) {
    const EstimateSetup setup = SetupOfPlan(c);
    info_.ln_limit_ = std::log(static_cast<double>(setup.causes.size()) / setup.false_alarm_rate);
    for (std::size_t i = 0; i < info_.places(); ++i) {
      const Matrix3d& R = rows_.nodes()[rows_.stop_nodes()[i]].R_LT;
      info_.places_[i].toolface = std::atan2(R(2, 1), -R(2, 0));
    }
    info_.solved_ = run_.Solve();
    if (!info_.solved_) return;
    if (options.with_faults) {
      FindConstants(setup);
      FindSteps(setup);
    }
    const Index size = info_.place_row(info_.places());
    info_.covariance_ = MatrixXd::Zero(size, size);
    const Layout& layout = rows_.layout();
    known_ = MatrixXd::Zero(layout.node + layout.border, size);
    seen_.assign(static_cast<std::size_t>(size), false);
    met_ = size;
    FindEnd(c);
    Run();
  }

 private:
  void FindConstants(const EstimateSetup& setup) {
    for (const CauseSpec& cause : setup.causes) {
      if (cause.kind != Kind::kConstant) continue;
      const int at = BorderColumn(rows_.layout(), cause.unknown);
      if (at == kAbsent) continue;
      constants_.push_back(at);
      info_.faults_.push_back({rows_.layout().sigma[at], cause.size, 0});
    }
  }

  void FindSteps(const EstimateSetup& setup) {
    if (rows_.layout().walk == kAbsent) return;
    const auto step =
        std::find_if(setup.causes.begin(), setup.causes.end(), [](const CauseSpec& cause) {
          return cause.kind == Kind::kOnset && cause.unknown == kGyroBiasX;
        });
    if (step == setup.causes.end()) return;
    for (std::size_t i = 0; i < info_.places(); i += kStepEvery) {
      const std::size_t knot = rows_.stop_nodes()[i];
      if (knot >= rows_.size() || rows_.knots()[knot].still) continue;
      if (!step_knots_.empty() && step_knots_.back().first == knot) continue;
      step_knots_.emplace_back(knot, info_.faults_.size());
      const double unit =
          setup.gyro.rate_random_walk * std::sqrt(rows_.knots()[knot].increment.seconds);
      const HiddenFault fault{unit, step->size, std::log(kOnsets)};
      info_.faults_.insert(info_.faults_.end(), 2, fault);  // of either axis
    }
  }

  /// What the end is by phi of every node, see EndByPhi(); of a way that goes on, as WayBehind.
  std::vector<Matrix3d> ByPhi() const {
    if (so_far_ == nullptr) return EndByPhi(rows_.nodes());
    const std::span<const Node> nodes = rows_.nodes();
    std::vector<Matrix3d> end(nodes.size(), Matrix3d::Zero());
    double deepest = so_far_->state->way.deepest;
    for (std::size_t k = 0; k + 1 < nodes.size(); ++k) {
      const double half = 0.5 * Deepens(nodes[k].md, nodes[k + 1].md, deepest);
      end[k] += half * TangentByPhi(nodes[k].R_LT);
      end[k + 1] += half * TangentByPhi(nodes[k + 1].R_LT);
      deepest = std::max(deepest, nodes[k + 1].md);
    }
    return end;
  }

  void FindEnd(const PlanCase& c) {
    const Layout& layout = rows_.layout();
    for (const Matrix3d& b : ByPhi()) {
      MatrixXd node = MatrixXd::Zero(layout.node, 3);
      node.middleRows<3>(layout.phi) = b.transpose();
      end_.nodes.push_back(std::move(node));
    }
    end_.border = MatrixXd::Zero(layout.border, 3);
    Matrix3d cov = DepthCovariance(c);
    if (so_far_ != nullptr) {
      const WayBehind& way = so_far_->state->way;
      end_.nodes.front() += way.by.leftCols(layout.node).transpose();
      end_.border = way.by.rightCols(layout.border).transpose();
      cov += way.cov_W;
    }
    const LinearRun::Columns by = end_;
    run_.SolveFor(end_);
    for (std::size_t k = 0; k < by.nodes.size(); ++k) {
      cov += by.nodes[k].transpose() * end_.nodes[k];
    }
    cov += by.border.transpose() * end_.border;
    info_.covariance_.topLeftCorner<2, 2>() = cov.topLeftCorner<2, 2>();
  }

  void Run() {
    cov_ = run_.elimination().LastCovariance();
    ResetGain();
    AtNode(rows_.size());
    for (std::size_t k = rows_.size(); k-- > 0;) {
      const auto step = std::find_if(step_knots_.begin(), step_knots_.end(),
                                     [k](const auto& s) { return s.first == k; });
      if (step != step_knots_.end()) {
        AtStep(k, step->second);
      } else {
        Extend(k);
      }
      AtNode(k);
    }
    Bring();
    JoinConstants();
  }

  void ResetGain() {
    const Layout& layout = rows_.layout();
    gain_.setIdentity(layout.node, layout.node + layout.border);
    noise_.setZero(layout.node, layout.node);
    moved_ = false;
  }
  /// One node back: x_k by [node where known_ stands; border], as x_k is by the next one.
  void Extend(std::size_t k) {
    const Index n = rows_.layout().node, b = rows_.layout().border;
    const BehindMatrix gain = run_.elimination().Gain(k);
    const NodeMatrix by_next = gain.leftCols(n);
    BehindMatrix longer = by_next.lazyProduct(gain_);
    longer.rightCols(b) += gain.rightCols(b);
    gain_ = longer;
    const NodeMatrix through = by_next.lazyProduct(noise_);
    noise_ = run_.elimination().Remainder(k);
    noise_ += through.lazyProduct(by_next.transpose());
    moved_ = true;
  }
  /// What is known, at the node at hand.
  void Bring() {
    if (!moved_) return;
    ForMet([this](Index column, Index count) {
      known_.block(0, column, gain_.rows(), count) =
          (gain_ * known_.middleCols(column, count)).eval();
    });
    cov_ = Elimination::CovarianceThrough(gain_, noise_, cov_, with_last_);
    ResetGain();
  }
  /// Of what has been met: the columns of steps, and those of the places from the last one back.
  template <class F>
  void ForMet(const F& f) const {
    const Index first = info_.place_row(0);
    if (!step_knots_.empty()) f(info_.fault_row(0), first - info_.fault_row(0));
    f(met_, known_.cols() - met_);
  }

  /// Covariance of `row`s A x with the end and all columns met, then the rows themselves.
  void Join(const MatrixXd& A, std::size_t node, Index column) {
    MatrixXd& Z = info_.covariance_;
    const Index count = A.rows(), n = rows_.layout().node, b = rows_.layout().border;
    MatrixXd with(count, known_.cols());
    ForMet([&](Index at, Index width) {
      with.middleCols(at, width) = A * known_.middleCols(at, width);
    });
    const MatrixXd with_end =
        A.leftCols(n) * end_.nodes[node].leftCols<2>() + A.rightCols(b) * end_.border.leftCols<2>();
    Z.block(column, 0, count, 2) = with_end;
    Z.block(0, column, 2, count) = with_end.transpose();
    for (Index j = 2; j < Z.cols(); ++j) {
      if (!seen_[static_cast<std::size_t>(j)]) continue;
      Z.block(column, j, count, 1) = with.col(j);
      Z.block(j, column, 1, count) = with.col(j).transpose();
    }
    const MatrixXd cov_A = cov_ * A.transpose();
    Z.block(column, column, count, count) = A * cov_A;
    known_.middleCols(column, count) = cov_A;
    for (Index i = 0; i < count; ++i) seen_[static_cast<std::size_t>(column + i)] = true;
  }

  void AtNode(std::size_t node) {
    for (std::size_t i = 0; i < info_.places(); ++i) {
      if (rows_.stop_nodes()[i] != node) continue;
      Bring();
      Join(RestRows(rows_, node), node, info_.place_row(i));
      met_ = std::min(met_, info_.place_row(i));
    }
  }

  /// One node back over a knot in which a gyro may step: y = (walk at the knot's end - that at its
  /// begin) / unit, of both axes.
  void AtStep(std::size_t knot, std::size_t fault) {
    Bring();
    const MatrixXd later = known_;
    const EdgeMatrix next = cov_;
    Extend(knot);
    Bring();
    const EdgeMatrix& here = cov_;
    const BehindMatrix& with_next = with_last_;
    const Index n = rows_.layout().node, b = rows_.layout().border;
    MatrixXd& Z = info_.covariance_;
    for (int axis = 0; axis < 2; ++axis) {
      const std::size_t i = fault + static_cast<std::size_t>(axis);
      const Index w = rows_.layout().walk + axis, column = info_.fault_row(i);
      const double unit = info_.faults_[i].unit;
      Eigen::RowVectorXd with = (later.row(w) - known_.row(w)) / unit;
      with.head(2) = (end_.nodes[knot + 1].row(w) - end_.nodes[knot].row(w)).head(2) / unit;
      for (Index j = 0; j < Z.cols(); ++j) {
        if (j >= 2 && (!seen_[static_cast<std::size_t>(j)] || j < info_.place_row(0))) continue;
        Z(column, j) = Z(j, column) = with[j];
      }
      Z(column, column) = (next(w, w) + here(w, w) - 2 * with_next(w, w)) / (unit * unit);
      known_.col(column).head(n) = (with_next.col(w) - here.col(w).head(n)) / unit;
      known_.col(column).tail(b) = (next.col(w) - here.col(w)).tail(b) / unit;
      seen_[static_cast<std::size_t>(column)] = true;
    }
  }

  void JoinConstants() {
    const Index n = rows_.layout().node;
    MatrixXd& Z = info_.covariance_;
    for (std::size_t i = 0; i < constants_.size(); ++i) {
      const Index column = info_.fault_row(i), at = n + constants_[i];
      const double unit = info_.faults_[i].unit;
      Eigen::RowVectorXd with = known_.row(at) / unit;
      with.head(2) = end_.border.row(constants_[i]).head(2) / unit;
      for (Index j = 0; j < Z.cols(); ++j) {
        if (j >= 2 && j < info_.place_row(0)) continue;
        Z(column, j) = Z(j, column) = with[j];
      }
      Z(column, column) = cov_(at, at) / (unit * unit);
    }
  }

  StopInformation& info_;
  const RunSoFar* so_far_;
  SyntheticRun rows_;
  LinearRun run_;
  std::vector<int> constants_;  ///< border columns of the first faults
  std::vector<std::pair<std::size_t, std::size_t>> step_knots_;  ///< and the first of two faults
  LinearRun::Columns end_;                                       ///< N^-1 of the end's columns
  MatrixXd known_;  ///< [node; border] with every column of the covariance
  std::vector<bool> seen_;
  Index met_ = 0;           ///< the first column of a place that has been met
  EdgeMatrix cov_;          ///< of [node; border], where known_ stands
  BehindMatrix with_last_;  ///< E[x (x; border)'] of that node with where it stood before
  BehindMatrix gain_;
  NodeMatrix noise_;
  bool moved_ = false;
};

StopInformation::StopInformation(const PlanCase& c, std::span<const StopPlace> places,
                                 const InformationOptions& options)
    : places_(places.begin(), places.end()) {
  std::vector<PlannedStop> marks;
  for (const StopPlace& place : places_) marks.push_back({place.out, place.md, 0, {}});
  const Sweep sweep(*this, c, marks, options);
}

Eigen::Matrix<double, 2, StopInformation::kBasis> StopInformation::Mix(double turn) {
  Eigen::Matrix<double, 2, kBasis> mix;
  const double c = std::cos(turn), s = std::sin(turn);
  mix << 1, 0, c, -s, 0, 1, s, c;
  return mix;
}

std::vector<StopPlace> PlacesEvery(const PlannedWay& way, double spacing) {
  const double length = way.end_md - way.begin_md;
  const int count = std::max(1, static_cast<int>(std::lround(length / spacing)));
  std::vector<StopPlace> places;
  for (int i = 0; i <= count; ++i) {
    places.push_back({false, way.begin_md + length * i / count});
  }
  for (int i = count - 1; way.speed_out > 0 && i >= 0; --i) {
    places.push_back({true, way.begin_md + length * i / count});
  }
  return places;
}

}  // namespace wellgyro
