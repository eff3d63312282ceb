#include "wellgyro/estimate/north_closure.h"

#include <algorithm>
#include <cmath>

#include "wellgyro/record/unknown_angle.h"

namespace wellgyro {
namespace {

using Eigen::Vector3d;

/// Over the knots of one north, from the last one back.
struct NorthSums {
  double score = 0;  ///< c'P r
  double own = 0;    ///< c'c
  double taken = 0;  ///< var z, z = c'J x
  EdgeVector link;   ///< E[z (node; border)] of the earliest node so far
};

bool IsOf(const NorthAt& north, const Factor& f) {
  return f.kind == (north.outside ? RowKind::kAzimuth : RowKind::kStill);
}

class Closures {
 public:
  Closures(const LinearRun& solved, std::span<const Node> nodes, std::span<const NorthAt> norths)
      : run_(solved), nodes_(nodes), norths_(norths), sums_(norths.size()) {}

  std::vector<NorthClosure> Run() {
    const Elimination& e = run_.elimination();
    EdgeMatrix next = e.LastCovariance();
    for (std::size_t k = run_.knots(); k-- > 0;) {
      const BehindMatrix gain = e.Gain(k);
      BehindMatrix with_next;
      const EdgeMatrix here = e.CovarianceBefore(k, gain, next, with_next);
      Knot(k, gain, JointCovariance(here, with_next, next));
      next = here;
    }
    std::vector<NorthClosure> closures;
    for (const NorthSums& sums : sums_) closures.push_back(ClosureOf(sums));
    return closures;
  }

 private:
  static NorthClosure ClosureOf(const NorthSums& sums) {
    const double information = sums.own - sums.taken;
    if (!(information * kVagueAngle * kVagueAngle > 1)) return {};
    return {-sums.score / information, 1 / std::sqrt(information)};
  }

  void Knot(std::size_t k, const BehindMatrix& gain, const BlockMatrix& joint) {
    bool read = false;
    for (std::size_t i = 0; i < norths_.size(); ++i) {
      const NorthAt& north = norths_[i];
      // What holds at the first node stands in the first knot's rows.
      if (k < north.begin || k >= std::max<std::size_t>(north.end, 1)) continue;
      if (!read) run_.RowsOf(k, rows_);
      read = true;
      Add(north, k, gain, joint, sums_[i]);
    }
  }

  /// A turn about the vertical, of [node | next node | border], as phi of each node; an azimuth
  /// from outside is at its own alone.
  NormalBlock::Vector TurnOf(std::size_t k, const NorthAt& north) const {
    const Layout& layout = run_.layout();
    NormalBlock::Vector turn = NormalBlock::Vector::Zero(2 * layout.node + layout.border);
    for (const int i : {0, 1}) {
      if (north.outside && north.end != k + i) continue;
      turn.segment<3>(i * layout.node + layout.phi) = nodes_[k + i].R_LT.row(2).transpose();
    }
    return turn;
  }

  /// z grows by y'[x_k; x_k+1; border], y = J'c of this knot's rows; what z had in it of later
  /// nodes goes with x_k = gain [x_k+1; border] + e, e independent of all later.
  void Add(const NorthAt& north, std::size_t k, const BehindMatrix& gain, const BlockMatrix& joint,
           NorthSums& sums) {
    const Eigen::Index n = run_.layout().node, b = run_.layout().border;
    const NormalBlock::Vector turn = TurnOf(k, north);
    NormalBlock::Vector y = NormalBlock::Vector::Zero(turn.size());
    for (const Factor& f : rows_) {
      if (!IsOf(north, f)) continue;
      Vector3d c = Vector3d::Zero();
      for (int j = 0; j < f.columns; ++j) c += turn[f.column[At(j)]] * f.J.col(j);
      c.tail(3 - f.rows).setZero();
      for (int j = 0; j < f.columns; ++j) {
        y[f.column[At(j)]] += f.J.col(j).head(f.rows).dot(c.head(f.rows));
      }
      sums.score += c.head(f.rows).dot(f.r.head(f.rows));
      sums.own += c.squaredNorm();
    }
    NormalBlock::Vector link = NormalBlock::Vector::Zero(y.size());
    if (sums.link.size() > 0) link << gain * sums.link, sums.link;
    const NormalBlock::Vector of_y = joint * y;
    sums.taken += y.dot(2 * link + of_y);
    link += of_y;
    sums.link.resize(n + b);
    sums.link << link.head(n), link.tail(b);
  }

  static std::size_t At(int i) { return static_cast<std::size_t>(i); }

  const LinearRun& run_;
  std::span<const Node> nodes_;
  std::span<const NorthAt> norths_;
  std::vector<NorthSums> sums_;
  std::vector<Factor> rows_;
};

}  // namespace

std::vector<NorthClosure> NorthClosures(const LinearRun& solved, std::span<const Node> nodes,
                                        std::span<const NorthAt> norths) {
  if (norths.empty()) return {};
  return Closures(solved, nodes, norths).Run();
}

}  // namespace wellgyro
