#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/estimate/layout.h"

namespace wellgyro {

/// What a residual compares.
enum class RowKind {
  kTurn,     ///< gyros' turn against the attitudes at both ends
  kStill,    ///< the same of a tool at rest: the Earth's rate
  kForce,    ///< accelerometers against gravity and the motion along the hole
  kRoll,     ///< the roll rate's walk or swing from knot to knot
  kAxial,    ///< a third gyro axis
  kDepth,    ///< depth marks
  kSpeed,    ///< depth against speed, and the speed's walk
  kDrift,    ///< of the gyros from node to node
  kRest,     ///< a tool at rest that turns
  kAzimuth,  ///< azimuth from outside
  kPrior,
  kKinds
};
inline constexpr std::size_t kRowKinds = static_cast<std::size_t>(RowKind::kKinds);

/// Up to three rows of whitened residuals r with their derivatives, d r = J d(columns); no frame.
struct Factor {
  static constexpr int kColumnsMax = 2 * kNodeMax + kBorderMax;
  RowKind kind = RowKind::kPrior;
  int rows = 1;
  int measured = 1;  ///< the first of them, whose residuals are noise; the others tie unknowns
  double held = 0;   ///< the robust weight, where it is held; 0: by the residuals
  /// By what the rows that measure, not tie, grow with what they compare: 1 / sigma; 0: not told.
  double per_unit = 0;
  /// Unit direction in which the noise is another, and what the residuals are short of there: they
  /// are whitened by per_unit (1 - shrink u u').
  Eigen::Vector3d u = Eigen::Vector3d::Zero();
  double shrink = 0;
  int columns = 0;
  std::array<int, kColumnsMax> column{};  ///< of the block: node, next node, border
  Eigen::Matrix<double, 3, kColumnsMax> J;
  Eigen::Vector3d r;

  Factor() = default;
  /// Of J only what is filled in.
  Factor(const Factor& other) { *this = other; }
  Factor& operator=(const Factor& other);

  /// Adds a column for what stands at `at` of the block; its derivative is to be filled in, of as
  /// many rows as there are.
  auto Column(int at) {
    column[static_cast<std::size_t>(columns)] = at;
    return J.col(columns++);
  }
  /// Rows that are filled in, whitened by one sigma, for one that is `sigma` times it along
  /// `along`; of no frame, as r.
  void Shrink(const Eigen::Vector3d& along, double sigma) {
    u = along;
    shrink = 1 - 1 / sigma;
    r -= shrink * u.dot(r) * u;
    for (int j = 0; j < columns; ++j) J.col(j) -= shrink * u.dot(J.col(j)) * u;
  }
  /// What a unit of what row i compares, by itself, adds to the residuals.
  Eigen::Vector3d UnitOf(int i) const {
    return per_unit * (Eigen::Vector3d::Unit(i) - shrink * u[i] * u);
  }
  void Begin(RowKind of, int n) {
    kind = of;
    rows = measured = n;
    held = per_unit = shrink = 0;
    columns = 0;
  }
};

/// The robust weight of the roll's change, whose `n` whitened residuals have this sum of squares.
double RollWeight(double square, int n);

/// How squares of one kind of residual add up, of the rows that measure.
struct RowSum {
  double squares = 0;   ///< of the residuals as they are; of forces but for what is lateral
  double weighted = 0;  ///< with their robust weights
  double cost = 0;      ///< -2 ln of the density of all rows, but for constants
  double rows = 0;
  /// What `weighted` is to be, of normal residuals less what the unknowns take up of them; where
  /// the covariance was given.
  double freedom = 0;
};

/// Columns that the processor works along by fours.
constexpr Eigen::Index ByFours(Eigen::Index n) { return (n + 3) / 4 * 4; }
/// How far apart columns over [node | next node | border] stand, so that each begins at a multiple
/// of four and fours counted from the next node on end within it.
constexpr Eigen::Index BlockStride(Eigen::Index node, Eigen::Index border) {
  return ByFours(node + ByFours(node + border));
}
inline constexpr Eigen::Index kBlockStrideMost = BlockStride(kNodeMax, kBorderMax);

using BlockMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0,
                                  2 * kNodeMax + kBorderMax, 2 * kNodeMax + kBorderMax>;

/// J cov J', `cov` of [node | next node | border]; rows that the factor lacks are zero.
Eigen::Matrix3d CovarianceOf(const Factor& factor, const BlockMatrix& cov);

/// The normal equations of what a knot says of [node | next node | border]: J'J and J'r.
class NormalBlock {
 public:
  using Matrix = BlockMatrix;
  template <class Numbers>
  using Columns = Eigen::Map<Numbers, Eigen::Aligned16, Eigen::OuterStride<>>;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 2 * kNodeMax + kBorderMax, 1>;

  void Clear(const Layout& layout);
  /// Factors that come next count as they are, without loss, but for the roll's.
  void WithoutLoss(bool without) { without_loss_ = without; }
  /// Adds the factor with the robust weight of its kind.
  void Add(const Factor& factor);
  /// With the covariance of [node | next node | border], factors that come next are only summed up,
  /// with what the unknowns absorb of them; nullptr: as before.
  void Measure(const Matrix* covariance) { covariance_ = covariance; }

  /// Factors that come next are appended here and otherwise left alone; nullptr: as before.
  void Collect(std::vector<Factor>* factors) { collected_ = factors; }

  int next() const { return node_; }        ///< first column of the next node
  int border() const { return 2 * node_; }  ///< first of the border
  /// Lower triangle; numbers past the last row are zero.
  Columns<Eigen::MatrixXd> information() {
    return {information_.data(), size(), size(), Eigen::OuterStride<>(stride_)};
  }
  Columns<const Eigen::MatrixXd> information() const {
    return {information_.data(), size(), size(), Eigen::OuterStride<>(stride_)};
  }
  Vector& gradient() { return gradient_; }
  const Vector& gradient() const { return gradient_; }
  /// Of the information, its upper part too.
  Vector Column(int at) const;
  const std::array<RowSum, kRowKinds>& sums() const { return sums_; }
  void ClearSums() { sums_ = {}; }

 private:
  static constexpr std::size_t kNumbersMost =
      static_cast<std::size_t>(kBlockStrideMost * Factor::kColumnsMax);

  Eigen::Index size() const { return gradient_.size(); }
  void AddSparse(const Factor& f, double weight);
  void AddDense(const Factor& f, double weight);

  int node_ = 0;
  bool without_loss_ = false;
  Eigen::Index stride_ = 0;
  alignas(32) std::array<double, kNumbersMost> information_;
  Vector gradient_;
  const Matrix* covariance_ = nullptr;
  std::vector<Factor>* collected_ = nullptr;
  std::array<RowSum, kRowKinds> sums_{};
};

}  // namespace wellgyro
