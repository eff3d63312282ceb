#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Dense>

#include "wellgyro/estimate/diagnosis.h"
#include "wellgyro/estimate/onset_scan.h"
#include "wellgyro/math/random.h"

namespace wellgyro::test {

inline constexpr int kDenseKnots = 30;

/// A made-up run of random derivatives whose drift steps from node to node, beside it the same as
/// one dense system.
class ToyRun : public RunRows {
 public:
  explicit ToyRun(std::uint64_t seed) : random_(seed) {
    layout_.walk = 6;
    layout_.node = 8;
    layout_.border = 4;
    layout_.source.fill(kAbsent);
    layout_.source[kGyroBiasX] = 0;
    layout_.source[kGyroBiasY] = 1;
    layout_.source[kToolfaceOffset] = 2;
    layout_.latitude = 3;
    layout_.sigma.resize(4);
    layout_.sigma << 1, 2, 0.5, 3;
    // A prior whose errors go together, as a calibration's do: information U'U.
    Eigen::Matrix4d correlation = Eigen::Matrix4d::Identity();
    correlation(0, 1) = correlation(1, 0) = 0.6;
    correlation(1, 3) = correlation(3, 1) = -0.4;
    const auto per_sigma = layout_.sigma.cwiseInverse().asDiagonal();
    layout_.information = per_sigma * correlation.inverse() * per_sigma;
    prior_ = Eigen::Matrix4d(layout_.information).llt().matrixU();
    information_.setZero(12, 12);
    information_.diagonal() << Eigen::VectorXd::Constant(6, 0.01), 1e6, 1e6,
        Eigen::Vector4d::Zero();
    information_.bottomRightCorner(4, 4) = layout_.information;
    for (int i = 0; i < 8; ++i)
      Row(Eigen::VectorXd::Unit(kUnknowns, i) * std::sqrt(information_(i, i)));
    for (int i = 0; i < 4; ++i) {
      Eigen::VectorXd row = Eigen::VectorXd::Zero(kUnknowns);
      row.tail(4) = prior_.row(i);
      Row(row);
    }
    for (int k = 0; k < kDenseKnots; ++k) AddKnot(k);
    border_ = prior_.inverse() * PriorNoise();
  }

  const Layout& layout() const override { return layout_; }
  std::size_t size() const override { return kDenseKnots; }
  void FirstRows(EdgeMatrix& information, EdgeVector& gradient) const override {
    information = information_;
    gradient.resize(12);
    for (int i = 0; i < 8; ++i) gradient[i] = std::sqrt(information_(i, i)) * noise_[i];
    gradient.tail(4) = prior_.transpose() * PriorNoise();
  }
  void RowsOf(std::size_t k, std::vector<Factor>& rows) override {
    rows.insert(rows.end(), factors_[k].begin(), factors_[k].end());
  }

  /// Adds `size` times the column to what was measured.
  void Disturb(const Eigen::VectorXd& column, double size) {
    for (Eigen::Index i = 0; i < column.size(); ++i) {
      noise_[static_cast<std::size_t>(i)] += size * column[i];
    }
    for (std::vector<Factor>& knot : factors_) {
      for (Factor& f : knot) {
        for (int i = 0; i < f.rows; ++i) f.r[i] = noise_[RowAt(f) + static_cast<std::size_t>(i)];
      }
    }
  }

  /// The tool is at rest in these knots.
  void Rest(std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) factors_[k].front().kind = RowKind::kStill;
  }

  /// In this knot's rows stands an azimuth from outside, of either node.
  void Tie(std::size_t knot) { factors_[knot][2].kind = RowKind::kAzimuth; }
  /// What was measured is so many times as sure.
  void Sharpen(double times) {
    for (std::vector<Factor>& knot : factors_) {
      for (Factor& f : knot) {
        f.J.leftCols(f.columns) *= times;
        for (int i = 0; i < f.rows; ++i) dense_[RowAt(f) + static_cast<std::size_t>(i)] *= times;
      }
    }
  }

