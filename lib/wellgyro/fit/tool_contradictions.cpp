#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <fmt/core.h>

#include "wellgyro/base/angle.h"
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
    const double kinds = 2 * static_cast<double>(readings.channels.size()) + 1;
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

// A setting of the stand: an angle at which several readings were taken.
struct Setting {
  std::size_t angle = 0;  ///< of kAngles
  double at = 0;          ///< [deg]
};
struct NamedAngle {
  const char* name;
  double StandAngles::*held;
};
constexpr NamedAngle kAngles[] = {{"inclination", &StandAngles::inclination},
                                  {"azimuth", &StandAngles::azimuth},
                                  {"toolface", &StandAngles::toolface}};

bool operator<(const Setting& a, const Setting& b) {
  return std::pair(a.angle, a.at) < std::pair(b.angle, b.at);
}

Setting SettingOf(const ToolRow& row, std::size_t angle) {
  constexpr double kDigits = 1e-6;  // deg: a number read twice from a table is the same
  const double degrees = ToDegrees(row.stated.*kAngles[angle].held);
  return {angle, std::round(degrees / kDigits) * kDigits};
}

// Of rows at rest, with the number of readings of each.
std::map<Setting, std::size_t> SettingsOf(const ToolReadings& readings, const ToolAdjustment& a) {
  std::map<Setting, std::size_t> count;
  for (std::size_t i = 0; i < readings.rows.size(); ++i) {
    if (readings.rows[i].mount >= 0 || a.out[i] != 0) continue;
    for (std::size_t k = 0; k < std::size(kAngles); ++k) ++count[SettingOf(readings.rows[i], k)];
  }
  std::erase_if(count, [](const auto& each) { return each.second < kBesideStep; });
  return count;
}

// By how much a row's channels change with one of its stated angles [a radian].
Eigen::VectorXd ByAngle(const ToolModel& model, BenchAxes axes, ToolRow row, std::size_t angle,
                        const Eigen::VectorXd& x) {
  constexpr double kStep = 1e-4;  // rad: the difference is exact to kStep^2 / 6
  StandAngles stated = row.stated;
  double& its = stated.*kAngles[angle].held;
  its += kStep;
  SetAttitude(axes, stated, row);
  const Eigen::VectorXd above = model.At(row, x).v;
  its -= 2 * kStep;
  SetAttitude(axes, stated, row);
  return (above - model.At(row, x).v) / (2 * kStep);
}

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
  const auto one = [](const ToolRow& row) -> Eigen::VectorXd {
    return Eigen::VectorXd::Ones(row.v.size());
  };
  tests.TryChannels(ByRow(readings, a, one), [](const std::string& table,
                                                const std::string& channel, double offset) {
    return fmt::format(
        "{}: channel {} reads {:+.3g} beside what it reads in the other tables: its bias is not "
        "the same, as after the power was off",
        table, channel, offset);
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

void TellSettings(const ToolReadings& readings, const ToolFitSetup& setup, const ToolModel& model,
                  const ToolAdjustment& a, FitReport& report) {
  const std::map<Setting, std::size_t> settings = SettingsOf(readings, a);
  const AddedTerms added(a.linear, a.solution);
  const double each = kFalseAlarm / 2 / std::max(1.0, static_cast<double>(settings.size()));
  AddedTerm worst;
  Setting off;
  for (const auto& [setting, count] : settings) {
    const auto of = [&, one = setting](const ToolRow& row) -> Eigen::VectorXd {
      const Setting its = SettingOf(row, one.angle);
      if (row.mount >= 0 || one < its || its < one) return Eigen::VectorXd::Zero(row.v.size());
      return ByAngle(model, setup.reference.axes, row, one.angle, a.x);
    };
    const AddedTerm term = added.Test(ByRow(readings, a, of), each).front();
    if (!(term.sigmas > term.limit) || term.sigmas <= worst.sigmas) continue;
    worst = term;
    off = setting;
  }
  if (worst.sigmas == 0) return;
  report.remarks.push_back(fmt::format(
      "{} {:.6g} deg: its readings suit one of {:+.3g} deg beside it ({:.1f} of its sigmas, chance "
      "reaches {:.1f} in {} settings); with a term for it {} would move by {:.1f} of its sigmas: "
      "look at that stop of the stand and at its number in the table",
      kAngles[off.angle].name, off.at, ToDegrees(worst.coefficient), worst.sigmas, worst.limit,
      settings.size(), worst.moved, worst.moved_sigmas));
}

}  // namespace wellgyro
