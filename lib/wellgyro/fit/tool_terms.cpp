#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/fit/tool_terms_internal.h"
#include "wellgyro/record/products.h"

namespace wellgyro {
namespace {

std::string Suffix(int power) { return power == 0 ? "" : fmt::format("_tau{}", power); }

// The builder of one group's bundles.
class Candidates {
 public:
  Candidates(const ToolReadings& readings, const ToolFitSetup& setup)
      : readings_(readings), setup_(setup) {}

  std::vector<TermBundle> Bundles() {
    for (const bool gyro : {false, true}) {
      if ((gyro ? readings_.n_gyro : readings_.n_accel) > 0) Group(gyro);
    }
    std::stable_partition(bundles_.begin(), bundles_.end(),
                          [](const TermBundle& b) { return b.needed; });
    for (TermBundle& bundle : bundles_) bundle.after = PlaceOf(after_[bundle.name]);
    return std::move(bundles_);
  }

 private:
  int PlaceOf(const std::string& name) const {
    for (std::size_t i = 0; i < bundles_.size(); ++i) {
      if (bundles_[i].name == name) return static_cast<int>(i);
    }
    return -1;
  }
  int First(bool gyro) const { return gyro ? readings_.n_accel : 0; }
  int Count(bool gyro) const { return gyro ? readings_.n_gyro : readings_.n_accel; }
  static std::string Prefix(bool gyro) { return gyro ? "gyro_" : "accel_"; }

  TermBundle& Add(const std::string& name, bool needed, const std::string& after = "") {
    after_[name] = after;
    bundles_.push_back({name, {}, needed, -1});
    return bundles_.back();
  }
  // One coefficient a channel.
  void AddVector(bool gyro, const std::string& name, TermKind kind, int power, int table,
                 bool needed, const std::string& after) {
    TermBundle& bundle = Add(name, needed, after);
    for (int c = 0; c < Count(gyro); ++c) {
      bundle.terms.push_back(
          {fmt::format("{}[{}]", name, c), kind, power, table, {{First(gyro) + c, 0, 1}}});
    }
  }
  // Three coefficients a channel.
  void AddMatrix(bool gyro, const std::string& name, TermKind kind, int power,
                 const std::vector<int>& channels, bool needed, const std::string& after) {
    TermBundle& bundle = Add(name, needed, after);
    for (const int c : channels) {
      for (int j = 0; j < 3; ++j) {
        bundle.terms.push_back(
            {fmt::format("{}[{},{}]", name, c, j), kind, power, -1, {{First(gyro) + c, j, 1}}});
      }
    }
  }
  std::vector<int> All(bool gyro) const {
    std::vector<int> channels(static_cast<std::size_t>(Count(gyro)));
    std::iota(channels.begin(), channels.end(), 0);
    return channels;
  }
  // Along each accelerometer's own axis a, and across it. With the products of a position's force
  // u_a^2 + u_b^2 + u_c^2 = g^2 is one with the bias: across there are u_b^2 - u_c^2 and the three
  // products of two axes.
  void AddSquares() {
    TermBundle& bundle = Add("accel_K2", false);
    for (int c = 0; c < 3; ++c) {
      bundle.terms.push_back(
          {fmt::format("accel_K2[{},{}]", c, c), TermKind::kSquare, 0, -1, {{c, c, 1}}});
    }
    TermBundle& cross = Add("accel_K2_cross", false, "accel_K2");
    for (int c = 0; c < 3; ++c) {
      const int b = (c + 1) % 3, other = (c + 2) % 3;
      cross.terms.push_back({fmt::format("accel_K2[{},{}]", c, b),
                             TermKind::kSquare,
                             0,
                             -1,
                             {{c, b, 1}, {c, other, -1}}});
      for (int j = 3; j < 6; ++j) {
        cross.terms.push_back(
            {fmt::format("accel_K2[{},{}]", c, j), TermKind::kSquare, 0, -1, {{c, j, 1}}});
      }
    }
  }

  void Rotors(int power, const std::string& after) {
    TermBundle& bundle = Add("gyro_MQ" + Suffix(power), power == 0, after);
    for (std::size_t k = 0; k < readings_.rotors.size(); ++k) {
      const Rotor& rotor = readings_.rotors[k];
      const int first = First(true), a = first + rotor.a, c = first + rotor.c;
      const int axis_a = readings_.channels[static_cast<std::size_t>(a)].axis;
      const int axis_c = readings_.channels[static_cast<std::size_t>(c)].axis;
      const std::string at = Suffix(power) + fmt::format("[{}]", k);
      bundle.terms.push_back(
          {"gyro_M" + at, TermKind::kForce, power, -1, {{a, axis_a, 1}, {c, axis_c, 1}}});
      bundle.terms.push_back(
          {"gyro_Q" + at, TermKind::kForce, power, -1, {{a, axis_c, 1}, {c, axis_a, -1}}});
    }
  }
  void Anisoelastic() {
    TermBundle& bundle = Add("gyro_N", false);
    for (const Rotor& rotor : readings_.rotors) {
      for (const int c : {rotor.a, rotor.c}) {
        const int channel = First(true) + c;
        const int axis = readings_.channels[static_cast<std::size_t>(channel)].axis;
        const int place = PlaceOfProduct(axis, rotor.spin);
        bundle.terms.push_back({fmt::format("gyro_N[{},{}]", c, place),
                                TermKind::kForceSquare,
                                0,
                                -1,
                                {{channel, place, 1}}});
      }
    }
  }

