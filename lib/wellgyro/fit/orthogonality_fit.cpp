#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/fit/affine_fit.h"
#include "wellgyro/fit/attitude_table_internal.h"
#include "wellgyro/fit/bench_checks_internal.h"
#include "wellgyro/fit/least_squares_internal.h"
#include "wellgyro/fit/trigonometric_fit_internal.h"

namespace wellgyro {
namespace {

Eigen::VectorXd Quantity(const FitReport& report, std::string_view name) {
  for (const FitQuantity& quantity : report.result) {
    if (quantity.name == name) return Eigen::MatrixXd(quantity.value.transpose()).reshaped();
  }
  return {};
}

Eigen::Matrix3d Matrix(const FitReport& report, std::string_view name) {
  const Eigen::VectorXd nine = Quantity(report, name);
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(nine.data());
}

// Rows of the table that lie in one of the sequences [low, high].
BenchTable Rows(const BenchTable& data, int seq, int low, int high) {
  BenchTable rows{data.source, data.columns, {}, {}};
  std::vector<Eigen::Index> kept;
  for (int i = 0; i < data.rows(); ++i) {
    if (data.values(i, seq) < low || data.values(i, seq) > high) continue;
    kept.push_back(i);
    rows.lines.push_back(data.lines[static_cast<std::size_t>(i)]);
  }
  rows.values = data.values(kept, Eigen::all);
  return rows;
}

struct Waves {
  TrigonometricModel model;
  Eigen::MatrixXd sigma = Eigen::MatrixXd::Zero(6, 4);
  std::vector<std::string> remarks;
};

// Each channel against its own sequence.
Result<Waves> FitWaves(const BenchTable& data, int seq, const OrthogonalitySetup& setup) {
  Waves waves;
  for (int k = 0; k < 6; ++k) {
    const int axis = k % 3, sequence = axis + 1;
    const BenchTable rows = Rows(data, seq, sequence, sequence);
    if (auto fault = TooFew(rows, 4, fmt::format("readings of sequence {}", sequence),
                            "measure it every 30 deg, 0 to 360")) {
      return *fault;
    }
    const auto table = ReadAttitudeTable(rows, {.attitude = true, .accel = true, .mag = true});
    if (!table) return table.fault();
    Eigen::VectorXd errors(table->rows());
    for (int i = 0; i < table->rows(); ++i) {
      errors[i] = k < 3 ? table->accel(i, axis) - table->IdealAccel(i, setup.reference)[axis]
                        : table->mag(i, axis) - table->IdealMag(i, setup.reference)[axis];
    }
    const Eigen::VectorXd& angles = axis < 2 ? table->inclination : table->toolface;
    auto wave = FitWave(angles, errors, table->lines, setup.free_frequency);
    if (!wave) return BenchFault(rows, wave.fault().text, rows.lines.front());
    waves.model.x[static_cast<std::size_t>(k)] = wave->x;
    waves.sigma.row(k) = wave->sigma.transpose();
    if (!setup.free_frequency && wave->told) {
      waves.remarks.push_back(
          fmt::format("x_{}2 is held at 1, and the readings tell its frequency from 1: give "
                      "--free-frequency; its sigmas hold the difference",
                      k + 1));
    }
    if (setup.free_frequency && !wave->free) {
      waves.remarks.push_back(
          fmt::format("x_{}2 stays 1: the readings do not tell its frequency from 1", k + 1));
    }
  }
  return waves;
}

// Sums of one kind of correction over the attitudes of verification.
class ErrorSums {
 public:
  void Add(const Eigen::Vector3d& G, const Eigen::Vector3d& M, const Eigen::Vector3d& G_true,
           const Eigen::Vector3d& M_true) {
    const MagneticAngles found = AnglesOf(BenchAxes::kTrade, G, M);
    const MagneticAngles truth = AnglesOf(BenchAxes::kTrade, G_true, M_true);
    g_ += (G - G_true).squaredNorm();
    m_ += (M - M_true).squaredNorm();
    inclination_ += std::pow(found.inclination - truth.inclination, 2);
    azimuths_.push_back(std::abs(WrapPi(found.azimuth - truth.azimuth)));
  }
  OrthogonalityCheck::Errors Result() {
    const double n = static_cast<double>(azimuths_.size());
    std::sort(azimuths_.begin(), azimuths_.end());
    const std::size_t half = azimuths_.size() / 2;
    const double median =
        azimuths_.size() % 2 == 1 ? azimuths_[half] : (azimuths_[half - 1] + azimuths_[half]) / 2;
    return {1e3 * std::sqrt(g_ / (3 * n)), std::sqrt(m_ / (3 * n)),
            ToDegrees(std::sqrt(inclination_ / n)), ToDegrees(median)};
  }

