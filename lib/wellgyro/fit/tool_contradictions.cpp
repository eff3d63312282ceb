#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <fmt/core.h>

#include "wellgyro/fit/added_terms_internal.h"
#include "wellgyro/fit/hemisphere_internal.h"
#include "wellgyro/fit/tool_contradictions_internal.h"

namespace wellgyro {
namespace {

// What each row of readings gives its channels, by row of the adjustment's linear problem.
Eigen::VectorXd ByRow(const ToolReadings& readings, const ToolAdjustment& a,
                      const std::function<Eigen::VectorXd(const ToolRow&)>& of) {
  Eigen::VectorXd column = Eigen::VectorXd::Zero(a.linear.y.size());
  for (Eigen::Index at = 0; at < column.size();) {
    const int line = a.linear.rows[static_cast<std::size_t>(at)].line;
    if (line == 0) break;  // what was known before
    const Eigen::VectorXd each = of(readings.rows[static_cast<std::size_t>(line) - 1]);
    column.segment(at, each.size()) = each;
    at += each.size();
  }
  return column;
}

// What a row's channels read of their own force or rate.
Eigen::VectorXd Sensed(const ToolModel& model, const ToolRow& row, const Eigen::VectorXd& x) {
  Eigen::VectorXd sensed = Eigen::VectorXd::Zero(row.v.size());
  const ToolModel::Prediction at = model.At(row, x);
  for (int k = 0; k < model.n_terms(); ++k) {
    if (model.terms()[static_cast<std::size_t>(k)].kind == TermKind::kSensitivity) {
      sensed += at.J.col(k) * x[k];
    }
  }
  return sensed;
}

// By how much a row's channels change with what the thermometer says.
Eigen::VectorXd Warmed(const ToolModel& model, ToolRow row, const Eigen::VectorXd& x) {
  constexpr double kStep = 0.5;  // degC: differences of cubics in tens of degrees, to 1e-4
  row.temperature += kStep;
  const Eigen::VectorXd above = model.At(row, x).v;
  row.temperature -= 2 * kStep;
  return (above - model.At(row, x).v) / (2 * kStep);
}

// Terms that one table has beside the others, each tested alone: of all tables together the last
// one's follow from the others'.
class TableTests {
 public:
  TableTests(std::span<const BenchTable> tables, const ToolReadings& readings,
             const ToolAdjustment& a)
      : tables_(tables), readings_(readings), added_(a.linear, a.solution), rows_(a.linear.rows) {
    const double kinds = static_cast<double>(readings.channels.size()) + 1;
    each_ = kFalseAlarm / 2 / (kinds * static_cast<double>(tables.size()));
  }

  // `text` takes the table's name, the channel's and the coefficient.
  template <class Text>
  void TryChannels(const Eigen::VectorXd& column, const Text& text) {
    for (std::size_t c = 0; c < readings_.channels.size(); ++c) {
      const std::string& name = readings_.channels[c].name;
      Try(column, name, [&](const std::string& table, double coefficient) {
        return text(table, name, coefficient);
      });
    }
  }
  // `text` takes the table's name and the coefficient. Of one channel, or of all: "".
  template <class Text>
  void Try(const Eigen::VectorXd& column, const std::string& channel, const Text& text) {
    for (std::size_t t = 0; t < tables_.size(); ++t) {
      const AddedTerm term = added_.Test(Of(column, t, channel), each_).front();
      if (!(term.sigmas > term.limit) || term.sigmas <= worst_.sigmas) continue;
      worst_ = term;
      said_ = text(tables_[t].source, term.coefficient);
    }
  }

  void Tell(FitReport& report) const {
    if (said_.empty()) return;
    report.remarks.push_back(fmt::format(
        "{} ({:.1f} of its sigmas, chance reaches {:.1f}); with a term for it {} would move by "
        "{:.1f} of its sigmas: measure that table again, or leave it out",
        said_, worst_.sigmas, worst_.limit, worst_.moved, worst_.moved_sigmas));
  }

 private:
  Eigen::VectorXd Of(const Eigen::VectorXd& column, std::size_t table,
                     const std::string& channel) const {
    Eigen::VectorXd its = Eigen::VectorXd::Zero(column.size());
    for (Eigen::Index i = 0; i < column.size(); ++i) {
      const FitRow& label = rows_[static_cast<std::size_t>(i)];
      if (label.line == 0) break;
      const ToolRow& row = readings_.rows[static_cast<std::size_t>(label.line) - 1];
      const bool is_its = channel.empty() || label.channel == channel ||
                          (row.mount >= 0 && label.channel == "table " + channel);
      if (is_its && static_cast<std::size_t>(row.table) == table) its[i] = column[i];
    }
    return its;
  }

  std::span<const BenchTable> tables_;
  const ToolReadings& readings_;
  AddedTerms added_;
  const std::vector<FitRow>& rows_;
  double each_ = 0;
  AddedTerm worst_;
  std::string said_;
};

}  // namespace

void TellHemisphere(const ToolReadings& readings, const ToolFitSetup& setup, const ToolModel& model,
                    const ToolAdjustment& a, FitReport& report) {
  if (readings.n_gyro == 0) return;
  ToolFitSetup turned = setup;
  turned.reference.latitude = -*setup.reference.latitude;
  const ToolModel other(readings, turned, model.terms());
  std::vector<Eigen::Index> forces;
  for (int k = 0; k < model.n_terms(); ++k) {
    const ToolTerm& term = model.terms()[static_cast<std::size_t>(k)];
    if (term.kind == TermKind::kForce && term.power == 0) forces.push_back(k);
  }
  auto remark = OtherHemisphere(
      a.linear, a.solution,
      [&](const Eigen::VectorXd& x) { return LineariseTool(readings, other, a.noise, a.out, x); },
      forces);
  if (remark) report.remarks.push_back(*std::move(remark));
}

void TellTables(std::span<const BenchTable> tables, const ToolReadings& readings,
                const ToolModel& model, const ToolAdjustment& a, FitReport& report) {
  if (tables.size() < 2) return;
  TableTests tests(tables, readings, a);
  const auto sensed = [&](const ToolRow& row) { return Sensed(model, row, a.x); };
  tests.TryChannels(ByRow(readings, a, sensed), [](const std::string& table,
                                                   const std::string& channel, double part) {
    return fmt::format(
        "{}: channel {} reads {:+.3g} % of what it reads in the other tables beside that: its gain "
        "or unit is not the same",
        table, channel, 100 * part);
  });
  if (readings.has_temperature) {
    const auto warmed = [&](const ToolRow& row) { return Warmed(model, row, a.x); };
    tests.Try(ByRow(readings, a, warmed), "", [](const std::string& table, double degrees) {
      return fmt::format(
          "{}: the readings suit temperatures {:+.3g} degC beside those written down: a "
          "thermometer "
          "is off, there or in the other tables, or the sensors lag behind it",
          table, degrees);
    });
  }
  tests.Tell(report);
}

}  // namespace wellgyro
