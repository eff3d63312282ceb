#include "wellgyro/fit/tool_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <Eigen/Dense>
#include <fmt/core.h>
#include <fmt/ranges.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/fit/bench_checks_internal.h"
#include "wellgyro/fit/residual_trends_internal.h"
#include "wellgyro/fit/tool_adjust_internal.h"
#include "wellgyro/fit/tool_choice_internal.h"
#include "wellgyro/fit/tool_contradictions_internal.h"
#include "wellgyro/fit/tool_observability_internal.h"
#include "wellgyro/fit/tool_references_internal.h"
#include "wellgyro/fit/tool_result_internal.h"
#include "wellgyro/fit/tool_unseen_internal.h"

namespace wellgyro {
namespace {

std::vector<ToolTerm> TermsOf(const std::vector<TermBundle>& bundles,
                              const std::vector<int>& places) {
  std::vector<ToolTerm> terms;
  for (const int place : places) {
    const auto& more = bundles[static_cast<std::size_t>(place)].terms;
    terms.insert(terms.end(), more.begin(), more.end());
  }
  return terms;
}

void TellLeftOut(const std::vector<TermBundle>& bundles, const std::vector<int>& seen,
                 const std::vector<int>& chosen, const ToolAdjustment& full, ToolFit& fit) {
  constexpr double k95 = 1.96;  // sigmas to either side that hold 95 % of a normal distribution
  for (std::size_t b = 0; b < bundles.size(); ++b) {
    const int place = static_cast<int>(b);
    if (std::count(chosen.begin(), chosen.end(), place) > 0) continue;
    LeftOutTerm term{bundles[b].name, 0, false};
    for (const Eigen::Index k : PlacesIn(bundles, seen, place)) {
      term.seen = true;
      term.bound = std::max(term.bound,
                            std::abs(full.x[k]) + k95 * std::sqrt(std::max(0.0, full.cov(k, k))));
    }
    if (!bundles[b].terms.empty()) fit.left_out.push_back(std::move(term));
  }
}

// What the readings by themselves say of an unknown that was known before, where that is far off.
struct Asked {
  double value = 0, sigmas = 0;
};

// Of a prior of sigma s that the readings narrow to v, the estimate scatters by sqrt(s^2 - v),
// however little they narrow it.
std::optional<Asked> FarOff(const ToolAdjustment& a, Eigen::Index at, double prior_sigma) {
  // P(|x| > 3.5) = 4.7e-4: of 20 unknowns of a sound bench one in a hundred is asked about. A prior
  // narrowed by less than 1e-7 is a difference of two variances equal to seven digits.
  constexpr double kFar = 3.5, kLeastNarrowed = 1e-7;
  const double prior = prior_sigma * prior_sigma, narrowed = prior - a.cov(at, at);
  if (!(narrowed > kLeastNarrowed * prior)) return std::nullopt;
  const Asked asked{a.x[at] * prior / narrowed, std::abs(a.x[at]) / std::sqrt(narrowed)};
  return asked.sigmas > kFar ? std::optional(asked) : std::nullopt;
}

void TellTerms(const ToolModel& model, const ToolAdjustment& a, ToolFit& fit) {
  constexpr double kSure = 5;  // sigmas, P = 5.7e-7
  for (int k = 0; k < model.n_terms(); ++k) {
    const ToolTerm& term = model.terms()[static_cast<std::size_t>(k)];
    const double sigma = std::sqrt(std::max(0.0, a.cov(k, k)));
    if (term.kind == TermKind::kDrift && term.prior_sigma == 0 &&
        std::abs(a.x[k]) > kSure * sigma) {
      fit.calibration.report.remarks.push_back(fmt::format(
          "{} is {:.3g} +- {:.2g}: accelerometers do not drift so in hours; one that stepped on "
          "the "
          "way looks like this too, and then the result is beyond its sigmas: repeat what was "
          "measured first",
          term.name, a.x[k], sigma));
    }
    const auto asked = FarOff(a, k, term.prior_sigma);
    if (!asked) continue;
    if (term.kind != TermKind::kDrift) {
      fit.calibration.report.remarks.push_back(fmt::format(
          "{}: the readings ask for {:.3g} where its sigma beforehand is {:.2g}, {:.1f} sigmas off",
          term.name, asked->value, term.prior_sigma, asked->sigmas));
      continue;
    }
    fit.calibration.report.remarks.push_back(fmt::format(
        "{}: the readings ask for {:.3g} deg/h where a drift has a sigma of {:.2g}, {:.1f} sigmas "
        "off: the gyro is not what it is taken for, or the table's order or temperatures are not",
        term.name, asked->value, term.prior_sigma, asked->sigmas));
  }
}

// "axis_x_of_table_3[1] (the tool's seat on the rate table)".
std::string NuisanceText(const std::string& name) {
  return name.rfind("axis_", 0) == 0 ? name + " (the tool's seat on the rate table)" : name;
}

// The adjustment is linear in a turn: of a large one it says that it is large, not how large.
std::string AskedText(double turn, const BenchNuisance& nuisance) {
  if (nuisance.unit == "1") return fmt::format("{:.3g} of the rate", turn);
  constexpr double kLinear = FromDegrees(10);  // sine and angle part by 0.5 %, 1 - cos is 1.5 %
  if (std::abs(turn) < kLinear) return fmt::format("{:.3g} deg", ToDegrees(turn));
  return fmt::format("far more than its sigma of {:.2g} deg", ToDegrees(nuisance.prior_sigma));
}

// What the readings say of the bench against what was said before; values and sigmas as reported,
// with what was left out.
void TellNuisances(const ToolModel& model, const ToolAdjustment& a, ToolFit& fit) {
  for (std::size_t i = 0; i < model.nuisances().size(); ++i) {
    BenchNuisance nuisance = model.nuisances()[i];
    const auto at = static_cast<Eigen::Index>(i) + model.n_terms();
    nuisance.value = fit.calibration.report.values[at];
    nuisance.sigma = std::sqrt(std::max(0.0, fit.calibration.report.cov(at, at)));
    if (const auto asked = FarOff(a, at, nuisance.prior_sigma)) {
      fit.calibration.report.remarks.push_back(fmt::format(
          "{}: the readings ask for {} beside what was given, {:.1f} sigmas off: the reference is "
          "wrong, or a unit or sign of the table",
          NuisanceText(nuisance.name), AskedText(asked->value, nuisance), asked->sigmas));
    }
    fit.nuisances.push_back(std::move(nuisance));
  }
  const std::array wobbles{a.noise.wobble, a.noise.wobble_table};
  for (std::size_t k = 0; k < 2; ++k) {
    // Without a sigma: given, or no such readings.
    const bool given = k == 0 && a.sigma_wobble_square[0] == 0 && a.sigma_wobble_square[1] == 0;
    if (!(wobbles[k] > 0 && (a.sigma_wobble_square[k] > 0 || given))) continue;
    // Of a variance v known to s, its root's sigma; where v is nothing beside s, what it may be.
    const double v = wobbles[k] * wobbles[k], s = a.sigma_wobble_square[k];
    const double sigma = v > 2 * s ? s / (2 * wobbles[k]) : std::sqrt(v + s);
    const char* const name = k == 0 ? "wobble" : "wobble_of_rate_table";
    fit.nuisances.push_back({name, wobbles[k], s > 0 ? sigma : 0, 0, "rad"});
    if (!(s > 0)) continue;
    fit.calibration.report.result.push_back({name, FitQuantity::Shape::kNumber,
                                             Eigen::MatrixXd::Constant(1, 1, wobbles[k]),
                                             Eigen::MatrixXd::Constant(1, 1, sigma)});
  }
}

// The tables' files, for what is said of all readings.
std::string SourcesOf(std::span<const BenchTable> tables) {
  std::string sources;
  for (const BenchTable& data : tables) {
    sources += (sources.empty() ? "" : ", ") + data.source;
  }
  return sources;
}

Fault FaultOfAll(std::span<const BenchTable> tables, std::string text) {
  return {.code = FaultCode::kRange, .text = std::move(text), .source = SourcesOf(tables)};
}

// The tables as one, its lines the readings' places plus one, for the report.
BenchTable Joint(std::span<const BenchTable> tables, const ToolReadings& readings) {
  BenchTable joint{SourcesOf(tables), {}, {}, {}};
  const auto n = static_cast<Eigen::Index>(readings.rows.size());
  if (readings.has_temperature) joint.columns = {"T_C"};
  joint.values.resize(n, readings.has_temperature ? 1 : 0);
  for (Eigen::Index i = 0; i < n; ++i) {
    joint.lines.push_back(static_cast<int>(i) + 1);
    if (readings.has_temperature) {
      joint.values(i, 0) = readings.rows[static_cast<std::size_t>(i)].temperature;
    }
  }
  return joint;
}

// Of a line of Joint().
std::size_t RowAt(int line) { return static_cast<std::size_t>(line) - 1; }

std::string ReadingName(std::span<const BenchTable> tables, const ToolRow& row) {
  const std::string line = LineName(row.line);
  if (tables.size() == 1) return line;
  return fmt::format("{}, {}", tables[static_cast<std::size_t>(row.table)].source, line);
}

// Of lines of Joint().
ReadingPlaces ReadingPlacesOf(std::span<const BenchTable> tables, const ToolReadings& readings) {
  const auto text = [tables, &readings](const std::vector<int>& lines) {
    std::vector<std::string> parts;
    for (std::size_t table = 0; table < tables.size(); ++table) {
      std::vector<int> here;
      for (const int line : lines) {
        const ToolRow& row = readings.rows[RowAt(line)];
        if (static_cast<std::size_t>(row.table) == table) here.push_back(row.line);
      }
      if (here.empty()) continue;
      const std::string of = tables.size() == 1 ? "" : " of " + tables[table].source;
      parts.push_back(LinesText(here) + of);
    }
    return fmt::format("{}", fmt::join(parts, " and "));
  };
  const auto fault = [tables, &readings](std::string said, int line) {
    const ToolRow& row = readings.rows[RowAt(line)];
    return BenchFault(tables[static_cast<std::size_t>(row.table)], std::move(said), row.line);
  };
  return {text, fault};
}

// Where a channel tells most of its axis: on the rate table, else where it was read first.
const BenchTable& TableOf(std::span<const BenchTable> tables, const ToolReadings& readings,
                          int channel) {
  int first = -1;
  for (const ToolRow& row : readings.rows) {
    if (std::count(row.channels.begin(), row.channels.end(), channel) == 0) continue;
    if (row.mount >= 0) return tables[static_cast<std::size_t>(row.table)];
    if (first < 0) first = row.table;
  }
  return tables[static_cast<std::size_t>(std::max(first, 0))];
}

// Lines and tables as people know them.
void NameLines(std::span<const BenchTable> tables, const ToolReadings& readings,
               const ToolAdjustment& a, FitReport& report) {
  for (FitResidual& residual : report.residuals) {
    const ToolRow& row = readings.rows[RowAt(residual.line)];
    residual.line = row.line;
    if (tables.size() > 1) residual.channel += fmt::format(" of table {}", row.table + 1);
  }
  for (std::size_t i = 0; i < a.out.size(); ++i) {
    if (a.out[i] != 0) report.outlier_lines.push_back(readings.rows[i].line);
  }
}

// Bad readings come alone: where many are left out in a row, what is there is another state of the
// tool or of the bench.
void TellLeftOutLines(std::span<const BenchTable> tables, const ToolReadings& readings,
                      const ToolAdjustment& a, FitReport& report) {
  // Up to a quarter of the readings may be left out: (1/4)^4 = 0.4 % in a row by chance, 2e-7 where
  // it is one in fifty.
  constexpr std::size_t kStretch = 4;
  for (std::size_t i = 0; i < a.out.size();) {
    std::size_t end = i;
    while (end < a.out.size() && a.out[end] != 0 &&
           readings.rows[end].table == readings.rows[i].table) {
      ++end;
    }
    const std::size_t n = end - i;
    if (n >= kStretch) {
      report.remarks.push_back(fmt::format(
          "{} to line {} are left out, {} readings in a row: something changed there, the tool or "
          "the bench, and the result holds for neither side of it; measure that table again",
          ReadingName(tables, readings.rows[i]), readings.rows[end - 1].line, n));
    }
    for (; i < end && n < kStretch && tables.size() > 1; ++i) {
      report.remarks.push_back(fmt::format("{} is left out: it does not belong to the others",
                                           ReadingName(tables, readings.rows[i])));
    }
    i = std::max(end, i + 1);
  }
}

// A channel's own, at the middle temperature [its unit per unit of gravity's, or per deg/h].
Eigen::Vector3d SensitivityOf(const ToolModel& model, const Eigen::VectorXd& x,
                              std::size_t channel) {
  Eigen::Vector3d S = Eigen::Vector3d::Zero();
  for (int k = 0; k < model.n_terms(); ++k) {
    const ToolTerm& term = model.terms()[static_cast<std::size_t>(k)];
    const TermUse& use = term.uses.front();
    if (term.kind == TermKind::kSensitivity && term.power == 0 &&
        use.channel == static_cast<int>(channel)) {
      S[use.j] = x[k];
    }
  }
  return S;
}

std::optional<Fault> WrongChannel(const BenchTable& data, const ToolChannel& channel,
                                  const Eigen::Vector3d& S) {
  Eigen::Index most = 0;
  const double size = S.cwiseAbs().maxCoeff(&most);
  if (most != channel.axis) {
    return BenchFault(
        data, fmt::format("channel {} follows {}{}: its axis is not {}; exchange the "
                          "columns, or mend their names",
                          channel.name, S[most] < 0 ? "-" : "", "xyz"[most], "xyz"[channel.axis]));
  }
  if (S[most] <= 0) {
    return BenchFault(data, fmt::format("channel {} falls where {} rises: its sign is wrong, or up "
                                        "and down of the positions are swapped",
                                        channel.name, "xyz"[most]));
  }
  return channel.is_gyro ? OtherRate(data, channel.name, size) : std::nullopt;
}

std::optional<Fault> WrongChannels(std::span<const BenchTable> tables, const ToolReadings& readings,
                                   const ToolModel& model, const Eigen::VectorXd& x) {
  for (std::size_t c = 0; c < readings.channels.size(); ++c) {
    const BenchTable& data = TableOf(tables, readings, static_cast<int>(c));
    if (auto fault = WrongChannel(data, readings.channels[c], SensitivityOf(model, x, c))) {
      return fault;
    }
  }
  return std::nullopt;
}

// What a channel varies by, for DoesNotFit: at rest.
std::vector<ChannelSignal> Signals(const ToolReadings& readings, const ToolModel& model,
                                   const Eigen::VectorXd& x, const ToolFitSetup& setup) {
  std::vector<ChannelSignal> signals;
  for (std::size_t c = 0; c < readings.channels.size(); ++c) {
    const double size = readings.channels[c].is_gyro ? kBenchEarthRate / units::kDegPerHour
                                                     : setup.reference.gravity;
    signals.push_back({readings.channels[c].name, SensitivityOf(model, x, c).norm() * size});
  }
  return signals;
}

// Readings of gyros or of accelerometers beyond the terms that they tell.
Eigen::Index Redundancy(const ToolReadings& readings, const ToolModel& model,
                        const ToolAdjustment& a, bool of_gyros) {
  const auto is_of = [&](int channel) {
    return readings.channels[static_cast<std::size_t>(channel)].is_gyro == of_gyros;
  };
  Eigen::Index more = 0;
  for (std::size_t i = 0; i < readings.rows.size(); ++i) {
    const std::vector<int>& channels = readings.rows[i].channels;
    if (a.out[i] == 0) more += std::count_if(channels.begin(), channels.end(), is_of);
  }
  for (const ToolTerm& term : model.terms()) more -= is_of(term.uses.front().channel) ? 1 : 0;
  return more;
}

// Sigmas that are found from a few readings, and scatter that no bench has.
void TellNoise(const ToolReadings& readings, const ToolFitSetup& setup, const ToolModel& model,
               const ToolAdjustment& a, FitReport& report) {
  for (const bool gyros : {false, true}) {
    const bool stated = (gyros ? setup.sigma_gyro : setup.sigma_accel) && setup.sigma_wobble;
    if ((gyros ? readings.n_gyro : readings.n_accel) == 0 || stated) continue;
    const Eigen::Index more = Redundancy(readings, model, a, gyros);
    if (more >= kToFindNoise) continue;
    report.remarks.push_back(fmt::format(
        "{} give {} readings more than there are unknowns: too few to find their noise and to "
        "choose terms by, and every sigma may be several times too small; read more positions, or "
        "state {} and --wobble-arcsec",
        gyros ? "gyros" : "accelerometers", more, gyros ? "--sigma-deg-per-h" : "--sigma-accel"));
  }
  // Three times what a coarse bench repeats an attitude to.
  constexpr double kWobble = FromDegrees(0.1);
  std::size_t at = 0;
  double accel = 0;
  for (const ChannelSignal& signal : Signals(readings, model, a.x, setup)) {
    const bool force = !readings.channels[at++].is_gyro;
    if (force && !setup.sigma_accel) accel = std::max(accel, a.noise.accel / signal.signal);
  }
  if (std::max(a.noise.wobble, accel) > kWobble) {
    report.remarks.push_back(fmt::format(
        "attitudes repeat to {:.2g} deg and accelerometers to {:.2g} of gravity: no bench is that "
        "coarse; a column of the table is off, or readings stepped on the way, and what they did "
        "to the result is beyond its sigmas",
        ToDegrees(a.noise.wobble), accel));
  }
}

Result<ToolFit> Whole(std::span<const BenchTable> tables, const ToolReadings& readings,
                      const ToolFitSetup& setup, const ToolModel& model, const ToolAdjustment& a,
                      const LeftOutErrors& left_out) {
  ToolFit fit;
  FitReport& report = fit.calibration.report;
  const auto name = [&](int line) { return ReadingName(tables, readings.rows[RowAt(line)]); };
  auto whole = WholeReport(Joint(tables, readings), a.linear, a.solution, "measure more", name);
  if (!whole) return whole.fault();
  report = *std::move(whole);
  report.method = "tool";
  if (auto fault = WrongChannels(tables, readings, model, a.x)) return *fault;
  const std::vector<ChannelSignal> signals = Signals(readings, model, a.x, setup);
  if (auto fault = DoesNotFit(ReadingPlacesOf(tables, readings), signals, report)) return *fault;
  NameLines(tables, readings, a, report);
  TellLeftOutLines(tables, readings, a, report);
  TellReferences(tables, readings, setup, report);
  TellLatitude(tables, readings, setup, report);
  TellHeating(tables, readings, report);
  TellHemisphere(readings, setup, model, a, report);
  TellTables(tables, readings, model, a, report);
  TellSettings(readings, setup, model, a, report);
  TellNoise(readings, setup, model, a, report);
  TellTerms(model, a, fit);
  TakeToolResult(readings, setup, model, a, left_out, fit);
  TellNuisances(model, a, fit);
  return fit;
}

// All terms, those that the readings cannot tell by their priors.
Result<ToolAdjustment> AdjustAll(const ToolReadings& readings, const ToolFitSetup& setup,
                                 std::vector<TermBundle>& bundles, std::vector<int>& seen) {
  seen = SeenBundles(readings, setup, bundles);
  GivePriors(readings, setup, bundles, seen);
  auto full = AdjustTool(readings, setup, TermsOf(bundles, seen));
  if (!full || !GivePriorsByPower(*full, bundles, seen)) return full;
  return AdjustTool(readings, setup, TermsOf(bundles, seen));
}

}  // namespace

std::string TextOf(const LeftOutTerm& term) {
  const bool loop = term.name.find("hysteresis") != std::string::npos;
  const std::string name =
      loop ? term.name +
                 " (of a loop +-(1 - tau^2); at ramps of one rate one that stays "
                 "open is heating)"
           : term.name;
  return term.seen ? fmt::format("{}: below {:.2g}", name, term.bound)
                   : fmt::format("{}: these readings cannot tell", term.name);
}

Result<ToolFit> FitTool(std::span<const BenchTable> tables, const ToolFitSetup& setup) {
  if (tables.empty()) throw std::invalid_argument("calibrate tool needs bench data");
  const auto readings = ReadTool(tables, setup);
  if (!readings) return readings.fault();
  if (readings->n_gyro > 0 && !setup.reference.latitude) {
    throw std::invalid_argument("gyros need the latitude");
  }
  std::vector<TermBundle> bundles = CandidateTerms(*readings, setup);
  const auto refused = [&](const Fault& fault) { return FaultOfAll(tables, fault.text); };
  if (const auto fault = UnseenNeeded(*readings, setup, bundles)) return refused(*fault);
  std::vector<int> seen;
  const auto full = AdjustAll(*readings, setup, bundles, seen);
  if (!full) return refused(full.fault());
  const TermChoice choice(bundles, seen, *full);
  const std::vector<int> chosen = choice.Best();
  const std::vector<ToolTerm> terms = TermsOf(bundles, chosen);
  const auto last = AdjustTool(*readings, setup, terms);
  if (!last) return refused(last.fault());
  auto fit = Whole(tables, *readings, setup, ToolModel(*readings, setup, terms), *last,
                   LeftOutErrorsOf(bundles, seen, chosen, *full));
  if (!fit) return fit.fault();
  TellLeftOut(bundles, seen, chosen, *full, *fit);
  for (const LeftOutTerm& term : fit->left_out) {
    fit->calibration.report.remarks.push_back("left out: " + TextOf(term));
  }
  for (std::string& remark : UntoldTerms(*readings, ToolModel(*readings, setup, terms), *last)) {
    fit->calibration.report.remarks.push_back(std::move(remark));
  }
  for (const std::string& rival : choice.Rivals(chosen)) {
    fit->calibration.report.remarks.push_back(
        rival + ": these readings hardly tell, and the sigmas take the first for certain");
  }
  return fit;
}

}  // namespace wellgyro
