#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "wellgyro/base/units.h"
#include "wellgyro/calibration/group_solution_internal.h"

namespace wellgyro {
namespace {

// Of u, by interpolation: 10 deg/s are right to 4e-5 deg/h, gravity to 1e-9 g. Small terms,
// some thousandths of u, to 1e-5: 1e-8 of u for each thousandth.
constexpr double kRight = 1e-9, kSmallRight = 1e-5;
constexpr double kLeft = 5e-11;  // of u, by turns of the second order: a twentieth of kRight

// Largest e for which n turns of RefineInDouble are enough. All u_n are below |u_0| s, s = 1 / (1 -
// 2 e); the first is off by e s^2 |u_0|, and each turn leaves 2 e s of it.
constexpr std::size_t kTurns = 64;
std::array<double, kTurns> Reach() {
  std::array<double, kTurns> reach{};
  for (std::size_t turns = 0; turns < reach.size(); ++turns) {
    double low = 0, high = 0.25;
    for (int halving = 0; halving < 60; ++halving) {
      const double e = (low + high) / 2, s = 1 / (1 - 2 * e);
      const double left = std::pow(2 * e * s, static_cast<double>(turns)) * e * s * s;
      (left < kLeft ? low : high) = e;
    }
    reach[turns] = low;
  }
  return reach;
}

// How far a group's solution goes over the calibrated range, per degC to the derivative's power.
struct Bends {
  double slope = 0, third = 0;  // of what moves u in proportion, and of b over `unit`
  double curve = 0;             // of what moves u in proportion: of small terms over themselves
  double force = 0;             // second derivative over what may be left of it
};

template <class Value>
double RowSum(const Value& value) {
  return value.cwiseAbs().rowwise().sum().maxCoeff();
}

Bends BendsOf(const GroupModel& model, const SensorGroup& group, double unit) {
  constexpr std::size_t kSteps = 64;
  const double H = (group.max - group.min) / kSteps;
  std::vector<GroupNode> nodes;
  for (std::size_t i = 0; i <= kSteps; ++i) {
    nodes.push_back(model.At(model.Tau(group.min + H * static_cast<double>(i))));
  }
  const SensorGroup::Column per_unit = model.unit_per_count().cwiseInverse();
  Bends bends;
  for (std::size_t i = 1; i < kSteps; ++i) {
    const GroupNode &before = nodes[i - 1], &at = nodes[i], &after = nodes[i + 1];
    const double tau = model.Tau(group.min + H * static_cast<double>(i));
    const SensorGroup::Rows counts = per_unit.asDiagonal() * model.Sensitivity(tau);
    const SensorGroup::Column bias = per_unit.cwiseProduct(model.Bias(tau)) / unit;
    const auto raise = [](double& to, double value) { to = std::max(to, value); };
    // Roundings are of each product by itself.
    const Eigen::Matrix<double, 3, 4> first = ((after.A - before.A) / (2 * H)).cwiseAbs();
    raise(bends.slope, RowSum(first * counts.cwiseAbs()) + RowSum(first * bias.cwiseAbs()) +
                           RowSum((after.b_T - before.b_T) / (2 * H * unit)));
    raise(bends.curve, RowSum((after.A - 2 * at.A + before.A) * counts / (H * H)));
    const double left =
        kSmallRight * RowSum(at.u_by_force_T) + kRight * unit / units::kStandardGravity;
    raise(
        bends.force,
        RowSum((after.u_by_force_T - 2 * at.u_by_force_T + before.u_by_force_T) / (H * H)) / left);
    if (i + 1 == kSteps) continue;
    const GroupNode& next = nodes[i + 2];
    const Eigen::Matrix<double, 3, 4> third = next.A - 3 * after.A + 3 * at.A - before.A;
    const Eigen::Vector3d third_b = (next.b_T - 3 * after.b_T + 3 * at.b_T - before.b_T) / unit;
    raise(bends.third, (RowSum(third * counts) + RowSum(third * bias + third_b)) / (H * H * H));
  }
  return bends;
}

// A straight line over a cell of width h is off by h^2 / 8 of the second derivative, a parabola by
// h^3 / (72 sqrt 3) of the third; what goes through the cell is rounded three times in single
// precision: to each of these two half of what is allowed. Derivatives of polynomials of third
// degree change little between 64 places.
double WidthOf(const Bends& bends, double range) {
  constexpr double kShare = 0.5, kRounded = 3 * 0x1p-24;
  double width = range;
  const auto limit = [&](double allowed, double power, double factor, double derivative) {
    if (!(derivative > 0)) return;
    width = std::min(width, std::pow(kShare * allowed / (factor * derivative), 1 / power));
  };
  limit(kRight, 3, 1 / (72 * std::sqrt(3.0)), bends.third);
  limit(kRight, 1, kRounded, bends.slope);
  limit(kSmallRight, 2, 1.0 / 8, bends.curve);
  limit(1, 2, 1.0 / 8, bends.force);
  return width;
}

template <class Number, int kColumns>
void Put(const Eigen::Matrix<double, 3, kColumns>& from, Number (&to)[3][kColumns]) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < kColumns; ++j) to[i][j] = from(i, j);
  }
}

