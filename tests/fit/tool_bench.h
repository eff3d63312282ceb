#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "fit/bench_simulation.h"

/// A whole tool on a bench in a chamber, by formulas of its own: three accelerometers (gravity-
/// signed, g) and two rotors' gyros (deg/h), both by temperature. tau is (T - 87.5) / 62.5 degC.
namespace wellgyro::test {

struct ThermalTool {
  Eigen::Vector3d ba[4], K2;
  Eigen::Matrix3d Sa[2];
  Eigen::Vector4d bg[4], N, heating;
  Eigen::Matrix<double, 4, 3> U;
  Eigen::Vector4d MQ[2];  ///< M, Q of rotor 0, then of rotor 1; by power

  static ThermalTool Any(Random& random) {
    ThermalTool tool;
    const auto four = [&](double sigma) {
      return Eigen::Vector4d(sigma * Eigen::Vector4d{random.Normal(), random.Normal(),
                                                     random.Normal(), random.Normal()});
    };
    const double of_accel[] = {5e-3, 4e-3, 2e-3, 1e-3}, of_gyro[] = {2, 1.5, 0.8, 0.5};
    for (int n = 0; n < 4; ++n) {
      tool.ba[n] = Noise(random, of_accel[n]);
      tool.bg[n] = four(of_gyro[n]);
    }
    tool.Sa[0] = Eigen::Matrix3d::Identity() + NoiseMatrix(random, 5e-3);
    tool.Sa[1] = NoiseMatrix(random, 2e-3);
    tool.K2 = Noise(random, 2e-3);
    tool.U << 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 0;
    for (int c = 0; c < 4; ++c) tool.U.row(c) += Noise(random, 3e-3).transpose();
    tool.MQ[0] = four(3);
    tool.MQ[1] = four(0.5);
    tool.N = four(0.5);
    tool.heating = four(100);
    return tool;
  }
  Eigen::Vector3d Accel(const Eigen::Vector3d& G, double tau) const {
    const Eigen::Vector3d b = ba[0] + tau * (ba[1] + tau * (ba[2] + tau * ba[3]));
    return b + (Sa[0] + tau * Sa[1]) * G + K2.cwiseProduct(G.cwiseAbs2());
  }
  Eigen::Vector4d Gyro(const Eigen::Vector3d& w, const Eigen::Vector3d& f, double tau,
                       double dTdt) const {
    Eigen::Vector4d m =
        bg[0] + tau * (bg[1] + tau * (bg[2] + tau * bg[3])) + U * w + heating * dTdt;
    const Eigen::Vector4d mq = MQ[0] + tau * MQ[1];
    m[0] += mq[0] * f.x() + mq[1] * f.y() + N[0] * f.x() * f.z();
    m[1] += mq[0] * f.y() - mq[1] * f.x() + N[1] * f.y() * f.z();
    m[3] += mq[2] * f.x() + mq[3] * f.z() + N[3] * f.x() * f.y();
    m[2] += mq[2] * f.z() - mq[3] * f.x() + N[2] * f.z() * f.y();
    return m;
  }
};

struct ThermalBench {
  double latitude = 60;       ///< stated [deg]
  double latitude_error = 0;  ///< true less stated [rad]
  Eigen::Vector3d level[2];   ///< turn of each positions' table: about north, east, down [rad]
  Eigen::Vector2d seat[3];    ///< of the tool on the rate table, by axis [rad]
  double rate_scale = 0;      ///< by how much more the rate table turns than it says
  Eigen::Vector4d drift[3];   ///< from the middle to the end of a table [deg/h]
  /// Of t^2 - 1/3 beside it, t from -1 to 1 over the table [deg/h].
  Eigen::Vector4d bend[3] = {Eigen::Vector4d::Zero(), Eigen::Vector4d::Zero(),
                             Eigen::Vector4d::Zero()};
  double wobble = 20 * kRad / 3600;
  double sigma_accel = 2e-5, sigma_gyro = 0.02, sigma_table = 0.5;

