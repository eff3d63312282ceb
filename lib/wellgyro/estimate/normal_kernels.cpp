#include <algorithm>
#include <cmath>
#include <cstring>

#include "wellgyro/estimate/normal_block.h"
#include "wellgyro/estimate/normal_kernels_internal.h"

// Products of some ten by thirty numbers: blocks of rows by four columns whose sums stay in
// registers are several times as fast as what is made for large matrices.
//
// Vectors are handed on by reference alone: by value, how they travel would depend on what the
// function is compiled for.

namespace wellgyro {
namespace {

using Eigen::Index;
using Pair [[gnu::vector_size(16)]] = double;
using Quad [[gnu::vector_size(32)]] = double;

template <class V>
constexpr Index kWidth = sizeof(V) / sizeof(double);

template <class V>
[[gnu::always_inline]] inline void Get(const double* from, V& to) {
  std::memcpy(&to, from, sizeof to);
}

template <class V>
[[gnu::always_inline]] inline void Put(const V& from, double* to) {
  std::memcpy(to, &from, sizeof from);
}

/// Adds A B', of R registers of rows of A by C rows of B.
template <class V, int R, int C>
[[gnu::always_inline]] inline void AddProducts(const double* A, Index a_stride, const double* B,
                                               Index b_stride, Index columns, V (&sum)[C][R]) {
  for (Index k = 0; k < columns; ++k, A += a_stride, B += b_stride) {
    V a[R];
#pragma GCC unroll 4
    for (int r = 0; r < R; ++r) Get(A + r * kWidth<V>, a[r]);
#pragma GCC unroll 4
    for (int c = 0; c < C; ++c) {
      const double b = B[c];
#pragma GCC unroll 4
      for (int r = 0; r < R; ++r) sum[c][r] += a[r] * b;
    }
  }
}

template <class V>
[[gnu::always_inline]] inline void AddInto(const double* a, const double* b, Index count,
                                           double* to) {
  Index i = 0;
  for (; i + kWidth<V> <= count; i += kWidth<V>) {
    V x, y;
    Get(a + i, x);
    Get(b + i, y);
    Put(x + y, to + i);
  }
  for (; i < count; ++i) to[i] = a[i] + b[i];
}

template <class V>
[[gnu::always_inline]] inline void BeginBy(const double* block, const EdgeColumns& edge,
                                           const NodePanel& panel) {
  const Index n = panel.node;
  for (Index j = 0; j < n; ++j, block += panel.stride) {
    const double* known = edge.column(j);
    double* to = panel.column(j);
    AddInto<V>(block + j, known + j, n - j, to + j);
    std::copy_n(block + n, n, to + n);
    AddInto<V>(block + 2 * n, known + n, panel.border, to + 2 * n);
    std::copy(block + panel.rows(), block + panel.stride, to + panel.rows());
  }
}

/// C columns of the factor between the rows where they begin and those behind.
template <int C>
struct Corner {
  double of[C][4];
  double by[C];  ///< one by the diagonal
};

/// Of C columns from `begin` on, R registers of rows less the products of the columns before.
template <class V, int R, int C>
[[gnu::always_inline]] inline void Reduce(const NodePanel& panel, Index begin, Index row,
                                          V (&x)[C][R]) {
  V sum[C][R] = {};
  AddProducts(panel.values + row, panel.stride, panel.values + begin, panel.stride, begin, sum);
  const double* from = panel.column(begin) + row;
#pragma GCC unroll 4
  for (int c = 0; c < C; ++c, from += panel.stride) {
#pragma GCC unroll 4
    for (int r = 0; r < R; ++r) {
      V y;
      Get(from + r * kWidth<V>, y);
      x[c][r] = y - sum[c][r];
    }
  }
}

template <class V, int C>
[[gnu::always_inline]] inline bool FactoriseCorner(const NodePanel& panel, Index begin,
                                                   Corner<C>& corner) {
  V reduced[C][4 / kWidth<V>];
  Reduce(panel, begin, begin, reduced);
  std::memcpy(corner.of, reduced, sizeof corner.of);
  for (int j = 0; j < C; ++j) {
    double* x = corner.of[j];
    if (!(x[j] > 0)) return false;
    x[j] = std::sqrt(x[j]);
    corner.by[j] = 1 / x[j];
    for (int i = j + 1; i < C; ++i) x[i] *= corner.by[j];
    for (int k = j + 1; k < C; ++k) {
      for (int i = k; i < C; ++i) corner.of[k][i] -= x[k] * x[i];
    }
    std::copy(x + j, x + C, panel.column(begin + j) + begin + j);
  }
  return true;
}

/// The rows behind the corner.
template <class V, int R, int C>
[[gnu::always_inline]] inline void FactoriseRows(const NodePanel& panel, Index begin, Index row,
                                                 const Corner<C>& corner) {
  V x[C][R];
  Reduce(panel, begin, row, x);
  double* to = panel.column(begin) + row;
#pragma GCC unroll 4
  for (int c = 0; c < C; ++c, to += panel.stride) {
#pragma GCC unroll 4
    for (int r = 0; r < R; ++r) {
      x[c][r] *= corner.by[c];
      Put(x[c][r], to + r * kWidth<V>);
    }
#pragma GCC unroll 4
    for (int k = c + 1; k < C; ++k) {
#pragma GCC unroll 4
      for (int r = 0; r < R; ++r) x[k][r] -= corner.of[c][k] * x[c][r];
    }
  }
}

template <class V, int C>
[[gnu::always_inline]] inline bool FactoriseColumns(const NodePanel& panel, Index begin) {
  Corner<C> corner;
  if (!FactoriseCorner<V, C>(panel, begin, corner)) return false;
  Index row = begin + C;
  const Index end = row + ByFours(panel.rows() - row);
  for (; row + 2 * kWidth<V> <= end; row += 2 * kWidth<V>) {
    FactoriseRows<V, 2, C>(panel, begin, row, corner);
  }
  if (row < end) FactoriseRows<V, 1, C>(panel, begin, row, corner);
  return true;
}

template <class V>
[[gnu::always_inline]] inline bool FactoriseBy(const NodePanel& panel) {
  Index begin = 0;
  for (; begin + 4 <= panel.node; begin += 4) {
    if (!FactoriseColumns<V, 4>(panel, begin)) return false;
  }
  switch (panel.node - begin) {
    case 1:
      return FactoriseColumns<V, 1>(panel, begin);
    case 2:
      return FactoriseColumns<V, 2>(panel, begin);
    case 3:
      return FactoriseColumns<V, 3>(panel, begin);
    default:
      return true;
  }
}

/// Takes from R registers of the gradient what the node told.
template <class V, int R>
[[gnu::always_inline]] inline void ForwardRows(const NodePanel& panel, Index row, double* g) {
  V x[R];
#pragma GCC unroll 4
  for (int r = 0; r < R; ++r) Get(g + row + r * kWidth<V>, x[r]);
  const double* from = panel.values + row;
  for (Index j = 0; j < panel.node; ++j, from += panel.stride) {
    const double at = g[j];
#pragma GCC unroll 4
    for (int r = 0; r < R; ++r) {
      V y;
      Get(from + r * kWidth<V>, y);
      x[r] -= at * y;
    }
  }
#pragma GCC unroll 4
  for (int r = 0; r < R; ++r) Put(x[r], g + row + r * kWidth<V>);
}

template <class V>
[[gnu::always_inline]] inline void ForwardBy(const NodePanel& panel, double* g) {
  for (Index j = 0; j < panel.node; ++j) {
    const double* x = panel.column(j);
    g[j] /= x[j];
    for (Index i = j + 1; i < panel.node; ++i) g[i] -= g[j] * x[i];
  }
  Index row = panel.node;
  const Index end = row + ByFours(panel.behind());
  for (; row + 4 * kWidth<V> <= end; row += 4 * kWidth<V>) ForwardRows<V, 4>(panel, row, g);
  for (; row < end; row += kWidth<V>) ForwardRows<V, 1>(panel, row, g);
}

/// R registers of rows from i on of C columns from j on.
template <class V, int R, int C>
[[gnu::always_inline]] inline void SucceedBlock(const NodePanel& panel, const double* block,
                                                const EdgeColumns& edge, Index i, Index j) {
  V sum[C][R] = {};
  const double* behind = panel.values + panel.node;
  AddProducts(behind + i, panel.stride, behind + j, panel.stride, panel.node, sum);
  const double* from = block + (panel.node + j) * panel.stride + panel.node + i;
  double* to = edge.column(j) + i;
#pragma GCC unroll 4
  for (int c = 0; c < C; ++c, from += panel.stride, to += edge.stride) {
    const bool known = j + c >= panel.node;
#pragma GCC unroll 4
    for (int r = 0; r < R; ++r) {
      V x;
      Get(from + r * kWidth<V>, x);
      if (known) {
        V before;
        Get(to + r * kWidth<V>, before);
        x += before;
      }
      Put(x - sum[c][r], to + r * kWidth<V>);
    }
  }
}

template <class V, int C>
[[gnu::always_inline]] inline void SucceedColumns(const NodePanel& panel, const double* block,
                                                  const EdgeColumns& edge, Index j) {
  Index i = j;
  const Index end = ByFours(panel.behind());
  for (; i + 2 * kWidth<V> <= end; i += 2 * kWidth<V>) {
    SucceedBlock<V, 2, C>(panel, block, edge, i, j);
  }
  if (i < end) SucceedBlock<V, 1, C>(panel, block, edge, i, j);
}

template <class V>
[[gnu::always_inline]] inline void SucceedBy(const NodePanel& panel, const double* block,
                                             const EdgeColumns& edge) {
  const Index m = panel.behind();
  Index j = 0;
  for (; j + 4 <= m; j += 4) SucceedColumns<V, 4>(panel, block, edge, j);
  switch (m - j) {
    case 1:
      return SucceedColumns<V, 1>(panel, block, edge, j);
    case 2:
      return SucceedColumns<V, 2>(panel, block, edge, j);
    case 3:
      return SucceedColumns<V, 3>(panel, block, edge, j);
    default:
      return;
  }
}

/// C columns from `k` on, together from the register where the first of them in the block begins.
/// What stands above the diagonal counts for nothing.
template <class V, int C>
[[gnu::always_inline]] inline void AddColumns(const ThreeRows& J, const double* spread, int k,
                                              double weight, Index stride, double* block) {
  double w[C][3];
  double* column[C];
  Index begin = stride;
#pragma GCC unroll 4
  for (int c = 0; c < C; ++c) {
#pragma GCC unroll 4
    for (int i = 0; i < 3; ++i) w[c][i] = weight * J.by_column[3 * (k + c) + i];
    column[c] = block + J.at[k + c] * stride;
    begin = std::min<Index>(begin, J.at[k + c]);
  }
  for (Index i = begin / kWidth<V> * kWidth<V>; i < stride; i += kWidth<V>) {
    V x, y, z;
    Get(spread + i, x);
    Get(spread + stride + i, y);
    Get(spread + 2 * stride + i, z);
#pragma GCC unroll 4
    for (int c = 0; c < C; ++c) {
      V sum;
      Get(column[c] + i, sum);
      Put(sum + (w[c][0] * x + w[c][1] * y + w[c][2] * z), column[c] + i);
    }
  }
}

template <class V>
[[gnu::always_inline]] inline void AddSquareBy(const ThreeRows& J, const double* spread,
                                               double weight, Index stride, double* block) {
  int k = 0;
  for (; k + 2 <= J.count; k += 2) AddColumns<V, 2>(J, spread, k, weight, stride, block);
  if (k < J.count) AddColumns<V, 1>(J, spread, k, weight, stride, block);
}

template <class V>
[[gnu::always_inline]] inline void TimesThreeRowsBy(const double* A, Index rows, const ThreeRows& J,
                                                    double* by_row) {
  const Index stride = ByFours(rows);
  Index i = 0;
  for (; i + 2 * kWidth<V> <= rows; i += 2 * kWidth<V>) {
    V sum[3][2] = {};
    for (int k = 0; k < J.count; ++k) {
      V a[2];
#pragma GCC unroll 2
      for (int r = 0; r < 2; ++r) Get(A + J.at[k] * rows + i + r * kWidth<V>, a[r]);
#pragma GCC unroll 3
      for (int c = 0; c < 3; ++c) {
#pragma GCC unroll 2
        for (int r = 0; r < 2; ++r) sum[c][r] += J.by_column[3 * k + c] * a[r];
      }
    }
#pragma GCC unroll 3
    for (int c = 0; c < 3; ++c) {
#pragma GCC unroll 2
      for (int r = 0; r < 2; ++r) Put(sum[c][r], by_row + c * stride + i + r * kWidth<V>);
    }
  }
  for (; i < rows; ++i) {
    double sum[3] = {};
    for (int k = 0; k < J.count; ++k) {
      for (int c = 0; c < 3; ++c) sum[c] += J.by_column[3 * k + c] * A[J.at[k] * rows + i];
    }
    for (int c = 0; c < 3; ++c) by_row[c * stride + i] = sum[c];
  }
}

/// R registers of rows from i on of C columns from j on of A B'.
template <class V, int R, int C>
[[gnu::always_inline]] inline void MultiplyBlock(const ProductShape& s, const double* A,
                                                 const double* B, Index i, Index j, double* out) {
  V sum[C][R] = {};
  AddProducts(A + i, s.rows, B + j, s.columns, s.inner, sum);
#pragma GCC unroll 4
  for (int c = 0; c < C; ++c) {
#pragma GCC unroll 4
    for (int r = 0; r < R; ++r) Put(sum[c][r], out + (j + c) * s.rows + i + r * kWidth<V>);
  }
}

template <class V, int C>
[[gnu::always_inline]] inline void MultiplyColumns(const ProductShape& s, const double* A,
                                                   const double* B, Index j, double* out) {
  Index i = 0;
  for (; i + 2 * kWidth<V> <= s.rows; i += 2 * kWidth<V>) {
    MultiplyBlock<V, 2, C>(s, A, B, i, j, out);
  }
  for (; i + kWidth<V> <= s.rows; i += kWidth<V>) MultiplyBlock<V, 1, C>(s, A, B, i, j, out);
  for (; i + 2 <= s.rows; i += 2) MultiplyBlock<Pair, 1, C>(s, A, B, i, j, out);
  if (i < s.rows) MultiplyBlock<double, 1, C>(s, A, B, i, j, out);
}

template <class V>
[[gnu::always_inline]] inline void MultiplyBy(const ProductShape& s, const double* A,
                                              const double* B, double* out) {
  Index j = 0;
  for (; j + 4 <= s.columns; j += 4) MultiplyColumns<V, 4>(s, A, B, j, out);
  for (; j < s.columns; ++j) MultiplyColumns<V, 1>(s, A, B, j, out);
}

#if defined(__x86_64__)
[[gnu::target("avx2")]] void BeginByAvx2(const double* block, const EdgeColumns& edge,
                                         const NodePanel& panel) {
  BeginBy<Quad>(block, edge, panel);
}

[[gnu::target("avx2")]] bool FactoriseByAvx2(const NodePanel& panel) {
  return FactoriseBy<Quad>(panel);
}

[[gnu::target("avx2")]] void ForwardByAvx2(const NodePanel& panel, double* gradient) {
  ForwardBy<Quad>(panel, gradient);
}

[[gnu::target("avx2")]] void SucceedByAvx2(const NodePanel& panel, const double* block,
                                           const EdgeColumns& edge) {
  SucceedBy<Quad>(panel, block, edge);
}

[[gnu::target("avx2")]] void AddSquareByAvx2(const ThreeRows& J, const double* spread,
                                             double weight, Index stride, double* block) {
  AddSquareBy<Quad>(J, spread, weight, stride, block);
}

[[gnu::target("avx2")]] void TimesThreeRowsByAvx2(const double* A, Index rows, const ThreeRows& J,
                                                  double* by_row) {
  TimesThreeRowsBy<Quad>(A, rows, J, by_row);
}

[[gnu::target("avx2")]] void MultiplyByAvx2(const ProductShape& shape, const double* A,
                                            const double* B, double* out) {
  MultiplyBy<Quad>(shape, A, B, out);
}
#endif

}  // namespace

Registers WidestRegisters() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) return Registers::kAvx2;
#endif
  return Registers::kPlain;
}

