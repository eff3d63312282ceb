#include <cmath>
#include <utility>

#include <Eigen/Dense>
#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/fit/bench_checks_internal.h"
#include "wellgyro/fit/tool_model_internal.h"
#include "wellgyro/math/linear_algebra.h"
#include "wellgyro/math/so3.h"

namespace wellgyro {
namespace {

// Exp(e) v and its change with e.
std::pair<Eigen::Vector3d, Eigen::Matrix3d> Turned(const Eigen::Vector3d& e,
                                                   const Eigen::Vector3d& v) {
  const Eigen::Vector3d turned = Exp(e) * v;
  return {turned, -Skew(turned) * LeftJacobian(e)};
}

}  // namespace

// What acts on a row, and by how much it changes with the nuisances (places, and vectors).
struct ToolModel::State {
  RowState row;
  struct Slope {
    int place = 0;
    Eigen::Vector3d w = Eigen::Vector3d::Zero(), f = Eigen::Vector3d::Zero();
  };
  std::vector<Slope> slopes;
};

ToolModel::ToolModel(const ToolReadings& readings, const ToolFitSetup& setup,
                     std::vector<ToolTerm> terms)
    : readings_(readings),
      setup_(setup),
      terms_(std::move(terms)),
      terms_of_(readings.channels.size()) {
  for (std::size_t k = 0; k < terms_.size(); ++k) {
    for (const TermUse& use : terms_[k].uses) {
      std::vector<int>& of_channel = terms_of_[static_cast<std::size_t>(use.channel)];
      if (of_channel.empty() || of_channel.back() != static_cast<int>(k)) {
        of_channel.push_back(static_cast<int>(k));
      }
    }
  }
  AddNuisances();
}

void ToolModel::AddNuisances() {
  level_.assign(static_cast<std::size_t>(readings_.n_tables), -1);
  inclination_ = rate_scale_ = level_;
  mount_.assign(static_cast<std::size_t>(3 * readings_.n_tables), -1);
  const auto add = [&](const std::string& name, double sigma, const char* unit = "rad") {
    nuisances_.push_back({name, 0, 0, sigma, unit});
    return static_cast<int>(nuisances_.size()) - 1;
  };
  for (const ToolRow& row : readings_.rows) {
    const auto table = static_cast<std::size_t>(row.table);
    if (row.mount >= 0) {
      int& place = mount_[static_cast<std::size_t>(row.mount)];
      if (place >= 0) continue;
      const std::string name =
          fmt::format("axis_{}_of_table_{}", "xyz"[row.mount % 3], row.table + 1);
      place = add(name + "[0]", setup_.sigma_axis);
      add(name + "[1]", setup_.sigma_axis);
      if (rate_scale_[table] < 0) {
        rate_scale_[table] =
            add(fmt::format("rate_scale_{}", row.table + 1), setup_.sigma_rate_scale, "1");
      }
      continue;
    }
    if (level_[table] >= 0) continue;
    level_[table] = add(fmt::format("level_{}[0]", row.table + 1), setup_.sigma_level);
    add(fmt::format("level_{}[1]", row.table + 1), setup_.sigma_level);
    if (readings_.n_gyro > 0) add(fmt::format("north_{}", row.table + 1), setup_.sigma_north);
    inclination_[table] =
        add(fmt::format("inclination_{}", row.table + 1), setup_.sigma_inclination);
  }
  if (readings_.n_gyro > 0) latitude_ = add("latitude", setup_.sigma_latitude);
}

std::vector<std::string> ToolModel::names() const {
  std::vector<std::string> all;
  for (const ToolTerm& term : terms_) all.push_back(term.name);
  for (const BenchNuisance& nuisance : nuisances_) all.push_back(nuisance.name);
  return all;
}

// Level and north turn the bench, the zero of inclination the tool in it.
void ToolModel::AtRest(const ToolRow& row, const Eigen::VectorXd& z, double latitude,
                       State& state) const {
  const int place = level_[static_cast<std::size_t>(row.table)];
  const int zero = inclination_[static_cast<std::size_t>(row.table)];
  const bool north = readings_.n_gyro > 0;
  const Eigen::Vector3d e(z[place], z[place + 1], north ? z[place + 2] : 0);
  const Eigen::Vector3d w_L =
      kBenchEarthDegPerHour * Eigen::Vector3d(std::cos(latitude), 0, -std::sin(latitude));
  const auto [w, dw] = Turned(e, w_L);
  const auto [f, df] = Turned(e, -Eigen::Vector3d::UnitZ());
  // A tool inclined by more sees what acts on it turned by less.
  const Eigen::Matrix3d R_BL = row.R_BL * Exp(-z[zero] * row.across_L);
  state.row.w_B = R_BL * w;
  state.row.f_B = R_BL * f;
  for (int k = 0; k < (north ? 3 : 2); ++k) {
    state.slopes.push_back({place + k, R_BL * dw.col(k), R_BL * df.col(k)});
  }
  state.slopes.push_back({zero, -(R_BL * row.across_L.cross(w)), -(R_BL * row.across_L.cross(f))});
  if (latitude_ >= 0) {
    const Eigen::Vector3d by(-std::sin(latitude), 0, -std::cos(latitude));
    state.slopes.push_back(
        {latitude_, R_BL * Turned(e, kBenchEarthDegPerHour * by).first, {0, 0, 0}});
  }
}

// The table turns by its rate, of unknown scale, and the Earth's beside that.
void ToolModel::OnTable(const ToolRow& row, const Eigen::VectorXd& z, double latitude,
                        State& state) const {
  const int place = mount_[static_cast<std::size_t>(row.mount)], axis = row.mount % 3;
  const int scale = rate_scale_[static_cast<std::size_t>(row.table)];
  const Eigen::Vector3d n = Eigen::Vector3d::Unit(axis);
  const Eigen::Vector3d e[] = {Eigen::Vector3d::Unit((axis + 1) % 3),
                               Eigen::Vector3d::Unit((axis + 2) % 3)};
  const Eigen::Vector3d leaning = n + z[place] * e[0] + z[place + 1] * e[1];
  const Eigen::Vector3d up = leaning.normalized();
  const double rate = (1 + z[scale]) * row.rate + kBenchEarthDegPerHour * std::sin(latitude);
  state.row.w_B = rate * up;
  state.row.f_B = up;
  for (int k = 0; k < 2; ++k) {
    const Eigen::Vector3d by = (e[k] - up * up.dot(e[k])) / leaning.norm();
    state.slopes.push_back({place + k, rate * by, by});
  }
  state.slopes.push_back({scale, row.rate * up, {0, 0, 0}});
  state.slopes.push_back({latitude_, kBenchEarthDegPerHour * std::cos(latitude) * up, {0, 0, 0}});
}

ToolModel::State ToolModel::StateOf(const ToolRow& row, const Eigen::VectorXd& x) const {
  State state;
  state.row.row = &row;
  state.row.tau = (row.temperature - readings_.middle) / readings_.half_range;
  const auto z = x.tail(static_cast<Eigen::Index>(nuisances_.size()));
  const double stated = setup_.reference.latitude.value_or(0);
  const double latitude = stated + (latitude_ >= 0 ? z[latitude_] : 0);
  if (row.mount >= 0) {
    OnTable(row, z, latitude, state);
  } else {
    AtRest(row, z, latitude, state);
  }
  const double unit =
      readings_.gravity_signed ? -setup_.reference.gravity : setup_.reference.gravity;
  state.row.u_accel_B = unit * state.row.f_B;
  return state;
}

ToolModel::Prediction ToolModel::At(const ToolRow& row, const Eigen::VectorXd& x) const {
  const State state = StateOf(row, x);
  const auto n = static_cast<Eigen::Index>(row.channels.size());
  Prediction p{Eigen::VectorXd::Zero(n), Eigen::MatrixXd::Zero(n, size()),
               Eigen::MatrixXd::Zero(n, 3)};
  const double unit =
      readings_.gravity_signed ? -setup_.reference.gravity : setup_.reference.gravity;
  for (Eigen::Index i = 0; i < n; ++i) {
    const int c = row.channels[static_cast<std::size_t>(i)];
    const bool is_gyro = readings_.channels[static_cast<std::size_t>(c)].is_gyro;
    // Of the rate, and of the force over gravity.
    Eigen::Vector3d by_w = Eigen::Vector3d::Zero(), by_f = Eigen::Vector3d::Zero();
    for (const int k : terms_of_[static_cast<std::size_t>(c)]) {
      for (const TermUse& use : terms_[static_cast<std::size_t>(k)].uses) {
        if (use.channel != c) continue;
        const Basis basis = BasisOf(terms_[static_cast<std::size_t>(k)], use, is_gyro, state.row);
        p.v[i] += x[k] * basis.value;
        p.J(i, k) += basis.value;
        if (is_gyro) by_w += x[k] * basis.by_own_B;
        if (!is_gyro) by_f += x[k] * unit * basis.by_own_B;
        by_f += x[k] * basis.by_force_B;
      }
    }
    for (const State::Slope& slope : state.slopes) {
      p.J(i, n_terms() + slope.place) += by_w.dot(slope.w) + by_f.dot(slope.f);
    }
    // A tool turned by e sees v as v - e x v.
    p.wobble.row(i) =
        by_w.transpose() * Skew(state.row.w_B) + by_f.transpose() * Skew(state.row.f_B);
  }
  return p;
}

Eigen::MatrixXd ToolModel::Whitener(const ToolRow& row, const Eigen::MatrixXd& wobble,
                                    const ToolNoise& noise) const {
  const auto n = static_cast<Eigen::Index>(row.channels.size());
  const double turn = noise.WobbleOf(row);
  Eigen::MatrixXd cov = turn * turn * wobble * wobble.transpose();
  for (Eigen::Index i = 0; i < n; ++i) {
    const int c = row.channels[static_cast<std::size_t>(i)];
    const bool is_gyro = readings_.channels[static_cast<std::size_t>(c)].is_gyro;
    const double sigma = !is_gyro ? noise.accel : row.mount >= 0 ? noise.gyro_table : noise.gyro;
    cov(i, i) += sigma * sigma;
  }
  return Cholesky(cov).Whitened(Eigen::MatrixXd::Identity(n, n));
}

}  // namespace wellgyro
