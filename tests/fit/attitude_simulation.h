#pragma once

#include <cmath>
#include <vector>

#include <Eigen/LU>

#include "fit/bench_simulation.h"

/// Benches that turn a tool through attitudes.
namespace wellgyro::test {

/// Accelerometers (gravity-signed, g) and magnetometers (nT): v = K u + b.
struct VectorTool {
  Eigen::Matrix3d Ka, Km;
  Eigen::Vector3d ba, bm;

  static VectorTool Any(Random& random) {
    VectorTool tool;
    tool.Ka = Eigen::Matrix3d::Identity() + NoiseMatrix(random, 0.01);
    tool.Km = Eigen::Matrix3d::Identity() + NoiseMatrix(random, 0.02);
    tool.ba = Noise(random, 0.01);
    tool.bm = Noise(random, 400);
    return tool;
  }
  /// The accelerometers' frame led by their z axis, as without a turntable.
  void TieToSensors() { Ka(0, 1) = Ka(0, 2) = Ka(1, 2) = 0; }
};

struct Field {
  double nt = 50'000, dip = 60;  ///< [nT], [deg]
  Eigen::Vector3d Ned() const {
    return nt * Eigen::Vector3d(std::cos(dip * kRad), 0, std::sin(dip * kRad));
  }
};

struct Noises {
  double accel = 0, mag = 0;
  double tilt = 0;  ///< of each attitude, the same for both sensors [rad]
};

/// Rows inc, az, tf, Gx, Gy, Gz, Mx, My, Mz.
inline std::vector<double> AttitudeRow(const VectorTool& tool, const Attitude& at,
                                       const Field& field, const Noises& noises, Random& random) {
  const Eigen::Vector3d angles = Noise(random, noises.tilt);
  const Eigen::Vector3d g = Tilted(Gravity(at.inc, at.tf), angles);
  const Eigen::Vector3d m = Tilted(Seen(field.Ned(), at.inc, at.az, at.tf), angles);
  std::vector<double> row = {at.inc, at.az, at.tf};
  Append(row, tool.Ka * g + tool.ba + Noise(random, noises.accel));
  Append(row, tool.Km * m + tool.bm + Noise(random, noises.mag));
  return row;
}

inline BenchTable AtAttitudes(const VectorTool& tool, int n, const Field& field,
                              const Noises& noises, Random& random) {
  TableMaker table({"inc_true", "az_true", "tf_true", "Gx", "Gy", "Gz", "Mx", "My", "Mz"});
  for (int i = 0; i < n; ++i)
    table.Add(AttitudeRow(tool, AnyAttitude(random), field, noises, random));
  return table.Finish();
}

/// The three sequences of the trigonometric method, and `verify` attitudes of seq 0.
inline BenchTable Sequences(const VectorTool& tool, const Field& field, const Noises& noises,
                            int verify, Random& random) {
  TableMaker table({"seq", "inc", "az", "tf", "Gx", "Gy", "Gz", "Mx", "My", "Mz"});
  const auto add = [&](double seq, const Attitude& at) {
    std::vector<double> row = AttitudeRow(tool, at, field, noises, random);
    row.insert(row.begin(), seq);
    table.Add(row);
  };
  for (int i = 0; i <= 12; ++i) add(1, {30.0 * i, 0, 90});
  for (int i = 0; i <= 12; ++i) add(2, {30.0 * i, 0, 0});
  for (int i = 0; i <= 12; ++i) add(3, {90, 270, 30.0 * i});
  for (int i = 0; i < verify; ++i) add(0, AnyAttitude(random));
  return table.Finish();
}

/// Two rotors across and along the hole: x1, y1 (spin z), z2, x2 (spin y).
struct GyroTool {
  Eigen::Matrix<double, 4, 3> U;
  Eigen::Vector4d b, N;
  Eigen::Vector4d MQ;

