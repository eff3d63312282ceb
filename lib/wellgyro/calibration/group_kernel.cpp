#include <cmath>
#include <utility>

#include "wellgyro/calibration/group_kernel_internal.h"
#include "wellgyro/calibration/thermometer_internal.h"

// Every sum stands in one order, whether four lanes go side by side or eight, and nothing is
// contracted: either gives the same bits.

namespace wellgyro {
namespace {

/// Samples side by side, from `at` on.
template <class L>
struct Side {
  using Single = typename L::Single;
  using Double = typename L::Double;

  const GroupKernel& g;
  const Readings& readings;
  std::size_t at;
  Single x;
  Double u[3];
  Single slope[3];  ///< of u, over the cell
  Single low[3];    ///< taken off u
};

template <class L>
[[gnu::always_inline]] inline void AddChannel(Side<L>& s, std::size_t c, bool varies) {
  typename L::Double n;
  const std::int32_t* counts = s.readings.counts[s.g.channel[c]].data() + s.at;
  L::ToDouble(counts, n);
#pragma GCC unroll 4
  for (std::size_t i = 0; i < 3; ++i) {
#pragma GCC unroll 2
    for (std::size_t h = 0; h < 2; ++h) {
      const auto moved = L::Of(s.g.A[i][c]) * n[h];
      s.u[i][h] = c == 0 ? moved : s.u[i][h] + moved;
    }
  }
  if (!varies) return;
  typename L::Single single;
  L::ToSingle(counts, single);
#pragma GCC unroll 4
  for (std::size_t i = 0; i < 3; ++i) {
    const auto moved = (L::Of(s.g.A1[i][c]) + s.x * L::Of(s.g.A2[i][c])) * single;
    s.slope[i] = c == 0 ? moved : s.slope[i] + moved;
  }
}

/// Counts of pulses are to be per second.
template <class L>
[[gnu::always_inline]] inline void PerSecond(Side<L>& s, bool varies) {
  typename L::Double rate;
  L::Load(s.readings.per_second.data() + s.at, rate);
  typename L::Single single;
  L::ToSingle(rate, single);
#pragma GCC unroll 4
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t h = 0; h < 2; ++h) s.u[i][h] *= rate[h];
    if (varies) s.slope[i] *= single;
  }
}

/// A counts + b, and how much they change over the cell.
template <class L>
[[gnu::always_inline]] inline void Linear(Side<L>& s, bool four, bool varies) {
#pragma GCC unroll 4
  for (std::size_t c = 0; c < 3; ++c) AddChannel(s, c, varies);
  if (four) AddChannel(s, 3, varies);
  if (s.g.pulses) PerSecond(s, varies);
#pragma GCC unroll 4
  for (std::size_t i = 0; i < 3; ++i) {
#pragma GCC unroll 2
    for (std::size_t h = 0; h < 2; ++h) s.u[i][h] += L::Of(s.g.b[i]);
    if (varies) s.slope[i] += L::Of(s.g.b1[i]) + s.x * L::Of(s.g.b2[i]);
  }
}

/// Takes off what moves u by `out` of q, and by out1 more at the end of the cell.
template <class L>
[[gnu::always_inline]] inline void TakeOff(Side<L>& s, const SameSingle (&out)[3],
                                           const SameSingle (&out1)[3], const typename L::Single& q,
                                           bool varies) {
#pragma GCC unroll 4
  for (std::size_t i = 0; i < 3; ++i) {
    s.low[i] += L::Of(out[i]) * q;
    if (varies) s.slope[i] -= L::Of(out1[i]) * q;
  }
}

/// What the products of `of` move u by.
template <class L>
[[gnu::always_inline]] inline void TakeProducts(Side<L>& s,
                                                const GroupKernel::Products<SameSingle>& products,
                                                const typename L::Single (&of)[3], bool varies) {
  if (products.squares) {
#pragma GCC unroll 4
    for (std::size_t i = 0; i < 3; ++i) {
      TakeOff<L>(s, products.out[i], products.out1[i], of[i] * of[i], varies);
    }
  }
  if (products.crosses) {
#pragma GCC unroll 4
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t p = 3 + i;
      TakeOff<L>(s, products.out[p], products.out1[p], of[i] * of[(i + 1) % 3], varies);
    }
  }
}

/// What the force and the heating move u by.
template <class L>
[[gnu::always_inline]] inline void TakeForce(Side<L>& s, bool varies) {
#pragma GCC unroll 4
  for (std::size_t i = 0; i < 3; ++i) s.low[i] = typename L::Single{};
  if (s.g.feels_force) {
    typename L::Single f[3];
#pragma GCC unroll 4
    for (std::size_t j = 0; j < 3; ++j) {
      typename L::Double f_j;
      L::Load(s.readings.f[j].data() + s.at, f_j);
      L::ToSingle(f_j, f[j]);
      TakeOff<L>(s, s.g.force[j], s.g.force1[j], f[j], varies);
    }
    TakeProducts<L>(s, s.g.force_products, f, varies);
  }
  if (s.g.heats) {
    typename L::Single rate;
    L::Load(s.readings.heating_rate.data() + s.at, rate);
    TakeOff<L>(s, s.g.heat, s.g.heat1, rate, varies);
  }
}

