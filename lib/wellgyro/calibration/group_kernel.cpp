#include <cmath>
#include <utility>

#include "wellgyro/calibration/group_kernel_internal.h"
#include "wellgyro/calibration/thermometer_internal.h"

// Every sum stands in one order, whether four lanes go side by side or eight, and nothing is
// contracted: either gives the same bits.

namespace wellgyro {
namespace {

/// Where a group's readings stand. A copy at hand: as far as the compiler can tell, what is written
/// may change what stands elsewhere.
struct Sources {
  Sources(const GroupKernel& g, const Readings& readings)
      : x(readings.x.data()),
        heating_rate(readings.heating_rate.data()),
        per_second(readings.per_second.data()),
        f{readings.f[0].data(), readings.f[1].data(), readings.f[2].data()} {
    for (std::size_t c = 0; c < 4; ++c) counts[c] = readings.counts[g.channel[c]].data();
  }
  const std::int32_t* counts[4];
  const float *x, *heating_rate;
  const double *per_second, *f[3];
};

/// Samples side by side, from `at` on.
template <class L>
struct Side {
  using Single = typename L::Single;
  using Double = typename L::Double;

  const GroupKernel& g;
  const Sources& sources;
  std::size_t at;
  Single x;
  Double u[3];
  Single slope[3];  ///< of u, over the cell
  Single low[3];    ///< taken off u
};

/// How much A counts + b change over the cell.
template <class L, std::size_t kChannels>
[[gnu::always_inline]] inline void Slope(Side<L>& s) {
  typename L::Single n;
#pragma GCC unroll 4
  for (std::size_t c = 0; c < kChannels; ++c) {
    L::ToSingle(s.sources.counts[c] + s.at, n);
#pragma GCC unroll 4
    for (std::size_t i = 0; i < 3; ++i) {
      const auto moved = (L::Of(s.g.A1[i][c]) + s.x * L::Of(s.g.A2[i][c])) * n;
      s.slope[i] = c == 0 ? moved : s.slope[i] + moved;
    }
  }
  if (s.g.pulses) {
    typename L::Double rate;
    L::Load(s.sources.per_second + s.at, rate);
    L::ToSingle(rate, n);
#pragma GCC unroll 4
    for (std::size_t i = 0; i < 3; ++i) s.slope[i] *= n;
  }
#pragma GCC unroll 4
  for (std::size_t i = 0; i < 3; ++i) {
    s.slope[i] += L::Of(s.g.b1[i]) + s.x * L::Of(s.g.b2[i]);
  }
}

/// A counts + b where the cell begins.
template <class L, std::size_t kChannels>
[[gnu::always_inline]] inline void Linear(Side<L>& s) {
  typename L::Double n;
#pragma GCC unroll 4
  for (std::size_t c = 0; c < kChannels; ++c) {
    L::ToDouble(s.sources.counts[c] + s.at, n);
#pragma GCC unroll 4
    for (std::size_t i = 0; i < 3; ++i) {
#pragma GCC unroll 2
      for (std::size_t h = 0; h < 2; ++h) {
        const auto moved = L::Of(s.g.A[i][c]) * n[h];
        s.u[i][h] = c == 0 ? moved : s.u[i][h] + moved;
      }
    }
  }
  // Counts of pulses are to be per second.
  if (s.g.pulses) L::Load(s.sources.per_second + s.at, n);
#pragma GCC unroll 4
  for (std::size_t i = 0; i < 3; ++i) {
#pragma GCC unroll 2
    for (std::size_t h = 0; h < 2; ++h) {
      if (s.g.pulses) s.u[i][h] *= n[h];
      s.u[i][h] += L::Of(s.g.b[i]);
    }
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
      L::Load(s.sources.f[j] + s.at, f_j);
      L::ToSingle(f_j, f[j]);
      TakeOff<L>(s, s.g.force[j], s.g.force1[j], f[j], varies);
    }
    TakeProducts<L>(s, s.g.force_products, f, varies);
  }
  if (s.g.heats) {
    typename L::Single rate;
    L::Load(s.sources.heating_rate + s.at, rate);
    TakeOff<L>(s, s.g.heat, s.g.heat1, rate, varies);
  }
}

/// What is small beside u.
template <class L>
[[gnu::always_inline]] inline void SumSmall(Side<L>& s, bool varies, bool moved) {
#pragma GCC unroll 4
  for (std::size_t i = 0; i < 3; ++i) {
    if (!varies) {
      s.low[i] = -s.low[i];
    } else {
      s.low[i] = moved ? s.x * s.slope[i] - s.low[i] : s.x * s.slope[i];
    }
  }
}

template <class L>
[[gnu::always_inline]] inline void AddSmall(Side<L>& s) {
#pragma GCC unroll 4
  for (std::size_t i = 0; i < 3; ++i) {
    typename L::Double more;
    L::ToDouble(s.low[i], more);
#pragma GCC unroll 2
    for (std::size_t h = 0; h < 2; ++h) s.u[i][h] += more[h];
  }
}

/// Small terms first: they and u need as many registers as there are.
template <class L, unsigned kWhat>
[[gnu::always_inline]] inline void SolveSides(const GroupKernel& group, const Readings& readings,
                                              const Part& part, Vectors& u) {
  constexpr std::size_t kChannels = (kWhat & 1) != 0 ? 4 : 3;
  constexpr bool kVaries = (kWhat & 2) != 0, kMoved = (kWhat & 4) != 0;
  const Sources sources(group, readings);
  for (std::size_t at = part.begin; at < part.end; at += L::kCount) {
    Side<L> s{group, sources, at};
    if (kVaries) {
      L::Load(sources.x + at, s.x);
      Slope<L, kChannels>(s);
    }
    if (kMoved) TakeForce<L>(s, kVaries);
    if (kVaries || kMoved) SumSmall<L>(s, kVaries, kMoved);
    Linear<L, kChannels>(s);
    if (kVaries || kMoved) AddSmall<L>(s);
#pragma GCC unroll 4
    for (std::size_t i = 0; i < 3; ++i) L::Store(s.u[i], u[i].data() + at);
  }
}

/// What products of u do to it where that is too much for single precision, of samples side by side
/// from `at` on; what of u was found so far is in `refined`.
template <std::size_t kCount>
[[gnu::noinline]] void RefineLarge(const GroupKernel& g, const OfRun<float>& x,
                                   const double (&refined)[3][kCount], std::size_t at, Vectors& u) {
  for (std::size_t k = at; k < at + kCount; ++k) {
    const Eigen::Vector3d linear(u[0][k], u[1][k], u[2][k]);
    const Eigen::Vector3f of = linear.cast<float>();
    Eigen::Vector3d right(refined[0][k - at], refined[1][k - at], refined[2][k - at]);
    if (of[0] * of[0] + of[1] * of[1] + of[2] * of[2] > g.reach_square) {
      right = RefineInDouble(g, static_cast<double>(x[k]), linear);
    }
    for (std::size_t i = 0; i < 3; ++i) u[i][k] = right[static_cast<Eigen::Index>(i)];
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
  SumSmall<L>(s, varies, true);
  AddSmall<L>(s);
  return large;
}

/// A pass of its own: what waits for nothing goes on meanwhile.
template <class L, bool kVaries>
[[gnu::always_inline]] inline void RefineSides(const GroupKernel& group, const Readings& readings,
                                               const Part& part, Vectors& u) {
  const Sources sources(group, readings);
  for (std::size_t at = part.begin; at < part.end; at += L::kCount) {
    Side<L> s{group, sources, at};
    if (kVaries) L::Load(sources.x + at, s.x);
#pragma GCC unroll 4
    for (std::size_t i = 0; i < 3; ++i) L::Load(u[i].data() + at, s.u[i]);
    if (Refine<L>(s, kVaries)) {
      double refined[3][L::kCount];
      for (std::size_t i = 0; i < 3; ++i) L::Store(s.u[i], refined[i]);
      RefineLarge(group, readings.x, refined, at, u);
      continue;
    }
#pragma GCC unroll 4
    for (std::size_t i = 0; i < 3; ++i) L::Store(s.u[i], u[i].data() + at);
  }
}

template <class L>
[[gnu::always_inline]] inline void TakeEach(const ThermometerCalibration& thermometer,
                                            const Apart& readings, std::size_t at,
                                            OfRun<double>& temperature,
                                            OfRun<std::int64_t>& inside) {
  const ThermometerCalibration model = thermometer;  // stays in registers
  for (std::size_t k = 0; k < kPiece; k += L::kCount) {
    typename L::Single read;
    L::Gather(readings.first + k * readings.step, readings.step, read);
    typename L::Double value;
    L::ToDouble(read, value);
#pragma GCC unroll 2
    for (std::size_t h = 0; h < 2; ++h) {
      const typename L::Half raw = value[h];
      typename L::Mask within;
      FindTrueTemperature(model, raw, value[h], within);
      L::And(within, inside.data() + at + k + h * L::kCount / 2);
    }
    L::Store(value, temperature.data() + at + k);
  }
}

template <class L>
[[gnu::always_inline]] inline bool PlaceEach(const CellPlace& at_hand,
                                             const OfRun<double>& temperature, const Part& part,
                                             OfRun<float>& x, OfRun<std::int64_t>& inside) {
  const CellPlace cell = at_hand;  // stays in registers
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
                                         const Apart& readings, std::size_t at,
                                         OfRun<double>& temperature, OfRun<std::int64_t>& inside) {
  TakeEach<Lanes8>(thermometer, readings, at, temperature, inside);
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

void TakeTemperatures(Lanes lanes, const ThermometerCalibration& thermometer, const Apart& readings,
                      std::size_t at, OfRun<double>& temperature, OfRun<std::int64_t>& inside) {
#if defined(__x86_64__)
  if (lanes == Lanes::kEight) return TakeByEight(thermometer, readings, at, temperature, inside);
#endif
  static_cast<void>(lanes);
  TakeEach<Lanes4>(thermometer, readings, at, temperature, inside);
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
