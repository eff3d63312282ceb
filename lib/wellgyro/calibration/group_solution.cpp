#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "wellgyro/base/units.h"
#include "wellgyro/calibration/group_solution_internal.h"

namespace wellgyro {
namespace {

constexpr double kRight = 1e-9, kSmallRight = 1e-5;  // of u; of small terms
constexpr double kLeft = 5e-11;                      // of u, by turns of the second order

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

// Largest differences of a group's solution over the calibrated range, per degC to their power:
// second ones of what moves u in proportion, [1/degC^2]; third ones of b over `unit`; first ones
// in proportion.
struct Bends {
  double curve = 0, third = 0, slope = 0;
};

Bends BendsOf(const GroupModel& model, const SensorGroup& group, double unit) {
  constexpr std::size_t kSteps = 64;
  const double H = (group.max - group.min) / kSteps;
  std::vector<GroupNode> nodes;
  for (std::size_t i = 0; i <= kSteps; ++i) {
    nodes.push_back(model.At(model.Tau(group.min + H * static_cast<double>(i)), 1));
  }
  Bends bends;
  const auto raise = [](double& to, const auto& value) {
    to = std::max(to, value.cwiseAbs().rowwise().sum().maxCoeff());
  };
  for (std::size_t i = 1; i < kSteps; ++i) {
    const GroupNode &before = nodes[i - 1], &at = nodes[i], &after = nodes[i + 1];
    const double tau = model.Tau(group.min + H * static_cast<double>(i));
    const SensorGroup::Column per_unit = model.UnitPerCount(1).cwiseInverse();
    const SensorGroup::Rows counts = per_unit.asDiagonal() * model.Sensitivity(tau);
    const SensorGroup::Column bias = per_unit.cwiseProduct(model.Bias(tau));
    const Eigen::Matrix<double, 3, 4> second = (after.A - 2 * at.A + before.A) / (H * H);
    raise(bends.curve, Eigen::Matrix3d(second * counts));
    raise(bends.curve, Eigen::Vector3d(second * bias / unit));
    raise(bends.curve, Eigen::Matrix3d((after.force - 2 * at.force + before.force) *
                                       (units::kStandardGravity / (unit * H * H))));
    raise(bends.slope, Eigen::Matrix3d((after.A - before.A) * counts / (2 * H)));
    if (i + 1 == kSteps) continue;
    const Eigen::Vector3d third = nodes[i + 2].b - 3 * after.b + 3 * at.b - before.b;
    raise(bends.third, Eigen::Vector3d(third / (unit * H * H * H)));
  }
  return bends;
}

// A straight line over a cell of width h is off by h^2 / 8 of the second derivative, a parabola by
// h^3 / (72 sqrt 3) of the third, a constant by h / 2 of the first. Half of what is allowed is left
// to derivatives between the places where they were taken.
double WidthOf(const Bends& bends, double range) {
  constexpr double kShare = 0.5;
  double width = range;
  const auto limit = [&](double allowed, double power, double factor, double derivative) {
    if (!(derivative > 0)) return;
    width = std::min(width, std::pow(kShare * allowed / (factor * derivative), 1 / power));
  };
  limit(kRight, 2, 1.0 / 8, bends.curve);
  limit(kRight, 3, 1 / (72 * std::sqrt(3.0)), bends.third);
  limit(kSmallRight, 1, 1.0 / 2, bends.slope);
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

template <class Number>
GroupKernel::Products<Number> ProductsOf(const Eigen::Matrix<double, 3, 6>& out) {
  GroupKernel::Products<Number> products;
  products.squares = !out.leftCols<3>().isZero(0);
  products.crosses = !out.rightCols<3>().isZero(0);
  for (int p = 0; p < 6; ++p) {
    for (int i = 0; i < 3; ++i) products.out[p][i] = out(i, p);
  }
  return products;
}

}  // namespace

Eigen::Vector3d RefineInDouble(const GroupKernel& kernel, const Eigen::Vector3d& linear) {
  static const std::array<double, kTurns> kReach = Reach();
  const double e = kernel.slope * linear.cwiseAbs().maxCoeff();
  Eigen::Vector3d u = linear;
  for (std::size_t turn = 0; turn < kTurns && e > kReach[turn]; ++turn) {
    const Eigen::Vector3d of = u;
    u = linear;
    for (int p = 0; p < 6; ++p) {
      const double q = p < 3 ? of[p] * of[p] : of[p - 3] * of[(p - 2) % 3];
      u -= q * Eigen::Vector3d::Map(kernel.products.out[p]);
    }
  }
  return u;
}

GroupSolution::GroupSolution(const SensorGroup& group, double unit)
    : model_(group), heats_(!group.heating.isZero(0)), per_lag_(1 / group.heating_lag) {
  constant_.n_channels = group.n_channels;
  for (std::size_t c = 0; c < constant_.channel.size(); ++c) {
    const std::size_t of = static_cast<int>(c) < group.n_channels ? c : 0;
    constant_.channel[c] = static_cast<std::size_t>(group.channel[of]);
  }
  if (group.thermometer < 0 || !(group.max > group.min)) return;
  constant_.varies = true;
  min_ = group.min;
  max_ = group.max;
  width_ = WidthOf(BendsOf(*model_, group, unit), max_ - min_);
  per_width_ = 1 / width_;
}

void GroupSolution::Enter(double temperature, double seconds) {
  if (Holds(temperature, seconds)) return;
  at_ = 1 - at_;
  if (Holds(temperature, seconds)) return;
  Cell& cell = cells_[at_];
  cell.index = std::floor(Place(temperature));
  cell.seconds = seconds;
  if (model_) Solve(cell);
}

void GroupSolution::Solve(Cell& cell) const {
  GroupKernel& kernel = cell.kernel = constant_;
  const double begin = min_ + cell.index * width_;
  const GroupNode low = At(begin, cell.seconds), middle = At(begin + width_ / 2, cell.seconds);
  Put(low.A, kernel.A);
  Put(low.b, kernel.b);
  Put(low.force, kernel.force);
  Put(middle.heat, kernel.heat);
  kernel.products = ProductsOf<double>(middle.products);
  kernel.products_single = ProductsOf<SameSingle>(middle.products);
  kernel.slope = middle.products.cwiseAbs().rowwise().sum().maxCoeff();
  kernel.second_order = kernel.slope > 0;
  const double reach = kernel.second_order ? kReachSingle / kernel.slope : 0;
  // Its square is a number in single precision.
  kernel.reach_square = std::min(reach * reach, 1e30);
  kernel.force_products = ProductsOf<SameSingle>(middle.force_products);
  const GroupNode high = constant_.varies ? At(begin + width_, cell.seconds) : low;
  const Eigen::Vector3d parabola = 2 * (high.b - 2 * middle.b + low.b);
  Put(Eigen::Matrix<double, 3, 4>(high.A - low.A), kernel.A1);
  Put(Eigen::Vector3d(high.b - low.b - parabola), kernel.b1);
  Put(parabola, kernel.b2);
  Put(Eigen::Matrix3d(high.force - low.force), kernel.force1);
  kernel.moved =
      heats_ || !low.force.isZero(0) || !high.force.isZero(0) || !middle.force_products.isZero(0);
}

double GroupSolution::Parity(const RawSample& raw, const Eigen::Vector3d& u_T,
                             const Eigen::Vector3d& f_T) const {
  return model_->Parity(raw, model_->Tau(temperature_), cells_[at_].seconds, heating_rate(), u_T,
                        f_T);
}

}  // namespace wellgyro