 private:
  double g_ = 0, m_ = 0, inclination_ = 0;
  std::vector<double> azimuths_;
};

OrthogonalityCheck Verify(const AttitudeTable& table, const BenchReference& reference,
                          const OrthogonalityFit& fit) {
  OrthogonalityCheck check;
  check.attitudes = table.rows();
  ErrorSums raw, trigonometric, affine;
  for (int i = 0; i < table.rows(); ++i) {
    const Eigen::Vector3d G = table.accel.row(i).transpose(), M = table.mag.row(i).transpose();
    const Eigen::Vector3d G_true = table.IdealAccel(i, reference);
    const Eigen::Vector3d M_true = table.IdealMag(i, reference);
    raw.Add(G, M, G_true, M_true);
    const CorrectedReading a = Correct(fit.affine, G, M);
    affine.Add(a.G_B, a.M_B, G_true, M_true);
    const CorrectedReading t = Correct(fit.trigonometric, G, M, fit.affine);
    trigonometric.Add(t.G_B, t.M_B, G_true, M_true);
    check.fell_back += t.fell_back ? 1 : 0;
  }
  check.raw = raw.Result();
  check.trigonometric = trigonometric.Result();
  check.affine = affine.Result();
  return check;
}

// From raw = S ideal + b to the error matrices that the method speaks of.
void TakeErrors(FitReport& report) {
  std::vector<std::string> names;
  for (const char* suffix : {"G", "M"}) {
    Append(names, VectorNames(std::string("b_") + suffix, 3));
    Append(names, MatrixNames(std::string("E_") + suffix, 3, 3));
  }
  // Behind these the zero of the stand's inclination, where it was found.
  const int sensors = static_cast<int>(names.size());
  const bool zero = report.values.size() > sensors;
  if (zero) names.push_back(report.parameters.back());
  Reparametrise(report, names, [](const Eigen::VectorXd& x) {
    Eigen::VectorXd errors = x;
    for (const int first : {3, 15}) {
      for (int c = 0; c < 3; ++c) errors[first + 4 * c] -= 1;
    }
    return errors;
  });
  report.result.clear();
  AddMatrix(report, "E_G", 3, 3, 3);
  AddVector(report, "b_G", 0, 3);
  AddMatrix(report, "E_M", 15, 3, 3);
  AddVector(report, "b_M_nT", 12, 3);
  if (zero) AddNumber(report, report.parameters.back(), sensors);
}

void AddCoefficients(const Waves& waves, FitReport& report) {
  FitQuantity x{"x_kj", FitQuantity::Shape::kMatrix, Eigen::MatrixXd(6, 4), waves.sigma};
  for (int k = 0; k < 6; ++k) {
    for (int j = 0; j < 4; ++j) {
      x.value(k, j) = waves.model.x[static_cast<std::size_t>(k)][static_cast<std::size_t>(j)];
    }
  }
  report.result.push_back(std::move(x));
  report.remarks.insert(report.remarks.end(), waves.remarks.begin(), waves.remarks.end());
}

std::optional<Fault> BadSequences(const BenchTable& data, int column) {
  for (int i = 0; i < data.rows(); ++i) {
    const double number = data.values(i, column);
    if (number != 0 && number != 1 && number != 2 && number != 3) {
      return BenchFault(data,
                        fmt::format("sequence {:g}: 1, 2 and 3 calibrate, 0 verifies", number),
                        data.lines[static_cast<std::size_t>(i)]);
    }
  }
  return std::nullopt;
}

}  // namespace

Result<OrthogonalityFit> FitOrthogonality(const BenchTable& data, const OrthogonalitySetup& setup) {
  if (!setup.reference.field || !setup.reference.dip) {
    throw std::invalid_argument("the orthogonality method needs the field and its dip");
  }
  const auto seq = FindColumns(data, {"seq"});
  if (!seq) return seq.fault();
  if (auto fault = BadSequences(data, seq->front())) return *fault;
  const auto accel = FindColumns(data, {"Gx", "Gy", "Gz"});
  if (!accel) return accel.fault();
  if (auto fault = MixedUnits(data, *accel, setup.reference.gravity, "the length of (Gx, Gy, Gz)",
                              "g, or give --gravity-mps2")) {
    return *fault;
  }
  const BenchTable sequences = Rows(data, seq->front(), 1, 3);
  const auto waves = FitWaves(sequences, seq->front(), setup);
  if (!waves) return waves.fault();
  auto affine = FitAffine(sequences, {.reference = setup.reference,
                                      .sigma_accel = setup.sigma_accel,
                                      .sigma_mag = setup.sigma_mag});
  if (!affine) return affine.fault();

  OrthogonalityFit fit;
  fit.trigonometric = waves->model;
  fit.affine = {Matrix(affine->report, "S_G"), Matrix(affine->report, "S_M"),
                Quantity(affine->report, "b_G"), Quantity(affine->report, "b_M_nT")};
  fit.calibration = *std::move(affine);
  FitReport& report = fit.calibration.report;
  report.method = "orthogonality";
  TakeErrors(report);
  AddCoefficients(*waves, report);
  const BenchTable verification = Rows(data, seq->front(), 0, 0);
  if (verification.rows() > 0) {
    const auto table =
        ReadAttitudeTable(verification, {.attitude = true, .accel = true, .mag = true});
    if (!table) return table.fault();
    fit.check = Verify(*table, setup.reference, fit);
  }
  return fit;
}

}  // namespace wellgyro