/// u, without its products.
template <class L>
[[gnu::always_inline]] inline void Sum(Side<L>& s, bool varies, bool moved) {
#pragma GCC unroll 4
  for (std::size_t i = 0; i < 3; ++i) {
    typename L::Single small;
    if (varies) small = s.x * s.slope[i];
    if (moved) small = varies ? small - s.low[i] : -s.low[i];
    typename L::Double more;
    L::ToDouble(small, more);
#pragma GCC unroll 2
    for (std::size_t h = 0; h < 2; ++h) s.u[i][h] += more[h];
  }
}

template <class L, unsigned kWhat>
[[gnu::always_inline]] inline void SolveSides(const GroupKernel& group, const Readings& readings,
                                              const Part& part, Vectors& u) {
  constexpr bool kFour = (kWhat & 1) != 0, kVaries = (kWhat & 2) != 0, kMoved = (kWhat & 4) != 0;
  for (std::size_t at = part.begin; at < part.end; at += L::kCount) {
    Side<L> s{group, readings, at};
    if (kVaries) L::Load(readings.x.data() + at, s.x);
    Linear<L>(s, kFour, kVaries);
    if (kMoved) TakeForce<L>(s, kVaries);
    if (kVaries || kMoved) Sum<L>(s, kVaries, kMoved);
#pragma GCC unroll 4
    for (std::size_t i = 0; i < 3; ++i) L::Store(s.u[i], u[i].data() + at);
  }
}

/// What products of u do to it where that is too much for single precision, of samples side by side
/// from `at` on.
template <std::size_t kCount>
[[gnu::noinline]] void RefineLarge(const GroupKernel& g, const OfRun<float>& x,
                                   const double (&linear)[3][kCount], std::size_t at, Vectors& u) {
  for (std::size_t k = 0; k < kCount; ++k) {
    const Eigen::Vector3d whole(linear[0][k], linear[1][k], linear[2][k]);
    const Eigen::Vector3f of = whole.cast<float>();
    if (!(of[0] * of[0] + of[1] * of[1] + of[2] * of[2] > g.reach_square)) continue;
    const Eigen::Vector3d refined = RefineInDouble(g, static_cast<double>(x[at + k]), whole);
    for (std::size_t i = 0; i < 3; ++i) u[i][at + k] = refined[static_cast<Eigen::Index>(i)];
  }
}

/// Takes off u what its products do to it, in two turns: the first need not be right to the cell's
/// own change. Gives whether some u is too large for that.
template <class L>
[[gnu::always_inline]] inline bool Refine(Side<L>& s, bool varies) {
  typename L::Single of[3];
#pragma GCC unroll 4
  for (std::size_t i = 0; i < 3; ++i) {
    L::ToSingle(s.u[i], of[i]);
    s.low[i] = typename L::Single{};
  }
  const bool large = L::AnyAbove(of[0] * of[0] + of[1] * of[1] + of[2] * of[2], s.g.reach_square);
  TakeProducts<L>(s, s.g.products_single, of, false);
#pragma GCC unroll 4
  for (std::size_t i = 0; i < 3; ++i) {
    of[i] -= s.low[i];
    s.low[i] = s.slope[i] = typename L::Single{};
  }
  TakeProducts<L>(s, s.g.products_single, of, varies);
  Sum<L>(s, varies, true);
  return large;
}

/// A pass of its own: what waits for nothing goes on meanwhile.
template <class L, bool kVaries>
[[gnu::always_inline]] inline void RefineSides(const GroupKernel& group, const Readings& readings,
                                               const Part& part, Vectors& u) {
  for (std::size_t at = part.begin; at < part.end; at += L::kCount) {
    Side<L> s{group, readings, at};
    if (kVaries) L::Load(readings.x.data() + at, s.x);
    double linear[3][L::kCount];
#pragma GCC unroll 4
    for (std::size_t i = 0; i < 3; ++i) {
      L::Load(u[i].data() + at, s.u[i]);
      L::Store(s.u[i], linear[i]);
    }
    const bool large = Refine<L>(s, kVaries);
#pragma GCC unroll 4
    for (std::size_t i = 0; i < 3; ++i) L::Store(s.u[i], u[i].data() + at);
    if (large) RefineLarge(group, readings.x, linear, at, u);
  }
}

template <class L>
[[gnu::always_inline]] inline void TakeEach(const ThermometerCalibration& thermometer,
                                            const Part& part, OfRun<double>& temperature,
                                            OfRun<std::int64_t>& inside) {
  for (std::size_t at = part.begin; at < part.end; at += L::kCount) {
    typename L::Double value;
    L::Load(temperature.data() + at, value);
#pragma GCC unroll 2
    for (std::size_t h = 0; h < 2; ++h) {
      const typename L::Half raw = value[h];
      typename L::Mask within;
      FindTrueTemperature(thermometer, raw, value[h], within);
      L::And(within, inside.data() + at + h * L::kCount / 2);
    }
    L::Store(value, temperature.data() + at);
  }
}