  static ThermalBench Any(Random& random) {
    ThermalBench bench;
    bench.latitude_error = 1e-5 * random.Normal();
    for (int table = 0; table < 2; ++table) {
      bench.level[table] = kRad * Eigen::Vector3d{0.3 * random.Normal(), 0.3 * random.Normal(),
                                                  0.5 * random.Normal()};
    }
    for (Eigen::Vector4d& drift : bench.drift) {
      for (double& d : drift) d = 0.1 * random.Normal();
    }
    for (Eigen::Vector2d& seat : bench.seat) {
      seat = 1.5e-4 * Eigen::Vector2d{random.Normal(), random.Normal()};
    }
    return bench;
  }
  /// A drift that walks has a bend beside its line, .945 of it.
  void Bend(Random& random) {
    for (Eigen::Vector4d& b : bend) {
      for (double& d : b) d = 0.0945 * random.Normal();
    }
  }
  Eigen::Vector4d DriftAt(int table, double t) const {
    return t * drift[table] + (t * t - 1.0 / 3) * bend[table];
  }
};

inline Eigen::Matrix3d TurnBy(const Eigen::Vector3d& e) {
  return e.norm() > 0 ? Eigen::AngleAxisd(e.norm(), e.normalized()).toRotationMatrix()
                      : Eigen::Matrix3d::Identity();
}

/// `n` positions spread over all attitudes in any order, the temperature on a ramp between `cold`
/// and `hot`, two minutes each.
inline BenchTable ThermalPositions(const ThermalTool& tool, const ThermalBench& bench, int which,
                                   int n, double cold, double hot, Random& random) {
  TableMaker table(
      {"t_s", "T_C", "inc", "az", "tf", "Gx", "Gy", "Gz", "m_x1", "m_y1", "m_z2", "m_x2"});
  const double L = bench.latitude * kRad + bench.latitude_error;
  const Eigen::Matrix3d R = TurnBy(bench.level[which]);
  const Eigen::Vector3d w_ned = R * Eigen::Vector3d(kEarth * std::cos(L), 0, -kEarth * std::sin(L));
  const Eigen::Vector3d g_ned = R * Eigen::Vector3d(0, 0, 1);
  const double dTdt = (hot - cold) / (120.0 * (n - 1));
  std::vector<int> order(120);
  std::iota(order.begin(), order.end(), 0);
  for (std::size_t i = 0; i < order.size(); ++i) {
    std::swap(order[i], order[static_cast<std::size_t>(random.Uniform() * 120)]);
  }
  for (int i = 0; i < n; ++i) {
    const int at = order[static_cast<std::size_t>(i % 120)];
    const Attitude a{45.0 * (at / 24), 90.0 * (at / 6 % 4), 60.0 * (at % 6)};
    const double T = cold + (hot - cold) * i / (n - 1), tau = (T - 87.5) / 62.5;
    const double t = -1 + 2.0 * i / (n - 1);
    const Eigen::Matrix3d wobble = TurnBy(-Noise(random, bench.wobble));
    const Eigen::Vector3d w = wobble * Seen(w_ned, a.inc, a.az, a.tf);
    const Eigen::Vector3d G = wobble * Seen(g_ned, a.inc, a.az, a.tf);
    std::vector<double> row = {120.0 * i, T, a.inc, a.az, a.tf};
    Append(row, tool.Accel(G, tau) + Noise(random, bench.sigma_accel));
    Eigen::Vector4d m = tool.Gyro(w, -G, tau, dTdt) + bench.DriftAt(which, t);
    for (double& channel : m) channel += bench.sigma_gyro * random.Normal();
    Append(row, m);
    table.Add(row);
  }
  return table.Finish();
}

/// Three axes, six rates each, at one temperature.
inline BenchTable ThermalRates(const ThermalTool& tool, const ThermalBench& bench, double T,
                               Random& random) {
  TableMaker table({"t_s", "T_C", "axis", "rate_deg_s", "m_x1", "m_y1", "m_z2", "m_x2"});
  const double up = kEarth * std::sin(bench.latitude * kRad + bench.latitude_error);
  int count = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double rate : {-100, -50, -20, 20, 50, 100}) {
      Eigen::Vector3d n = Eigen::Vector3d::Unit(axis);
      n[(axis + 1) % 3] = bench.seat[axis][0];
      n[(axis + 2) % 3] = bench.seat[axis][1];
      n = TurnBy(-Noise(random, bench.wobble)) * n.normalized();
      Eigen::Vector4d m =
          tool.Gyro(((1 + bench.rate_scale) * 3600 * rate + up) * n, n, (T - 87.5) / 62.5, 0);
      m += bench.DriftAt(2, -1 + 2.0 * count / 17);
      for (double& channel : m) channel += bench.sigma_table * random.Normal();
      std::vector<double> row = {60.0 * count++, T, double(axis), rate};
      Append(row, m);
      table.Add(row);
    }
  }
  return table.Finish();
}