template <class Number>
void Put(const Eigen::Vector3d& from, Number (&to)[3]) {
  for (int i = 0; i < 3; ++i) to[i] = from[i];
}

// From one end of a cell to the other.
template <class Number>
void Put(const Eigen::Matrix<double, 3, 6>& low, const Eigen::Matrix<double, 3, 6>& high,
         GroupKernel::Products<Number>& to) {
  to.squares = !low.leftCols<3>().isZero(0) || !high.leftCols<3>().isZero(0);
  to.crosses = !low.rightCols<3>().isZero(0) || !high.rightCols<3>().isZero(0);
  for (int p = 0; p < 6; ++p) {
    if (!(p < 3 ? to.squares : to.crosses)) continue;
    for (int i = 0; i < 3; ++i) {
      to.out[p][i] = low(i, p);
      to.out1[p][i] = high(i, p) - low(i, p);
    }
  }
}

}  // namespace

Eigen::Vector3d RefineInDouble(const GroupKernel& kernel, double x,
                               const Eigen::Vector3d& linear_T) {
  static const std::array<double, kTurns> kReach = Reach();
  const double e = kernel.slope * linear_T.cwiseAbs().maxCoeff();
  using Column = Eigen::Map<const Eigen::Vector3d>;
  Eigen::Vector3d u = linear_T;
  for (std::size_t turn = 0; turn < kTurns && e > kReach[turn]; ++turn) {
    const Eigen::Vector3d of = u;
    u = linear_T;
    for (int p = 0; p < 6; ++p) {
      const double q = p < 3 ? of[p] * of[p] : of[p - 3] * of[(p - 2) % 3];
      u -= q * (Column(kernel.products.out[p]) + x * Column(kernel.products.out1[p]));
    }
  }
  return u;
}

GroupSolution::GroupSolution(const SensorGroup& group, double unit)
    : model_(group), per_lag_(1 / group.heating_lag) {
  GroupKernel& kernel = cells_[0].kernel;
  kernel.n_channels = group.n_channels;
  for (std::size_t c = 0; c < kernel.channel.size(); ++c) {
    const std::size_t of = static_cast<int>(c) < group.n_channels ? c : 0;
    kernel.channel[c] = static_cast<std::size_t>(group.channel[of]);
  }
  kernel.pulses = group.per_second;
  kernel.heats = !group.heating.isZero(0);
  kernel.varies = group.thermometer >= 0 && group.max > group.min;
  cells_[1].kernel = kernel;
  if (group.thermometer >= 0) first_ = {.min = group.min, .max = group.max};
  if (!kernel.varies) return;
  const double range = group.max - group.min;
  // Cells end where the range does: beyond it the formula bends.
  first_.per_width = std::ceil(range / WidthOf(BendsOf(*model_, group, unit), range)) / range;
}

bool GroupSolution::Enter(double temperature) {
  if (Holds(temperature)) return false;
  at_ = 1 - at_;
  if (Holds(temperature)) return true;
  Cell& cell = cells_[at_];
  double place = 0;
  first_.Find(temperature, place);
  cell.place = first_;
  cell.place.index = std::floor(place);
  if (model_) Solve(cell, cells_[1 - at_]);
  cell.solved = true;
  return true;
}

