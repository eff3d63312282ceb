#pragma once

#include <Eigen/Core>

namespace wellgyro {

/// How wide the processor works. The result does not depend on it, bit for bit: each sum runs in
/// the same order and nothing is contracted.
enum class Registers { kPlain, kAvx2 };

/// The widest that this processor has.
Registers WidestRegisters();

/// Columns of a node that is eliminated, over its own rows and those behind them: of the next node
/// and of the border. They stand BlockStride() apart; numbers past the rows count for nothing.
struct NodePanel {
  double* values;
  Eigen::Index stride;
  Eigen::Index node, border;

  double* column(Eigen::Index j) const { return values + j * stride; }
  Eigen::Index behind() const { return node + border; }
  Eigen::Index rows() const { return 2 * node + border; }
};

/// A lower triangle over [node | border], whose columns stand ByFours(node + border) apart.
struct EdgeColumns {
  double* values;
  Eigen::Index stride;

  double* column(Eigen::Index j) const { return values + j * stride; }
};

/// Fills the lower triangle of the panel: what a block says, whose columns stand as far apart as
/// the panel's, and what is known of [node | border].
void Begin(Registers registers, const double* block, const EdgeColumns& edge,
           const NodePanel& panel);

/// Replaces the panel by those columns of the Cholesky factor, in its lower triangle. False where
/// it is not positive.
bool Factorise(Registers registers, const NodePanel& panel);

/// Of a gradient over the panel's rows, as many numbers as the stride: divides the node's by the
/// factor and takes from those behind what they told.
void Forward(Registers registers, const NodePanel& panel, double* gradient);

/// Of [next node | border]: what the block says of them, whose columns stand as far apart as the
/// panel's, and what was known of the border, less what the panel took of it.
void Succeed(Registers registers, const NodePanel& panel, const double* block,
             const EdgeColumns& edge);

/// Three rows J over a block's columns, of which `count` are filled in.
struct ThreeRows {
  const double* by_column;  ///< three numbers of each
  const int* at;            ///< where they stand in the block
  int count;
};
/// Adds weight J'J to a block's lower triangle, whose columns stand `stride` apart; `spread` is J
/// row by row over all columns of the block, which stand as far apart, zeros where it has none.
void AddSquare(Registers registers, const ThreeRows& J, const double* spread, double weight,
               Eigen::Index stride, double* block);
/// A J' of a symmetric matrix A over `rows` rows, whose columns stand `rows` apart: three columns
/// that stand ByFours(rows) apart.
void TimesThreeRows(Registers registers, const double* A, Eigen::Index rows, const ThreeRows& J,
                    double* by_row);

/// Of a product A B' and its factors, whose columns stand close together.
struct ProductShape {
  Eigen::Index rows, columns;  ///< of the product
  Eigen::Index inner;          ///< columns of A and B
};
void Multiply(Registers registers, const ProductShape& shape, const double* A, const double* B,
              double* out);

}  // namespace wellgyro