  // Channels that feel any of the force's components: without a rotor, unless all are to.
  std::vector<int> OfFullForce() const {
    std::vector<int> channels = All(true);
    if (setup_.force == GyroForceModel::kFull) return channels;
    if (setup_.force) return {};
    for (const Rotor& rotor : readings_.rotors) {
      channels.erase(std::remove_if(channels.begin(), channels.end(),
                                    [&](int c) { return c == rotor.a || c == rotor.c; }),
                     channels.end());
    }
    return channels;
  }
  bool HasRotors() const {
    return !readings_.rotors.empty() &&
           setup_.force.value_or(GyroForceModel::kDualAxis) == GyroForceModel::kDualAxis;
  }
  // Gyro by gyro: M, Q and N of those that share a rotor, three components of each other's.
  void Forces() {
    const std::vector<int> full = OfFullForce();
    const int powers = readings_.has_temperature ? 2 : 1;
    for (int n = 0; n < powers; ++n) {
      if (HasRotors()) Rotors(n, n > 0 ? "gyro_MQ" : "");
      const std::string name = "gyro_G" + Suffix(n);
      if (!full.empty()) {
        AddMatrix(true, name, TermKind::kForce, n, full, n == 0, n > 0 ? "gyro_G" : "");
      }
    }
    if (HasRotors()) Anisoelastic();
  }

  void Temperatures(bool gyro) {
    const std::string p = Prefix(gyro);
    for (int n = 1; n <= setup_.max_degree; ++n) {
      AddVector(gyro, p + "b" + Suffix(n), TermKind::kBias, n, -1, false,
                n > 1 ? p + "b" + Suffix(n - 1) : "");
    }
    for (int n = 1; n <= std::min(2, setup_.max_degree); ++n) {
      AddMatrix(gyro, p + "S" + Suffix(n), TermKind::kSensitivity, n, All(gyro), false,
                n > 1 ? p + "S" + Suffix(n - 1) : "");
    }
    AddVector(gyro, p + "heating", TermKind::kHeating, 0, -1, false, "");
    AddVector(gyro, p + "hysteresis", TermKind::kHysteresis, 0, -1, false, "");
  }

  void Group(bool gyro) {
    const std::string p = Prefix(gyro);
    AddVector(gyro, p + "b", TermKind::kBias, 0, -1, true, "");
    AddMatrix(gyro, p + "S", TermKind::kSensitivity, 0, All(gyro), true, "");
    if (gyro) Forces();
    if (!gyro) AddSquares();
    if (readings_.has_temperature) Temperatures(gyro);
    for (int table = 0; table < readings_.n_tables; ++table) Drifts(gyro, table);
  }

  // What a gyro's may be is known before: on a ramp its line cannot be told from the temperature's
  // slope, nor its bend from the square of the temperature, and what readings do not tell apart no
  // choice of terms may decide. A bias that walks has a line and a bend t^2 - 1/3 beside it: by
  // Legendre's polynomials of a Wiener process, variances as (2 / (2n + 3) + 2 / (2n - 1)) / 4, the
  // bend's coefficient is .945 of the line's.
  void Drifts(bool gyro, int table) {
    constexpr double kBend = 0.945;
    const std::string name = fmt::format("{}drift_{}", Prefix(gyro), table + 1);
    for (const int power : {1, 2}) {
      AddVector(gyro, power == 1 ? name : name + "_bend", TermKind::kDrift, power, table, gyro,
                power == 1 ? "" : name);
      for (ToolTerm& term : bundles_.back().terms) {
        term.prior_sigma = gyro ? (power == 1 ? 1 : kBend) * setup_.sigma_drift : 0;
      }
    }
  }

  const ToolReadings& readings_;
  const ToolFitSetup& setup_;
  std::vector<TermBundle> bundles_;
  std::map<std::string, std::string> after_;
};

}  // namespace

std::vector<TermBundle> CandidateTerms(const ToolReadings& readings, const ToolFitSetup& setup) {
  return Candidates(readings, setup).Bundles();
}

Basis BasisOf(const ToolTerm& term, const TermUse& use, bool is_gyro, const RowState& state) {
  const Eigen::Vector3d& own = is_gyro ? state.w_B : state.u_accel_B;
  const double tau = std::pow(state.tau, term.power);
  Basis basis;
  const auto product = [&](const Eigen::Vector3d& a, Eigen::Vector3d* by) {
    const int i = kFirstFactor[use.j], k = kSecondFactor[use.j];
    basis.value = use.sign * a[i] * a[k];
    (*by)[i] += use.sign * a[k];
    (*by)[k] += use.sign * a[i];
  };
  switch (term.kind) {
    case TermKind::kBias:
      basis.value = tau;
      break;
    case TermKind::kSensitivity:
      basis.value = tau * own[use.j];
      basis.by_own_B[use.j] = tau;
      break;
    case TermKind::kSquare:
      product(own, &basis.by_own_B);
      break;
    case TermKind::kForce:
      basis.value = use.sign * tau * state.f_B[use.j];
      basis.by_force_B[use.j] = use.sign * tau;
      break;
    case TermKind::kForceSquare:
      product(state.f_B, &basis.by_force_B);
      break;
    case TermKind::kHeating:
      basis.value = state.row->heating;
      break;
    case TermKind::kHysteresis:
      basis.value = state.row->branch * (1 - state.tau * state.tau);
      break;
    case TermKind::kDrift:
      // Of the mean over the table nothing: that is the bias.
      if (state.row->table != term.table) break;
      basis.value = term.power == 1 ? state.row->time : state.row->time * state.row->time - 1.0 / 3;
      break;
  }
  return basis;
}

}  // namespace wellgyro