// What is kept of `ahead_` over this time. Samples follow each other evenly.
void GroupSolution::Step(std::int64_t since) {
  if (since == step_ns_) return;
  step_ns_ = since;
  kept_ = std::exp(-1e-9 * static_cast<double>(since) * per_lag_);
}

void GroupSolution::Heat(const HeatSteps& steps, std::size_t n, const double* temperature,
                         float* rate) {
  std::array<double, kPiece> ahead;
  if (steps.even) {
    Step(steps.since[0]);
    const double kept = kept_;
    ahead[0] = ahead_ * kept + (temperature[0] - temperature_);
    for (std::size_t k = 1; k < kPiece; ++k) {
      ahead[k] = ahead[k - 1] * kept + (temperature[k] - temperature[k - 1]);
    }
  } else {
    for (std::size_t k = 0; k < n; ++k) {
      Step(steps.since[k]);
      ahead_ = ahead[k] = ahead_ * kept_ + (temperature[k] - temperature_);
      temperature_ = temperature[k];
    }
    std::fill(ahead.begin() + static_cast<std::ptrdiff_t>(n), ahead.end(), 0.0);
  }
  ahead_ = ahead[n - 1];
  temperature_ = temperature[n - 1];
  for (std::size_t k = 0; k < kPiece; ++k) rate[k] = static_cast<float>(ahead[k] * per_lag_);
}

// A neighbour has one of its ends.
void GroupSolution::Solve(Cell& cell, const Cell& other) const {
  GroupKernel& kernel = cell.kernel;
  const double index = cell.place.index, width = 1 / first_.per_width;
  const auto end = [&](double n) { return At(first_.min + n * width); };
  const bool above = other.solved && other.place.index + 1 == index;
  const bool below = other.solved && other.place.index == index + 1;
  const GroupNode& low = cell.low = above ? other.high : end(index);
  const GroupNode middle = kernel.varies ? end(index + 0.5) : low;
  const GroupNode& high = cell.high = !kernel.varies ? low : below ? other.low : end(index + 1);
  Put(low.A, kernel.A);
  Put(low.b_T, kernel.b);
  const Eigen::Matrix<double, 3, 4> bend_A = 2 * (high.A - 2 * middle.A + low.A);
  const Eigen::Vector3d bend_b = 2 * (high.b_T - 2 * middle.b_T + low.b_T);
  Put(Eigen::Matrix<double, 3, 4>(high.A - low.A - bend_A), kernel.A1);
  Put(bend_A, kernel.A2);
  Put(Eigen::Vector3d(high.b_T - low.b_T - bend_b), kernel.b1);
  Put(bend_b, kernel.b2);
  if (kernel.heats) {
    Put(low.heat_T, kernel.heat);
    Put(Eigen::Vector3d(high.heat_T - low.heat_T), kernel.heat1);
  }
  Put(low.force_products, high.force_products, kernel.force_products);
  kernel.feels_force = !low.u_by_force_T.isZero(0) || !high.u_by_force_T.isZero(0) ||
                       kernel.force_products.squares || kernel.force_products.crosses;
  kernel.moved = kernel.feels_force || kernel.heats;
  for (int i = 0; kernel.feels_force && i < 3; ++i) {
    Put(Eigen::Vector3d(low.u_by_force_T.col(i)), kernel.force[i]);
    Put(Eigen::Vector3d(high.u_by_force_T.col(i) - low.u_by_force_T.col(i)), kernel.force1[i]);
  }
  Put(low.products, high.products, kernel.products);
  Put(low.products, high.products, kernel.products_single);
  kernel.slope = std::max(RowSum(low.products), RowSum(high.products));
  kernel.second_order = kernel.slope > 0;
  const double reach = kernel.second_order ? kReachSingle / kernel.slope : 0;
  // Its square is a number in single precision.
  kernel.reach_square = static_cast<float>(std::min(reach * reach, 1e30));
}

double GroupSolution::Parity(const RawSample& raw, double temperature, double heating_rate,
                             const Eigen::Vector3d& u_T, const Eigen::Vector3d& f_T) const {
  const double seconds = static_cast<double>(std::max(raw.stamp.period_ns, 1)) * 1e-9;
  return model_->Parity(raw, model_->Tau(temperature), seconds, heating_rate, u_T, f_T);
}

}  // namespace wellgyro
