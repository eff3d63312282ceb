#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "wellgyro/fit/tool_budget_internal.h"
#include "wellgyro/math/linear_algebra.h"

namespace wellgyro {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// Parts of the readings' covariance, as ToolNoise has them.
enum Component : std::size_t { kAccel, kGyro, kGyroTable, kWobble, kWobbleTable, kComponents };

// Of a row: R = L L', what the columns of L are parts of, and q = X' R^-1 L.
struct RowRoot {
  MatrixXd D, q;  ///< D = L' R^-1 L
  std::vector<std::size_t> component;
};

// What the readings' covariance does to the parameters' part by part, and what they tell of the
// variances of these parts.
class ReadingParts {
 public:
  ReadingParts(const ToolReadings& readings, const ToolModel& model, const ToolAdjustment& a)
      : readings_(readings), model_(model), a_(a) {
    const Index n = a.x.size();
    B_.fill(MatrixXd::Zero(n, n));
    cov_ = B_;
    for (std::size_t i = 0; i < readings.rows.size(); ++i) {
      if (a.out[i] == 0) Add(RootOf(readings.rows[i]));
    }
    for (MatrixXd* each : {B_.data(), cov_.data()}) {
      for (std::size_t k = 0; k < kComponents; ++k) {
        each[k] = MatrixXd(each[k].selfadjointView<Eigen::Lower>());
      }
    }
    for (std::size_t k = 0; k < kComponents; ++k) {
      for (std::size_t l = 0; l < kComponents; ++l) {
        information_(Index(k), Index(l)) += B_[k].cwiseProduct(cov_[l]).sum();
      }
    }
  }

  bool Has(std::size_t k) const { return without_(Index(k)) > 0; }
  const MatrixXd& cov(std::size_t k) const { return cov_[k]; }

  /// Covariance of ln v_k of the components in `found`: inverse of the readings' information about
  /// them, tr(P V_k P V_l) / 2 (restricted likelihood), P = R^-1 - R^-1 X C X' R^-1. Where the
  /// parameters take all that the readings say, what is left is rounding.
  MatrixXd VarianceCov(const std::vector<Index>& found) const {
    constexpr double kRounding = 1e-9;  // of two products with C, off by its condition
    MatrixXd M = information_(found, found);
    M.diagonal() = M.diagonal().cwiseMax(kRounding * without_(found));
    const Eigen::VectorXd scale = M.diagonal().cwiseSqrt().cwiseInverse();
    return 2 * scale.asDiagonal() *
           InverseOfSymmetric(scale.asDiagonal() * M * scale.asDiagonal()) * scale.asDiagonal();
  }

 private:
  RowRoot RootOf(const ToolRow& row) const {
    const ToolModel::Prediction at = model_.At(row, a_.x);
    const MatrixXd W = model_.Whitener(row, at.wobble, a_.noise);
    const auto n = static_cast<Index>(row.channels.size());
    const bool table = row.mount >= 0;
    RowRoot root;
    MatrixXd L = MatrixXd::Zero(n, n + 3);
    for (Index i = 0; i < n; ++i) {
      const int c = row.channels[static_cast<std::size_t>(i)];
      const bool is_gyro = readings_.channels[static_cast<std::size_t>(c)].is_gyro;
      L(i, i) = !is_gyro ? a_.noise.accel : table ? a_.noise.gyro_table : a_.noise.gyro;
      root.component.push_back(!is_gyro ? kAccel : table ? kGyroTable : kGyro);
    }
    L.rightCols(3) = a_.noise.WobbleOf(row) * at.wobble;
    root.component.insert(root.component.end(), 3, table ? kWobbleTable : kWobble);
    const MatrixXd whitened = W * L;
    root.D = whitened.transpose() * whitened;
    root.q = (W * at.J).transpose() * whitened;
    return root;
  }

  void Add(const RowRoot& root) {
    const MatrixXd gain = a_.cov * root.q;
    const MatrixXd E = root.q.transpose() * gain;
    for (std::size_t i = 0; i < root.component.size(); ++i) {
      for (std::size_t j = 0; j < root.component.size(); ++j) {
        const auto a = static_cast<Index>(i), b = static_cast<Index>(j);
        const auto k = Index(root.component[i]), l = Index(root.component[j]);
        information_(k, l) += root.D(a, b) * (root.D(a, b) - 2 * E(a, b));
        if (k == l) without_[k] += root.D(a, b) * root.D(a, b);
      }
    }
    for (std::size_t k = 0; k < kComponents; ++k) {
      std::vector<Index> columns;
      for (std::size_t i = 0; i < root.component.size(); ++i) {
        if (root.component[i] == k) columns.push_back(static_cast<Index>(i));
      }
      if (columns.empty()) continue;
      B_[k].selfadjointView<Eigen::Lower>().rankUpdate(MatrixXd(root.q(Eigen::all, columns)));
      cov_[k].selfadjointView<Eigen::Lower>().rankUpdate(MatrixXd(gain(Eigen::all, columns)));
    }
  }