void Begin(Registers registers, const double* block, const EdgeColumns& edge,
           const NodePanel& panel) {
#if defined(__x86_64__)
  if (registers == Registers::kAvx2) return BeginByAvx2(block, edge, panel);
#endif
  static_cast<void>(registers);
  BeginBy<Pair>(block, edge, panel);
}

bool Factorise(Registers registers, const NodePanel& panel) {
#if defined(__x86_64__)
  if (registers == Registers::kAvx2) return FactoriseByAvx2(panel);
#endif
  static_cast<void>(registers);
  return FactoriseBy<Pair>(panel);
}

void Forward(Registers registers, const NodePanel& panel, double* gradient) {
#if defined(__x86_64__)
  if (registers == Registers::kAvx2) return ForwardByAvx2(panel, gradient);
#endif
  static_cast<void>(registers);
  ForwardBy<Pair>(panel, gradient);
}

void Succeed(Registers registers, const NodePanel& panel, const double* block,
             const EdgeColumns& edge) {
#if defined(__x86_64__)
  if (registers == Registers::kAvx2) return SucceedByAvx2(panel, block, edge);
#endif
  static_cast<void>(registers);
  SucceedBy<Pair>(panel, block, edge);
}

void AddSquare(Registers registers, const ThreeRows& J, const double* spread, double weight,
               Index stride, double* block) {
#if defined(__x86_64__)
  if (registers == Registers::kAvx2) return AddSquareByAvx2(J, spread, weight, stride, block);
#endif
  static_cast<void>(registers);
  AddSquareBy<Pair>(J, spread, weight, stride, block);
}

void TimesThreeRows(Registers registers, const double* A, Index rows, const ThreeRows& J,
                    double* by_row) {
#if defined(__x86_64__)
  if (registers == Registers::kAvx2) return TimesThreeRowsByAvx2(A, rows, J, by_row);
#endif
  static_cast<void>(registers);
  TimesThreeRowsBy<Pair>(A, rows, J, by_row);
}

void Multiply(Registers registers, const ProductShape& shape, const double* A, const double* B,
              double* out) {
#if defined(__x86_64__)
  if (registers == Registers::kAvx2) return MultiplyByAvx2(shape, A, B, out);
#endif
  static_cast<void>(registers);
  MultiplyBy<Pair>(shape, A, B, out);
}

}  // namespace wellgyro
