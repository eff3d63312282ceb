#include "wellgyro/fit/affine_fit.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/fit/added_terms_internal.h"
#include "wellgyro/fit/affine_internal.h"
#include "wellgyro/fit/attitude_table_internal.h"
#include "wellgyro/fit/bench_checks_internal.h"
#include "wellgyro/fit/residual_trends_internal.h"
#include "wellgyro/fit/scalar_internal.h"
#include "wellgyro/fit/sensor_groups_internal.h"

namespace wellgyro {
namespace {

using Order = AffineSetup::Order;

AffineReadings Readings(const AttitudeTable& table, const AffineSetup& setup, bool mag) {
  AffineReadings readings;
  readings.suffix = mag ? "M" : "G";
  readings.channels = mag ? table.mag_channels : table.accel_channels;
  readings.v = mag ? table.mag : table.accel;
  readings.u.resize(table.rows(), 3);
  readings.sigma = mag ? setup.sigma_mag : setup.sigma_accel;
  for (int i = 0; i < table.rows(); ++i) {
    readings.u.row(i) =
        (mag ? table.IdealMag(i, setup.reference) : table.IdealAccel(i, setup.reference))
            .transpose();
  }
  return readings;
}

Eigen::Matrix3d MatrixAt(const Eigen::VectorXd& x, int first) {
  const Eigen::VectorXd nine = x.segment(first, 9);
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(nine.data());
}

SecondOrder OrderOf(Order order) {
  if (order == Order::kNone) return SecondOrder::kNone;
  return order == Order::kOwn ? SecondOrder::kOwn : SecondOrder::kFull;
}

std::vector<AffineReadings> Groups(const AttitudeTable& table, const AffineSetup& setup) {
  std::vector<AffineReadings> groups;
  if (table.accel.rows() > 0) {
    groups.push_back(Readings(table, setup, false));
    groups.back().order = OrderOf(setup.order);
  }
  if (table.mag.rows() > 0 && setup.reference.field && setup.reference.dip) {
    groups.push_back(Readings(table, setup, true));
  }
  return groups;
}

// Groups of unlike units without sigmas are weighed by their own scatter. Gives whether all sigmas
// were given.
bool Weigh(const std::vector<int>& lines, std::vector<AffineReadings>& groups) {
  bool given = true;
  for (AffineReadings& group : groups) {
    if (group.sigma) continue;
    given = false;
    if (groups.size() == 1) continue;
    const LinearSolution alone = Solve(AffineProblem({group}, lines, 0));
    const double scatter = alone.dof > 0 ? std::sqrt(alone.chi_square / alone.dof) : 0;
    group.sigma = std::max(scatter, 1e-12 * group.v.cwiseAbs().maxCoeff());
  }
  return given;
}

void AddGroup(const AffineReadings& readings, const AttitudeTable& table,
              const BenchReference& reference, int first, BenchCalibration& out) {
  const bool is_mag = readings.suffix == "M";
  FitReport& report = out.report;
  const Eigen::VectorXd& x = report.values;
  AddMatrix(report, "S_" + readings.suffix, first + 3, 3, 3);
  AddVector(report, is_mag ? "b_M_nT" : "b_G", first, 3);
  const double si = is_mag ? units::kNanotesla : reference.gravity_mps2 / reference.gravity;
  SensorGroup& group = is_mag ? out.mag : out.accel;
  group = ThreeChannels(x.segment<3>(first), MatrixAt(x, first + 3), si, reference.axes,
                        !is_mag && table.gravity_signed, "as read");
  const int at = first + 12;
  if (readings.order == SecondOrder::kOwn) {
    AddVector(report, "K2_" + readings.suffix, at, 3);
    for (int c = 0; c < 3; ++c) group.second_order(c, c) = x[at + c] / (si * si);
  } else if (readings.order == SecondOrder::kFull) {
    AddMatrix(report, "K2_" + readings.suffix, at, 3, 6);
    for (int c = 0; c < 3; ++c) {
      group.second_order.row(c) = x.segment<6>(at + 6 * c).transpose() / (si * si);
    }
  }
}

std::optional<Fault> BadTable(const BenchTable& data, const AttitudeTable& table,
                              const AffineSetup& setup) {
  if (table.accel.rows() == 0 && table.mag.rows() == 0) {
    return BenchFault(data, "the table has no columns of accelerometers or magnetometers", 1,
                      FaultCode::kForeign);
  }
  const int least = setup.order == Order::kNone ? 4 : setup.order == Order::kOwn ? 5 : 10;
  if (auto fault = TooFew(data, least, "attitudes", "measure more, not all in one plane")) {
    return fault;
  }
  return BadReadings(data, table);
}

// What the references and the stand's zeros are off by [rad].
struct Change {
  double inclination = 0, dip = 0, declination = 0;
};

std::vector<AffineReadings> GroupsAt(AttitudeTable table, AffineSetup setup, const Change& change) {
  table.inclination.array() += change.inclination;
  if (setup.reference.dip) *setup.reference.dip += change.dip;
  setup.reference.declination += change.declination;
  return Groups(table, setup);
}

// S du/dp of each group and position, about the solution, p along `unit` [a degree].
std::vector<Eigen::MatrixX3d> By(const AttitudeTable& table, const AffineSetup& setup,
                                 const Change& unit, const Eigen::VectorXd& x) {
  constexpr double kStep = 1e-4;  // rad: to 2e-9 of du/dp
  const auto at = [&](double step) {
    return GroupsAt(table, setup,
                    {step * unit.inclination, step * unit.dip, step * unit.declination});
  };
  const std::vector<AffineReadings> above = at(kStep), below = at(-kStep);
  std::vector<Eigen::MatrixX3d> all;
  int first = 0;
  for (std::size_t g = 0; g < above.size(); ++g) {
    const Eigen::Matrix3d S = MatrixAt(x, first + 3);
    first += above[g].size();
    all.emplace_back((above[g].u - below[g].u) / ToDegrees(2 * kStep) * S.transpose());
  }
  return all;
}
constexpr Change kZero{.inclination = 1};

// The groups' readings, one problem, and what it comes to.
struct FittedAffine {
  std::vector<AffineReadings> groups;
  LinearProblem problem;
  LinearSolution solution;
};

// A stand whose zero of inclination is off moves every u by du/dI, of which a bias takes the mean
// and nothing else has the pattern; a wrong dip or declination moves the field's by another.
AddedTerm TermOf(const FittedAffine& fitted, const AttitudeTable& table, const AffineSetup& setup,
                 const Change& unit, double probability) {
  const std::vector<Eigen::MatrixX3d> by = By(table, setup, unit, fitted.solution.x);
  const auto width = 3 * static_cast<Eigen::Index>(by.size());
  Eigen::MatrixXd z = Eigen::MatrixXd::Zero(fitted.problem.y.size(), 1);
  for (std::size_t g = 0; g < by.size(); ++g) {
    for (Eigen::Index i = 0; i < by[g].rows(); ++i) {
      z.block<3, 1>(i * width + 3 * static_cast<Eigen::Index>(g), 0) = by[g].row(i).transpose();
    }
  }
  return AddedTerms(fitted.problem, fitted.solution).Test(z, probability).front();
}

// The likelier of a wrong dip and a wrong declination, of magnetometers.
void TellField(const FittedAffine& fitted, const AttitudeTable& table, const AffineSetup& setup,
               FitReport& report) {
  const bool mag = std::any_of(fitted.groups.begin(), fitted.groups.end(),
                               [](const AffineReadings& group) { return group.suffix == "M"; });
  if (!mag) return;
  constexpr double kEach = kFalseAlarm / 2 / 2;
  const AddedTerm dip = TermOf(fitted, table, setup, {.dip = 1}, kEach);
  const AddedTerm declination = TermOf(fitted, table, setup, {.declination = 1}, kEach);
  const bool of_dip = dip.sigmas >= declination.sigmas;
  const AddedTerm& worst = of_dip ? dip : declination;
  if (!(worst.sigmas > worst.limit)) return;
  report.remarks.push_back(fmt::format(
      "the readings suit a {} {:+.3g} deg beside the one given ({:.1f} sigmas, chance reaches "
      "{:.1f}): the reference is wrong; with a term for it {} would move by {:.1f} of its sigmas "
      "({})",
      of_dip ? "dip" : "declination", worst.coefficient, worst.sigmas, worst.limit, worst.moved,
      worst.moved_sigmas, of_dip ? "--dip-deg" : "--declination-deg"));
}

FittedAffine Fitted(const AttitudeTable& table, const AffineSetup& setup,
                    std::vector<AffineReadings> groups) {
  const bool given = Weigh(table.lines, groups);
  if (setup.tilt_sigma > 0 && !given) {
    throw std::invalid_argument("the tilt's sigma needs the sigmas of the readings beside it");
  }
  LinearProblem problem = AffineProblem(groups, table.lines, setup.tilt_sigma);
  problem.sigma_given = given;
  LinearSolution solution = Solve(problem);
  return {std::move(groups), std::move(problem), std::move(solution)};
}

// The same with the zero as an unknown, from which the inclinations are taken [deg]. Bilinear in it
// and S: Gauss and Newton.
FittedAffine WithZero(AttitudeTable& table, const AffineSetup& setup, FittedAffine fitted,
                      double& zero) {
  constexpr double kStill = 1e-9;  // deg, of a sigma of 1e-4 and more
  for (int turn = 0; turn < 20; ++turn) {
    std::vector<AffineReadings> groups = Groups(table, setup);
    std::vector<Eigen::MatrixX3d> by_zero = By(table, setup, kZero, fitted.solution.x);
    for (std::size_t g = 0; g < groups.size(); ++g) groups[g].by_zero = std::move(by_zero[g]);
    fitted = Fitted(table, setup, std::move(groups));
    const double more = fitted.solution.x.tail<1>()[0];
    if (std::abs(more) < kStill) break;
    table.inclination.array() += FromDegrees(more);
    zero += more;
  }
  return fitted;
}

// One parameter of the report more, the zero [deg].
void TakeZero(const AddedTerm& told, double zero, FitReport& report) {
  const int at = static_cast<int>(report.values.size()) - 1;
  report.values[at] = zero;
  AddNumber(report, "inclination_deg", at);
  report.remarks.push_back(fmt::format(
      "the readings suit inclinations {:+.3g} deg beside the ones given ({:.1f} sigmas, chance "
      "reaches {:.1f}): the zero of the stand's inclination is off, and found beside the sensors' "
      "own unknowns (inclination_deg); without it {} would be off by {:.1f} of its sigmas",
      zero, told.sigmas, told.limit, told.moved, told.moved_sigmas));
}

std::optional<Fault> TakeGroups(const BenchTable& data, const AttitudeTable& table,
                                const AffineSetup& setup, const std::vector<AffineReadings>& groups,
                                BenchCalibration& out) {
  // What a channel varies by is its own sensitivity's, whatever its unit.
  std::vector<ChannelSignal> signals;
  int first = 0;
  for (const AffineReadings& group : groups) {
    if (auto fault = WrongAxes(data, MatrixAt(out.report.values, first + 3), group.channels)) {
      return *fault;
    }
    const Eigen::Matrix3d S = MatrixAt(out.report.values, first + 3);
    const bool forces = group.suffix == "G";
    if (auto fault = forces ? OtherUnit(data, group.channels, S, setup.reference) : std::nullopt) {
      return *fault;
    }
    for (int c = 0; c < 3; ++c) {
      signals.push_back({group.channels[static_cast<std::size_t>(c)],
                         S.row(c).norm() * group.u.rowwise().norm().mean()});
    }
    AddGroup(group, table, setup.reference, first, out);
    first += group.size();
  }
  return DoesNotFit(data, signals, out.report);
}

}  // namespace

Result<BenchCalibration> FitAffine(const BenchTable& data, const AffineSetup& setup) {
  auto table = ReadAttitudeTable(data, {.attitude = true});
  if (!table) return table.fault();
  if (auto fault = BadTable(data, *table, setup)) return *fault;
  std::vector<AffineReadings> groups = Groups(*table, setup);
  if (groups.empty()) throw std::invalid_argument("the magnetometers need the field and its dip");
  FittedAffine fitted = Fitted(*table, setup, std::move(groups));
  const AddedTerm told = TermOf(fitted, *table, setup, kZero, kFalseAlarm / 2);
  double zero = 0;
  const bool off = told.sigmas > told.limit;
  if (off) fitted = WithZero(*table, setup, std::move(fitted), zero);
  auto whole = WholeReport(data, fitted.problem, fitted.solution,
                           "measure attitudes that are not all in one plane or on one cone");
  if (!whole) return whole.fault();
  BenchCalibration out;
  out.report = *std::move(whole);
  out.report.method = "affine";
  if (auto fault = TakeGroups(data, *table, setup, fitted.groups, out)) return *fault;
  RemarkTemperature(data, out.report);
  if (off) TakeZero(told, zero, out.report);
  TellField(fitted, *table, setup, out.report);
  if (table->mag.rows() > 0 && out.mag.n_channels == 0) {
    out.report.remarks.emplace_back(
        "the magnetometers are left out: they need the field and its dip (--field-nt, --dip-deg)");
  }
  return out;
}

}  // namespace wellgyro