  Eigen::MatrixXd J() const {
    Eigen::MatrixXd j =
        Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(dense_.size()), (kDenseKnots + 1) * 8 + 4);
    for (std::size_t i = 0; i < dense_.size(); ++i) j.row(static_cast<Eigen::Index>(i)) = dense_[i];
    return j;
  }
  Eigen::VectorXd r() const { return Eigen::Map<const Eigen::VectorXd>(noise_.data(), rows()); }
  Eigen::Index rows() const { return static_cast<Eigen::Index>(dense_.size()); }
  /// Column of a step of an unknown of the border from node t on, as written in the header.
  Eigen::VectorXd Step(int unknown, int t) const {
    Eigen::VectorXd column = Eigen::VectorXd::Zero(rows());
    for (std::size_t k = static_cast<std::size_t>(t); k < kDenseKnots; ++k) {
      for (const Factor& f : factors_[k]) {
        column.segment(static_cast<Eigen::Index>(RowAt(f)), f.rows) -=
            ColumnOf(f, layout_, unknown).head(f.rows);
      }
    }
    return column;
  }
  /// Column of what an unknown of the border is beyond its prior.
  Eigen::VectorXd BeyondPrior(int unknown) const {
    Eigen::VectorXd column = Eigen::VectorXd::Zero(rows());
    column.segment<4>(8) = prior_.col(unknown);
    return column;
  }
  /// First row of the first factor of this kind.
  Eigen::Index RowOf(std::size_t knot, RowKind kind) const {
    for (const Factor& f : factors_[knot]) {
      if (f.kind == kind) return static_cast<Eigen::Index>(RowAt(f));
    }
    return -1;
  }

 private:
  // The row's place is kept where the test can find it again.
  static std::size_t RowAt(const Factor& f) { return static_cast<std::size_t>(f.held); }

  Eigen::Vector4d PriorNoise() const { return Eigen::Map<const Eigen::Vector4d>(&noise_[8]); }

  void Row(const Eigen::VectorXd& row) {
    dense_.push_back(row.transpose());
    noise_.push_back(random_.Normal());
  }

  void AddKnot(int k) {
    std::vector<Factor>& knot = factors_.emplace_back();
    for (const RowKind kind : {RowKind::kTurn, RowKind::kForce, RowKind::kRest, RowKind::kDrift}) {
      Factor f;
      f.Begin(kind, kind == RowKind::kDrift ? 2 : 3);
      f.held = static_cast<double>(dense_.size());
      f.per_unit = 2 + k % 3;
      f.r.setZero();
      if (kind == RowKind::kDrift) {
        for (int i = 0; i < 2; ++i) {
          f.Column(6 + i).head<2>() = -4 * Eigen::Vector2d::Unit(i);
          f.Column(8 + 6 + i).head<2>() = 4 * Eigen::Vector2d::Unit(i);
        }
      } else {
        const bool turn = kind == RowKind::kTurn;
        for (int j = 0; j < 6; ++j) f.Column(j) = Normals();
        for (int j = 0; j < 6; ++j) f.Column(8 + j) = Normals();
        for (int i = 0; turn && i < 2; ++i) {
          const Eigen::Vector3d by_bias = Normals();
          // The drift of a knot is its begin's: a step at a node is then one of the bias.
          f.Column(6 + i) = by_bias;
          f.Column(16 + i) = by_bias;
        }
        f.Column(18) = Normals();
        if (turn) f.Column(19) = Normals();
      }
      for (int i = 0; i < f.rows; ++i) {
        Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero((kDenseKnots + 1) * 8 + 4);
        for (int j = 0; j < f.columns; ++j) {
          const int at = f.column[static_cast<std::size_t>(j)];
          row[at < 16 ? k * 8 + at : (kDenseKnots + 1) * 8 + at - 16] += f.J(i, j);
        }
        dense_.push_back(row);
        noise_.push_back(random_.Normal());
        f.r[i] = noise_.back();
      }
      knot.push_back(f);
    }
  }

  Eigen::Vector3d Normals() { return {random_.Normal(), random_.Normal(), random_.Normal()}; }

  Random random_;
  Layout layout_;
  static constexpr int kUnknowns = (kDenseKnots + 1) * 8 + 4;
  EdgeMatrix information_;
  Eigen::Matrix4d prior_;  ///< U
  BorderVector border_ = BorderVector::Zero(4);
  std::vector<std::vector<Factor>> factors_;
  std::vector<Eigen::RowVectorXd> dense_;
  std::vector<double> noise_;
};

/// What the header says, by dense matrices.
struct DenseDiagnosis {
  Eigen::MatrixXd J, N_inverse, P;
  Eigen::VectorXd r;

  explicit DenseDiagnosis(const ToyRun& run) : J(run.J()), r(run.r()) {
    N_inverse = (J.transpose() * J).inverse();
    P = Eigen::MatrixXd::Identity(J.rows(), J.rows()) - J * N_inverse * J.transpose();
  }
  double Information(const Eigen::VectorXd& c) const { return c.dot(P * c); }
  double Size(const Eigen::VectorXd& c) const { return c.dot(P * r) / Information(c); }
  double LnBayes(const Eigen::VectorXd& c, double size) const {
    const double s = c.dot(P * r), m = Information(c);
    return s * s / (2 * (m + 1 / (size * size))) - 0.5 * std::log(1 + size * size * m);
  }
  /// Of the end, which is the sum of the slopes times phi.
  Eigen::Vector3d Shift(const Eigen::VectorXd& c,
                        const std::vector<Eigen::Matrix3d>& slopes) const {
    const Eigen::VectorXd dx = -N_inverse * J.transpose() * c;
    Eigen::Vector3d end = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < slopes.size(); ++k) {
      end += slopes[k] * dx.segment<3>(static_cast<Eigen::Index>(k) * 8);
    }
    return end;
  }
};

/// Of the end by phi of each node, drawn once for all.
inline std::vector<Eigen::Matrix3d> Slopes() {
  std::vector<Eigen::Matrix3d> slopes;
  Random random(77);
  for (int k = 0; k <= kDenseKnots; ++k) {
    slopes.push_back(Eigen::Matrix3d::NullaryExpr([&random] { return random.Normal(); }));
  }
  return slopes;
}

}  // namespace wellgyro::test