  static GyroTool Any(Random& random) {
    GyroTool tool;
    tool.U << 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 0;
    for (int i = 0; i < 4; ++i) {
      tool.U.row(i) += Noise(random, 2e-3).transpose();
      tool.b[i] = random.Normal();
      tool.N[i] = 0.05 * random.Normal();
      tool.MQ[i] = 3 * random.Normal();
    }
    return tool;
  }
  Eigen::Vector4d Read(const Eigen::Vector3d& w, const Eigen::Vector3d& f) const {
    Eigen::Vector4d m = b + U * w;
    m[0] += MQ[0] * f.x() + MQ[1] * f.y() + N[0] * f.x() * f.z();
    m[1] += MQ[0] * f.y() - MQ[1] * f.x() + N[1] * f.y() * f.z();
    // x comes before z: x2 is the rotor's first channel.
    m[3] += MQ[2] * f.x() + MQ[3] * f.z() + N[3] * f.x() * f.y();
    m[2] += MQ[2] * f.z() - MQ[3] * f.x() + N[2] * f.z() * f.y();
    return m;
  }
};

inline BenchTable GyrosAtRest(const GyroTool& tool, double latitude, double sigma, Random& random,
                              double north_offset = 0, double toolface_step = 60) {
  TableMaker table({"inc", "az", "tf", "fx", "fy", "fz", "m_x1", "m_y1", "m_z2", "m_x2"});
  const Eigen::Vector3d w_ned(kEarth * std::cos(latitude * kRad), 0,
                              -kEarth * std::sin(latitude * kRad));
  for (int inc = 0; inc <= 180; inc += 45) {
    for (int az = 0; az < 360; az += 90) {
      for (double tf = 0; tf < 360; tf += toolface_step) {
        const Eigen::Vector3d f = -Gravity(inc, tf);
        const Eigen::Vector3d w = Seen(w_ned, inc, az + north_offset, tf);
        std::vector<double> row = {double(inc), double(az), tf, f.x(), f.y(), f.z()};
        Eigen::Vector4d m = tool.Read(w, f);
        for (double& channel : m) channel += sigma * random.Normal();
        Append(row, m);
        table.Add(row);
      }
    }
  }
  return table.Finish();
}

inline BenchTable GyrosOnTable(const GyroTool& tool, double latitude, double sigma,
                               Random& random) {
  TableMaker table({"axis", "rate_deg_s", "m_x1", "m_y1", "m_z2", "m_x2"});
  for (int axis = 0; axis < 3; ++axis) {
    for (const double rate : {-100, -50, -20, 20, 50, 100}) {
      const Eigen::Vector3d up = Eigen::Vector3d::Unit(axis);
      Eigen::Vector4d m = tool.Read((3600 * rate + kEarth * std::sin(latitude * kRad)) * up, up);
      for (double& channel : m) channel += sigma * random.Normal();
      std::vector<double> row = {double(axis), rate};
      Append(row, m);
      table.Add(row);
    }
  }
  return table.Finish();
}

/// Stations of a run that builds from 5 to 85 deg while it turns.
inline BenchTable Stations(const Eigen::Vector3d& bm, const Eigen::Vector3d& sm, const Field& field,
                           double sigma_field, double sigma_dip, Random& random) {
  TableMaker table({"Gx", "Gy", "Gz", "Mx", "My", "Mz"});
  for (int i = 0; i < 40; ++i) {
    const Attitude at{5 + 2 * i * 1.0, 60 + 3.0 * i, 360 * random.Uniform()};
    // The field itself is a little off at each station, in length and dip.
    Field there{field.nt + sigma_field * random.Normal(),
                field.dip + sigma_dip / kRad * random.Normal()};
    const Eigen::Vector3d m = Seen(there.Ned(), at.inc, at.az, at.tf);
    std::vector<double> row;
    Append(row, Gravity(at.inc, at.tf));
    Append(row, m + sm.cwiseProduct(m) + bm);
    table.Add(row);
  }
  return table.Finish();
}

inline BenchTable GyroStations(const Eigen::Vector3d& b, double latitude, double sigma,
                               Random& random, bool has_wz = true) {
  TableMaker table({"Gx", "Gy", "Gz", "wx", "wy", has_wz ? "wz" : "unused"});
  const Eigen::Vector3d w_ned(kEarth * std::cos(latitude * kRad), 0,
                              -kEarth * std::sin(latitude * kRad));
  for (int i = 0; i < 40; ++i) {
    const Attitude at = AnyAttitude(random);
    std::vector<double> row;
    Append(row, Gravity(at.inc, at.tf));
    Append(row, Seen(w_ned, at.inc, at.az, at.tf) + b + Noise(random, sigma));
    table.Add(row);
  }
  return table.Finish();
}

}  // namespace wellgyro::test