  const ToolReadings& readings_;
  const ToolModel& model_;
  const ToolAdjustment& a_;
  std::array<MatrixXd, kComponents> B_, cov_;  ///< sums of q q', and of C q q' C
  /// tr(P V_k P V_l); of each, if there were no parameters.
  MatrixXd information_ = MatrixXd::Zero(kComponents, kComponents);
  Eigen::VectorXd without_ = Eigen::VectorXd::Zero(kComponents);
};

// "level_1[0]": what was stated of it is called level; "axis_x_of_table_3[0]": seat.
std::string SourceOf(const std::string& nuisance) {
  const std::string begin = nuisance.substr(0, nuisance.find('_'));
  if (begin == "rate") return "rate scale";
  return begin == "axis" ? "seat" : begin;
}

// Columns C e_j / s_j of the priors, by what was stated.
void AddPriors(const ToolModel& model, const MatrixXd& cov, CovarianceParts& parts) {
  std::vector<std::pair<std::string, std::vector<Index>>> groups;
  Eigen::VectorXd sigma = Eigen::VectorXd::Zero(cov.cols());
  const auto take = [&](const std::string& source, Index at, double prior_sigma) {
    if (!(prior_sigma > 0)) return;
    sigma[at] = prior_sigma;
    auto group = std::find_if(groups.begin(), groups.end(),
                              [&](const auto& each) { return each.first == source; });
    if (group == groups.end()) group = groups.insert(group, {source, {}});
    group->second.push_back(at);
  };
  Index at = model.n_terms();
  for (const BenchNuisance& nuisance : model.nuisances()) {
    take(SourceOf(nuisance.name), at++, nuisance.prior_sigma);
  }
  at = 0;
  for (const ToolTerm& term : model.terms()) {
    take(term.kind == TermKind::kDrift ? "drift" : "terms not told", at++, term.prior_sigma);
  }
  for (const auto& [source, places] : groups) {
    const MatrixXd root = cov(Eigen::all, places) * sigma(places).cwiseInverse().asDiagonal();
    parts.Add(source, root * root.transpose());
  }
}

// With the root of var(ln v) / 4 of each, as d ln s = d ln v / 2; wobbles stand with the bench.
std::vector<FitQuantity> FoundSigmas(const ToolNoise& noise, const std::vector<Index>& found,
                                     const MatrixXd& variance_cov) {
  const std::pair<const char*, double> sigmas[] = {
      {"sigma_accel", noise.accel},
      {"sigma_gyro_deg_per_h", noise.gyro},
      {"sigma_gyro_table_deg_per_h", noise.gyro_table}};
  std::vector<FitQuantity> quantities;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i] > Index(kGyroTable)) continue;
    const auto& [name, sigma] = sigmas[found[i]];
    const double relative = std::sqrt(variance_cov(Index(i), Index(i))) / 2;
    quantities.push_back({name, FitQuantity::Shape::kNumber, MatrixXd::Constant(1, 1, sigma),
                          MatrixXd::Constant(1, 1, relative * sigma)});
  }
  return quantities;
}

}  // namespace

ToolParts PartsOf(const ToolReadings& readings, const ToolFitSetup& setup, const ToolModel& model,
                  const ToolAdjustment& adjustment) {
  const std::array<const char*, kComponents> names = {"accelerometers", "gyros",
                                                      "gyros on the table", "wobble", "wobble"};
  const std::array<bool, kComponents> stated = {
      setup.sigma_accel.has_value(), setup.sigma_gyro.has_value(),
      setup.sigma_gyro_table.has_value(), setup.sigma_wobble.has_value(),
      setup.sigma_wobble.has_value()};
  const ReadingParts of_readings(readings, model, adjustment);
  ToolParts whole;
  CovarianceParts& parts = whole.cov;
  std::vector<Index> found;
  for (std::size_t k = 0; k < kComponents; ++k) {
    if (stated[k] || !of_readings.Has(k)) continue;
    found.push_back(static_cast<Index>(k));
    parts.Add("readings", of_readings.cov(k));
  }
  parts.variance_cov = of_readings.VarianceCov(found);
  whole.found = FoundSigmas(adjustment.noise, found, parts.variance_cov);
  AddPriors(model, adjustment.cov, parts);
  for (std::size_t k = 0; k < kComponents; ++k) {
    if (stated[k] && of_readings.Has(k)) parts.Add(names[k], of_readings.cov(k));
  }
  return whole;
}

}  // namespace wellgyro
