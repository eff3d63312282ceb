#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/calibration/bench_table.h"
#include "wellgyro/math/random.h"

/// A bench for tests: readings from the sensors' errors by formulas of its own, in the trade's axes
/// (toolface measured to y).
namespace wellgyro::test {

inline constexpr double kRad = 3.14159265358979323846 / 180;
inline constexpr double kEarth = 7.292115146706979e-5 / kRad * 3600;  // deg/h

inline Eigen::Vector3d Gravity(double inc, double tf) {
  const double i = inc * kRad, t = tf * kRad;
  return {-std::sin(i) * std::sin(t), -std::sin(i) * std::cos(t), std::cos(i)};
}

/// North, east, down components seen by the bench's axes.
inline Eigen::Vector3d Seen(const Eigen::Vector3d& ned, double inc, double az, double tf) {
  const double i = inc * kRad, a = az * kRad, t = tf * kRad;
  const double high = ned.x() * std::cos(i) * std::cos(a) + ned.y() * std::cos(i) * std::sin(a) -
                      ned.z() * std::sin(i);
  const double right = -ned.x() * std::sin(a) + ned.y() * std::cos(a);
  const double along = ned.x() * std::sin(i) * std::cos(a) + ned.y() * std::sin(i) * std::sin(a) +
                       ned.z() * std::cos(i);
  return {std::sin(t) * high - std::cos(t) * right, std::cos(t) * high + std::sin(t) * right,
          along};
}

class TableMaker {
 public:
  explicit TableMaker(std::vector<std::string> columns) {
    table_.source = "simulated";
    table_.columns = std::move(columns);
  }
  void Add(const std::vector<double>& row) {
    rows_.push_back(row);
    table_.lines.push_back(static_cast<int>(rows_.size()) + 1);
  }
  BenchTable Finish() {
    table_.values.resize(static_cast<Eigen::Index>(rows_.size()),
                         static_cast<Eigen::Index>(table_.columns.size()));
    for (std::size_t i = 0; i < rows_.size(); ++i)
      table_.values.row(static_cast<Eigen::Index>(i)) =
          Eigen::Map<const Eigen::RowVectorXd>(rows_[i].data(), table_.values.cols());
    return std::move(table_);
  }

 private:
  BenchTable table_;
  std::vector<std::vector<double>> rows_;
};

/// The table without some of its columns.
inline BenchTable WithoutColumns(const BenchTable& data, const std::vector<std::string>& names) {
  std::vector<Eigen::Index> kept;
  BenchTable rest{data.source, {}, {}, data.lines};
  for (Eigen::Index c = 0; c < data.values.cols(); ++c) {
    const std::string& name = data.columns[static_cast<std::size_t>(c)];
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    kept.push_back(c);
    rest.columns.push_back(name);
  }
  rest.values = data.values(Eigen::all, kept);
  return rest;
}

inline Eigen::Vector3d Noise(Random& random, double sigma) {
  return sigma * Eigen::Vector3d{random.Normal(), random.Normal(), random.Normal()};
}

inline Eigen::Matrix3d NoiseMatrix(Random& random, double sigma) {
  Eigen::Matrix3d M;
  for (int i = 0; i < 3; ++i) M.row(i) = Noise(random, sigma).transpose();
  return M;
}

/// An attitude anywhere.
struct Attitude {
  double inc, az, tf;
};
inline Attitude AnyAttitude(Random& random) {
  return {std::acos(2 * random.Uniform() - 1) / kRad, 360 * random.Uniform(),
          360 * random.Uniform()};
}

/// A vector turned by small angles.
inline Eigen::Vector3d Tilted(const Eigen::Vector3d& u, const Eigen::Vector3d& angles) {
  // To second order; the tests' angles are below 1e-2.
  const Eigen::Vector3d once(angles.y() * u.z() - angles.z() * u.y(),
                             angles.z() * u.x() - angles.x() * u.z(),
                             angles.x() * u.y() - angles.y() * u.x());
  const Eigen::Vector3d twice(angles.y() * once.z() - angles.z() * once.y(),
                              angles.z() * once.x() - angles.x() * once.z(),
                              angles.x() * once.y() - angles.y() * once.x());
  return u + once + twice / 2;
}

inline void Append(std::vector<double>& row, const Eigen::VectorXd& more) {
  for (const double value : more) row.push_back(value);
}

/// Three accelerometers in volts at 24 positions.
struct VoltTool {
  Eigen::Matrix3d S;
  Eigen::Vector3d Vb, K2;