template <class L>
[[gnu::always_inline]] inline bool PlaceEach(const CellPlace& cell,
                                             const OfRun<double>& temperature, const Part& part,
                                             OfRun<float>& x, OfRun<std::int64_t>& inside) {
  typename L::Mask all = typename L::Half{} == typename L::Half{};
  for (std::size_t at = part.begin; at < part.end; at += L::kCount) {
    typename L::Double value, place;
    L::Load(temperature.data() + at, value);
#pragma GCC unroll 2
    for (std::size_t h = 0; h < 2; ++h) {
      cell.Find(value[h], place[h]);
      L::And((value[h] >= cell.min) & (value[h] <= cell.max),
             inside.data() + at + h * L::kCount / 2);
      all &= (place[h] >= 0.0) & (place[h] < 1.0);
    }
    typename L::Single single;
    L::ToSingle(place, single);
    L::Store(single, x.data() + at);
  }
  return L::All(all);
}

using Solver = void (*)(const GroupKernel&, const Readings&, const Part&, Vectors&);

template <unsigned kWhat>
void SolveByFour(const GroupKernel& group, const Readings& readings, const Part& part, Vectors& u) {
  SolveSides<Lanes4, kWhat>(group, readings, part, u);
}
template <bool kVaries>
void RefineByFour(const GroupKernel& group, const Readings& readings, const Part& part,
                  Vectors& u) {
  RefineSides<Lanes4, kVaries>(group, readings, part, u);
}

#if defined(__x86_64__)
template <unsigned kWhat>
[[gnu::target("avx2")]] void SolveByEight(const GroupKernel& group, const Readings& readings,
                                          const Part& part, Vectors& u) {
  SolveSides<Lanes8, kWhat>(group, readings, part, u);
}

template <bool kVaries>
[[gnu::target("avx2")]] void RefineByEight(const GroupKernel& group, const Readings& readings,
                                           const Part& part, Vectors& u) {
  RefineSides<Lanes8, kVaries>(group, readings, part, u);
}

[[gnu::target("avx2")]] void TakeByEight(const ThermometerCalibration& thermometer,
                                         const Part& part, OfRun<double>& temperature,
                                         OfRun<std::int64_t>& inside) {
  TakeEach<Lanes8>(thermometer, part, temperature, inside);
}

[[gnu::target("avx2")]] bool PlaceByEight(const CellPlace& cell, const OfRun<double>& temperature,
                                          const Part& part, OfRun<float>& x,
                                          OfRun<std::int64_t>& inside) {
  return PlaceEach<Lanes8>(cell, temperature, part, x, inside);
}
#endif

/// By what a group has, and by lanes.
template <unsigned... kWhat>
Solver SolverOf(Lanes lanes, unsigned what, std::integer_sequence<unsigned, kWhat...>) {
#if defined(__x86_64__)
  static constexpr Solver kByEight[] = {SolveByEight<kWhat>...};
  if (lanes == Lanes::kEight) return kByEight[what];
#endif
  static_cast<void>(lanes);
  static constexpr Solver kByFour[] = {SolveByFour<kWhat>...};
  return kByFour[what];
}

Solver RefinerOf(Lanes lanes, bool varies) {
#if defined(__x86_64__)
  if (lanes == Lanes::kEight) return varies ? RefineByEight<true> : RefineByEight<false>;
#endif
  static_cast<void>(lanes);
  return varies ? RefineByFour<true> : RefineByFour<false>;
}

}  // namespace

Lanes MostLanes() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) return Lanes::kEight;
#endif
  return Lanes::kFour;
}

void Solve(Lanes lanes, const GroupKernel& g, const Readings& readings, Part part, Vectors& u) {
  const unsigned what = (g.n_channels == 4 ? 1U : 0U) + (g.varies ? 2U : 0U) + (g.moved ? 4U : 0U);
  SolverOf(lanes, what, std::make_integer_sequence<unsigned, 8>())(g, readings, part, u);
  if (g.second_order) RefinerOf(lanes, g.varies)(g, readings, part, u);
}

void TakeTemperatures(Lanes lanes, const ThermometerCalibration& thermometer, Part part,
                      OfRun<double>& temperature, OfRun<std::int64_t>& inside) {
#if defined(__x86_64__)
  if (lanes == Lanes::kEight) return TakeByEight(thermometer, part, temperature, inside);
#endif
  static_cast<void>(lanes);
  TakeEach<Lanes4>(thermometer, part, temperature, inside);
}

bool Place(Lanes lanes, const CellPlace& cell, const OfRun<double>& temperature, Part part,
           OfRun<float>& x, OfRun<std::int64_t>& inside) {
#if defined(__x86_64__)
  if (lanes == Lanes::kEight) return PlaceByEight(cell, temperature, part, x, inside);
#endif
  static_cast<void>(lanes);
  return PlaceEach<Lanes4>(cell, temperature, part, x, inside);
}

}  // namespace wellgyro