/// The truth by the names of the joint fit's parameters; tables: positions up, positions down,
/// rates.
inline std::map<std::string, double> TruthOf(const ThermalTool& tool, const ThermalBench& bench) {
  std::map<std::string, double> truth;
  const auto put = [&](const std::string& name, int i, double value) {
    truth[name + "[" + std::to_string(i) + "]"] = value;
  };
  const auto put2 = [&](const std::string& name, int i, int j, double value) {
    truth[name + "[" + std::to_string(i) + "," + std::to_string(j) + "]"] = value;
  };
  const std::string tau[] = {"", "_tau1", "_tau2", "_tau3"};
  for (int n = 0; n < 4; ++n) {
    for (int c = 0; c < 3; ++c) put("accel_b" + tau[n], c, tool.ba[n][c]);
    for (int c = 0; c < 4; ++c) put("gyro_b" + tau[n], c, tool.bg[n][c]);
  }
  const int place[] = {5, 4, 4, 3};  // of the products that feel N, in q
  for (int c = 0; c < 4; ++c) {
    put("gyro_heating", c, tool.heating[c]);
    put2("gyro_N", c, place[c], tool.N[c]);
    for (int j = 0; j < 3; ++j) put2("gyro_S", c, j, tool.U(c, j));
    for (int table = 0; table < 3; ++table) {
      const std::string name = "gyro_drift_" + std::to_string(table + 1);
      put(name, c, bench.drift[table][c]);
      if (bench.bend[table][c] != 0) put(name + "_bend", c, bench.bend[table][c]);
    }
  }
  for (int c = 0; c < 3; ++c) {
    put2("accel_K2", c, c, tool.K2[c]);
    for (int n = 0; n < 2; ++n) {
      for (int j = 0; j < 3; ++j) put2("accel_S" + tau[n], c, j, tool.Sa[n](c, j));
    }
  }
  for (int n = 0; n < 2; ++n) {
    for (int k = 0; k < 2; ++k) {
      put("gyro_M" + tau[n], k, tool.MQ[n][2 * k]);
      put("gyro_Q" + tau[n], k, tool.MQ[n][2 * k + 1]);
    }
  }
  for (int table = 0; table < 2; ++table) {
    const std::string number = std::to_string(table + 1);
    put("level_" + number, 0, bench.level[table].x());
    put("level_" + number, 1, bench.level[table].y());
    truth["north_" + number] = bench.level[table].z();
    truth["inclination_" + number] = 0;
  }
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name = std::string("axis_") + "xyz"[axis] + "_of_table_3";
    put(name, 0, bench.seat[axis][0]);
    put(name, 1, bench.seat[axis][1]);
  }
  truth["rate_scale_3"] = bench.rate_scale;
  truth["latitude"] = bench.latitude_error;
  return truth;
}

}  // namespace wellgyro::test
