#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/calibration/members.h"
#include "wellgyro/fit/tool_budget_internal.h"
#include "wellgyro/fit/tool_result_internal.h"

namespace wellgyro {
namespace {

using Kind = CalibrationMember::Kind;

// "gyro_S_tau1[2,0]" to its quantity and its place there.
std::string QuantityOf(const std::string& name) { return name.substr(0, name.find('[')); }

struct TermPlace {
  int row = 0, column = 0;
};
TermPlace PlaceOf(const std::string& name) {
  TermPlace place;
  const std::size_t open = name.find('['), comma = name.find(',');
  if (open == std::string::npos) return place;
  place.row = std::stoi(name.substr(open + 1));
  if (comma != std::string::npos) place.column = std::stoi(name.substr(comma + 1));
  return place;
}

// Quantities by name, as vectors or matrices, what has no term is zero.
void AddQuantities(FitReport& report) {
  std::vector<std::string> order;
  std::map<std::string, FitQuantity> of;
  for (Eigen::Index i = 0; i < report.values.size(); ++i) {
    const std::string& name = report.parameters[static_cast<std::size_t>(i)];
    const std::string quantity_name = QuantityOf(name);
    const TermPlace place = PlaceOf(name);
    auto [found, is_new] = of.try_emplace(quantity_name);
    FitQuantity& quantity = found->second;
    if (is_new) order.push_back(quantity_name);
    quantity.name = quantity_name;
    if (name.find('[') != std::string::npos) {
      const bool matrix = name.find(',') != std::string::npos;
      quantity.shape = matrix ? FitQuantity::Shape::kMatrix : FitQuantity::Shape::kVector;
    }
    const Eigen::Index rows = std::max<Eigen::Index>(quantity.value.rows(), place.row + 1);
    const Eigen::Index columns = std::max<Eigen::Index>(quantity.value.cols(), place.column + 1);
    for (Eigen::MatrixXd* m : {&quantity.value, &quantity.sigma}) {
      Eigen::MatrixXd larger = Eigen::MatrixXd::Zero(rows, columns);
      larger.topLeftCorner(m->rows(), m->cols()) = *m;
      *m = larger;
    }
    quantity.value(place.row, place.column) = report.values[i];
    quantity.sigma(place.row, place.column) = std::sqrt(std::max(0.0, report.cov(i, i)));
  }
  for (const std::string& name : order) report.result.push_back(std::move(of[name]));
}

// A coefficient's members: more than one where a rotor's two channels share it.
struct Share {
  CalibrationMember member;
  double factor = 1;  ///< member is factor times the coefficient
};

std::vector<Share> SharesOf(const ToolTerm& term, const ToolReadings& readings,
                            const BenchReference& reference) {
  std::vector<Share> shares;
  const double g = reference.gravity_mps2, unit = g / reference.gravity;
  for (const TermUse& use : term.uses) {
    const bool is_gyro = readings.channels[static_cast<std::size_t>(use.channel)].is_gyro;
    Share share;
    share.member = {is_gyro, Kind::kBias, term.power,
                    use.channel - (is_gyro ? readings.n_accel : 0), use.j};
    share.factor = use.sign;
    switch (term.kind) {
      case TermKind::kBias:
        share.member.column = 0;
        break;
      case TermKind::kSensitivity:
        share.member.kind = Kind::kSensitivity;
        share.factor /= is_gyro ? units::kDegPerHour : unit;
        break;
      case TermKind::kSquare:
        share.member.kind = Kind::kSecondOrder;
        share.factor /= unit * unit;
        break;
      case TermKind::kForce:
        share.member.kind = Kind::kForce;
        share.factor /= g;
        break;
      case TermKind::kForceSquare:
        share.member.kind = Kind::kForceSquare;
        share.factor /= g * g;
        break;
      case TermKind::kHeating:
        share.member.kind = Kind::kHeating;
        share.member.column = 0;
        break;
      case TermKind::kHysteresis:
      case TermKind::kDrift:
        continue;
    }
    shares.push_back(share);
  }
  return shares;
}

// With their places among the model's parameters and, behind these, the coefficients left out.
std::vector<std::pair<Eigen::Index, Share>> SharesOf(const ToolModel& model,
                                                     const LeftOutErrors& left_out,
                                                     const ToolReadings& readings,
                                                     const BenchReference& reference) {
  std::vector<std::pair<Eigen::Index, Share>> shares;
  const auto take = [&](const std::vector<ToolTerm>& terms, Eigen::Index column) {
    for (const ToolTerm& term : terms) {
      for (const Share& share : SharesOf(term, readings, reference)) {
        shares.emplace_back(column, share);
      }
      ++column;
    }
  };
  take(model.terms(), 0);
  take(left_out.terms, model.size());
  return shares;
}

SensorGroup EmptyGroup(const ToolReadings& readings, const ToolFitSetup& setup, bool gyro) {
  SensorGroup group;
  group.n_channels = gyro ? readings.n_gyro : readings.n_accel;
  for (int c = 0; c < group.n_channels; ++c) group.channel[static_cast<std::size_t>(c)] = c;
  group.unit = gyro ? "deg/h" : "as read";
  const double sign = !gyro && readings.gravity_signed ? -1 : 1;
  group.R_TS = sign * ToolFromBench(setup.reference.axes);
  if (readings.has_temperature && group.n_channels > 0) {
    group.thermometer = 0;
    group.reference = readings.middle;
    group.half_range = readings.half_range;
    group.min = readings.coldest;
    group.max = readings.hottest;
  }
  return group;
}

void AddHysteresis(const ToolModel& model, const ToolReadings& readings, const ToolAdjustment& a,
                   ToolFit& fit) {
  for (int k = 0; k < model.n_terms(); ++k) {
    const ToolTerm& term = model.terms()[static_cast<std::size_t>(k)];
    if (term.kind != TermKind::kHysteresis) continue;
    const int c = term.uses.front().channel;
    const bool is_gyro = readings.channels[static_cast<std::size_t>(c)].is_gyro;
    const std::string bias =
        NameOf({is_gyro, Kind::kBias, 0, c - (is_gyro ? readings.n_accel : 0), 0});
    const auto& names = fit.members.names;
    const auto at = std::find(names.begin(), names.end(), bias) - names.begin();
    const double square = a.x[k] * a.x[k] + a.cov(k, k);
    fit.members.cov(at, at) += square;
    Eigen::MatrixXd loop = Eigen::MatrixXd::Zero(fit.members.cov.rows(), fit.members.cov.cols());
    loop(at, at) = square;
    fit.members_by_source.Add("hysteresis", std::move(loop));
    fit.calibration.report.remarks.push_back(
        fmt::format("channel {}: a loop of {:.3g} between heating and cooling, which the tool "
                    "model cannot take "
                    "off: it is in the bias's covariance",
                    readings.channels[static_cast<std::size_t>(c)].name, 2 * std::abs(a.x[k])));
  }
}

// Of D x, where x are the model's parameters and behind them the coefficients that were left out.
CovarianceParts PartsOf(const Eigen::MatrixXd& D, const CovarianceParts& of_model,
                        const LeftOutErrors& left_out) {
  const auto n_left = static_cast<Eigen::Index>(left_out.terms.size());
  CovarianceParts parts = Propagated(of_model, D.leftCols(D.cols() - n_left));
  if (n_left > 0) parts.Add("terms left out", D * left_out.cov * D.transpose());
  return parts;
}

}  // namespace

void TakeToolResult(const ToolReadings& readings, const ToolFitSetup& setup, const ToolModel& model,
                    const ToolAdjustment& a, const LeftOutErrors& left_out, ToolFit& fit) {
  FitReport& report = fit.calibration.report;
  report.values += left_out.shift.head(report.values.size());
  report.cov += left_out.cov.topLeftCorner(report.cov.rows(), report.cov.cols());
  ToolParts parts = PartsOf(readings, setup, model, a);
  const CovarianceParts& of_model = parts.cov;
  report.budget = BudgetOf(
      PartsOf(Eigen::MatrixXd::Identity(model.size(), left_out.shift.size()), of_model, left_out));
  AddQuantities(report);
  for (FitQuantity& sigma : parts.found) report.result.push_back(std::move(sigma));
  ToolCalibration tool;
  tool.gyro = EmptyGroup(readings, setup, true);
  tool.accel = EmptyGroup(readings, setup, false);
  // Of the model's parameters, then of what was left out.
  Eigen::VectorXd x = left_out.shift;
  x.head(model.size()) += a.x;
  Eigen::MatrixXd cov = left_out.cov;
  cov.topLeftCorner(model.size(), model.size()) += a.cov;
  const std::vector<std::pair<Eigen::Index, Share>> shares =
      SharesOf(model, left_out, readings, setup.reference);
  const auto n = static_cast<Eigen::Index>(shares.size());
  Eigen::MatrixXd D = Eigen::MatrixXd::Zero(n, x.size());
  for (Eigen::Index at = 0; at < n; ++at) {
    const auto& [column, share] = shares[static_cast<std::size_t>(at)];
    D(at, column) = share.factor;
    ValueOf(tool, share.member) = share.factor * x[column];
    fit.members.names.push_back(NameOf(share.member));
  }
  fit.member_values = D * x;
  // Scatter beyond the sigmas that were given is taken for what the readings have.
  const double scatter = std::max(1.0, report.scatter);
  fit.members.cov = scatter * scatter * D * cov * D.transpose();
  fit.members_by_source = PartsOf(scatter * D, of_model, left_out);
  AddHysteresis(model, readings, a, fit);
  fit.calibration.gyro = tool.gyro;
  fit.calibration.accel = tool.accel;
}

}  // namespace wellgyro