  static VoltTool Any(Random& random) {
    VoltTool tool;
    tool.S = 3 * Eigen::Matrix3d::Identity() + NoiseMatrix(random, 0.02);
    tool.Vb = Noise(random, 0.02);
    tool.K2 = Noise(random, 6e-5);
    return tool;
  }
  Eigen::Vector3d Read(const Eigen::Vector3d& u) const {
    return Vb + S * u + K2.cwiseProduct(u.cwiseAbs2());
  }
};

/// u where `axis` points up (or down) on a bench whose vertical leans by (a, b) deg, after the tool
/// was rotated about it by q quarters.
inline Eigen::Vector3d OnBench(int axis, int sign, int q, double a, double b) {
  const double ta = std::tan(a * kRad), tb = std::tan(b * kRad);
  const double c = q == 0 ? 1 : q == 2 ? -1 : 0, s = q == 1 ? 1 : q == 3 ? -1 : 0;
  Eigen::Vector3d u;
  u[axis] = sign;
  u[(axis + 1) % 3] = c * ta + s * tb;
  u[(axis + 2) % 3] = sign * (c * tb - s * ta);
  return u.normalized();
}

struct VoltBench {
  double a = 0, b = 0;   ///< lean [deg]
  double sigma = 0;      ///< of a reading [V]
  int readings = 3;      ///< a position and channel
  double transient = 0;  ///< at the begin of a position [V]
  double transient_readings = 5;
};

inline void AddPositions(const VoltTool& tool, const VoltBench& bench, Random& random,
                         std::vector<double> head, TableMaker& table) {
  for (int at = 0; at < 24; ++at) {
    const int axis = at / 8, sign = at / 4 % 2 == 0 ? 1 : -1, q = at % 4;
    const Eigen::Vector3d v = tool.Read(OnBench(axis, sign, q, bench.a, bench.b));
    for (int c = 0; c < 3; ++c) {
      for (int i = 0; i < bench.readings; ++i) {
        std::vector<double> row = head;
        for (const double value : {double(axis), double(sign), 90.0 * q, double(c), double(i)})
          row.push_back(value);
        row.push_back(v[c] + bench.transient * std::exp(-i / bench.transient_readings) +
                      bench.sigma * random.Normal());
        table.Add(row);
      }
    }
  }
}

inline BenchTable TwentyFour(const VoltTool& tool, const VoltBench& bench, Random& random) {
  TableMaker table({"axis", "dir", "rot_deg", "channel", "sample", "volt"});
  AddPositions(tool, bench, random, {}, table);
  return table.Finish();
}

/// Three accelerometers with pulse outputs.
struct PulseTool {
  Eigen::Vector3d k, a0, k2;  ///< pulses per second per m/s^2; m/s^2; g/g^2
  Eigen::Matrix3d E;          ///< zero on its diagonal

  static PulseTool Any(Random& random) {
    PulseTool tool;
    tool.k = Eigen::Vector3d::Constant(1200) + Noise(random, 10);
    tool.a0 = Noise(random, 0.02);
    tool.E = NoiseMatrix(random, 1e-3);
    tool.E.diagonal().setZero();
    for (double& k2 : tool.k2) k2 = (15 + 15 * random.Uniform()) * 1e-6;
    return tool;
  }
  Eigen::Vector3d Rate(const Eigen::Vector3d& a) const {
    return k.cwiseProduct(a0 + a + E * a + k2.cwiseProduct(a.cwiseAbs2()) / 9.80665);
  }
};

struct PulseBench {
  double tilt = 0;   ///< 1 sigma, each position anew [rad]
  double sigma = 0;  ///< of the pulses
  int repeats = 1;
};

inline BenchTable SixPositions(const PulseTool& tool, const PulseBench& bench, Random& random) {
  TableMaker table({"axis", "sign", "T_s", "Nx", "Ny", "Nz"});
  for (int at = 0; at < 6 * bench.repeats; ++at) {
    const int axis = at / bench.repeats / 2, sign = at / bench.repeats % 2 == 0 ? 1 : -1;
    const Eigen::Vector3d up = 9.80665 * sign * Eigen::Vector3d::Unit(axis);
    const Eigen::Vector3d a = Tilted(up, Noise(random, bench.tilt));
    const Eigen::Vector3d N = 180 * tool.Rate(a) + Noise(random, bench.sigma);
    table.Add({double(axis), double(sign), 180, N.x(), N.y(), N.z()});
  }
  return table.Finish();
}

}  // namespace wellgyro::test
