#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include "wellgyro/calibration/lanes_internal.h"
#include "wellgyro/record/tool_calibration.h"

namespace wellgyro {

/// Samples that are looked at together, and numbers beside each other of so many: room for eight
/// lanes from each of them on.
inline constexpr std::size_t kRun = 64, kBeyond = 8;
/// Those of them that are taken together; a run is whole ones.
inline constexpr std::size_t kPiece = 16;
static_assert(kRun % kPiece == 0);
template <class Number>
using OfRun = std::array<Number, kRun + kBeyond>;
using Vectors = std::array<OfRun<double>, 3>;

/// SensorGroup's formula solved for u in T within a cell of temperatures, as plain numbers, with x
/// from 0 to 1 through the cell and q as SensorGroup has it:
///   u = A counts + b + x ((A1 + x A2) counts + b1 + x b2)
///       - (force + x force1) f - (force_products + x ...) q(f) + (heat + x heat1) dT/dt
///       - (products + x ...) q(u)
/// Where channels count pulses, their counts are per second. All but A counts + b is small beside
/// u: it is summed in single precision, to 2^-20 of its largest part, products of u where that is
/// enough for them (kReachSingle).
struct GroupKernel {
  /// What the products of q move u by where the cell begins, and how much that changes through it:
  /// xx, yy, zz, then xy, yz, zx.
  template <class Number>
  struct Products {
    bool squares = false, crosses = false;  ///< some of these three move anything
    Number out[6][3] = {}, out1[6][3] = {};
  };

  int n_channels = 0;
  std::array<std::size_t, 4> channel{};
  /// What of the formula a group has: what it lacks costs nothing.
  bool varies = false, moved = false, second_order = false;  ///< moved: by the force or heating
  bool pulses = false, feels_force = false, heats = false;
  SameDouble A[3][4], b[3];
  SameSingle A1[3][4], A2[3][4], b1[3], b2[3], force[3][3], force1[3][3], heat[3], heat1[3];
  Products<SameSingle> force_products, products_single;
  Products<double> products;
  /// Largest sum of a row of products: e = slope |u| is how far the second order moves u, over u.
  double slope = 0;
  float reach_square = 0;  ///< largest |u|^2 for which products in single precision are enough
};

/// u <- linear - products q(u), from `linear_T` on, as often as it needs to leave less than a tenth
/// of the finest count, 2^-31 of full scale; x: place in the cell.
Eigen::Vector3d RefineInDouble(const GroupKernel& kernel, double x,
                               const Eigen::Vector3d& linear_T);
/// Largest e for which two turns in single precision leave as little: sums of six products of what
/// was rounded before are off by twelve roundings at most, 12 * 2^-24 e.
inline constexpr double kReachSingle = 6.5e-5;

/// How many samples the processor takes at once. The result does not depend on it, bit for bit.
enum class Lanes { kFour, kEight };
/// The most that this processor can.
Lanes MostLanes();

/// Samples of a run: from `begin` on, before `end`.
struct Part {
  std::size_t begin = 0, end = 0;
};

/// What a group's samples are made of: counts of each channel, place in the cell, dT/dt, f in T and
/// one over the period [1/s].
struct Readings {
  const OfRun<std::int32_t>* counts = nullptr;
  const OfRun<float>& x;
  const OfRun<float>& heating_rate;
  const Vectors& f;
  const OfRun<double>& per_second;
};

/// u of a part of a run. What lies within eight samples beyond its end is read and written too.
void Solve(Lanes lanes, const GroupKernel& kernel, const Readings& readings, Part part, Vectors& u);

/// Numbers in single precision that stand apart: where the first is, and bytes to the next.
struct Apart {
  const std::byte* first = nullptr;
  std::size_t step = 0;
};

/// True temperatures of a piece from `at` on of what the thermometer's channel gives; see
/// TrueTemperature. Where the reading lies beyond the calibrated range, `inside` loses its bits.
void TakeTemperatures(Lanes lanes, const ThermometerCalibration& thermometer, const Apart& readings,
                      std::size_t at, OfRun<double>& temperature, OfRun<std::int64_t>& inside);

/// A cell of temperatures [degC] within a group's calibrated range.
struct CellPlace {
  double min = 0, max = 0, per_width = 1;
  double index = 0;  ///< of the cell, a whole number, counted from the range's beginning

  /// Place in the cell, where from 0 to below 1.
  template <class Number>
  [[gnu::always_inline]] void Find(const Number& temperature, Number& x) const {
    const Number low = min - Number{}, high = max - Number{};
    x = temperature < low ? low : temperature;
    x = ((high < x ? high : x) - min) * per_width - index;
  }
};

/// x of each temperature of a part; where it lies beyond the range `inside` loses its bits. Gives
/// whether all lie in the cell.
bool Place(Lanes lanes, const CellPlace& cell, const OfRun<double>& temperature, Part part,
           OfRun<float>& x, OfRun<std::int64_t>& inside);

}  // namespace wellgyro
