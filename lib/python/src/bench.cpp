#include <functional>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "wellgyro/base/units.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/fit/bench_sigmas.h"
#include "wellgyro/fit/tool_fit.h"
#include "wellgyro/io/sensor/bench_data.h"
#include "wellgyro/io/sha256.h"
#include "wellgyro/io/toml/calibration_file.h"
#include "wellgyro/io/toml/tool_file.h"

#include "binding.h"

namespace wellgyro::python {
namespace {

using Number = std::optional<double>;

/// What `wellgyro calibrate tool` takes as options, in their units; absent: its defaults.
struct Bench {
  Number gravity_g, gravity_mps2, latitude_deg;
  bool tool_axes = false;
  std::map<std::string, double> sigmas;  ///< by the names of BenchSigmas(), in their units
  std::optional<int> max_degree;
  std::optional<std::string> tool;  ///< a tool file to bring up to date; empty: a new one
  ToolUpdate update;
  std::string date, expires;
};

template <class Held>
void Take(const Number& given, double unit, Held& held) {
  if (given) held = *given * unit;
}

std::optional<UtcTime> DateFrom(const char* name, const std::string& text) {
  if (text.empty()) return std::nullopt;
  const auto date = DateOf(text);
  if (!date) {
    throw std::invalid_argument(
        fmt::format("{}: a date is expected, as 2026-01-31, not {}", name, text));
  }
  return date;
}

ToolFitSetup SetupOf(const Bench& bench, std::vector<std::string>& references) {
  ToolFitSetup setup;
  BenchReference& r = setup.reference;
  std::vector<std::string> site;
  const auto say = [&site](const char* name, const Number& value) {
    if (value) site.push_back(fmt::format("{} {}", name, *value));
  };
  say("gravity-g", bench.gravity_g);
  say("gravity-mps2", bench.gravity_mps2);
  say("latitude-deg", bench.latitude_deg);
  Take(bench.gravity_g, 1, r.gravity);
  Take(bench.gravity_g, units::kStandardGravity, r.gravity_mps2);
  Take(bench.gravity_mps2, 1, r.gravity);
  Take(bench.gravity_mps2, 1, r.gravity_mps2);
  Take(bench.latitude_deg, units::kDeg, r.latitude);
  // As the program: normal gravity where only the latitude is stated.
  if (!bench.gravity_g && !bench.gravity_mps2 && r.latitude) {
    r.gravity_mps2 = SiteAt(*r.latitude, 0).gravity;
  }
  if (bench.tool_axes) r.axes = BenchAxes::kTool;
  std::set<std::string, std::less<>> stated;
  for (const BenchSigma& sigma : BenchSigmas()) {
    const auto given = bench.sigmas.find(std::string(sigma.name));
    if (given == bench.sigmas.end()) continue;
    sigma.Take(given->second, setup);
    stated.emplace(sigma.name);
  }
  if (bench.max_degree) stated.emplace("max-degree");
  setup.max_degree = bench.max_degree.value_or(setup.max_degree);
  references = BenchReferences(site, setup, stated);
  return setup;
}

std::vector<std::string> SigmaNames() {
  std::vector<std::string> names;
  for (const BenchSigma& sigma : BenchSigmas()) names.emplace_back(sigma.name);
  return names;
}

/// The tables: of a name and text, or of a file's name alone.
std::vector<BenchTable> TablesOf(
    const std::vector<std::pair<std::string, std::optional<std::string>>>& data,
    CalibrationFile& file) {
  std::vector<BenchTable> tables;
  for (const auto& [name, given] : data) {
    const std::string text = given ? *given : Taken(ReadTextFile(name));
    file.inputs.push_back({"data", name, name, Sha256Hex(text)});
    tables.push_back(Taken(ParseBenchTable(text, name)));
  }
  return tables;
}

std::optional<std::string> ToolOf(const Bench& bench, const ToolFit& fit,
                                  const std::vector<InputFile>& inputs) {
  if (!bench.tool) return std::nullopt;
  ToolUpdate update = bench.update;
  update.axes = bench.tool_axes ? BenchAxes::kTool : BenchAxes::kTrade;
  update.calibrated = DateFrom("date", bench.date);
  update.expires = DateFrom("expires", bench.expires);
  if (update.calibrated && update.expires && !(*update.calibrated < *update.expires)) {
    throw std::invalid_argument("expires: a date after that of the calibration is expected");
  }
  ToolCalibration tool;
  if (!bench.tool->empty()) tool = Taken(ParseTool(*bench.tool, "tool"));
  tool = Updated(std::move(tool), fit, update);
  tool.rests_on.clear();
  for (const InputFile& input : inputs) tool.rests_on.push_back(input.sha256);
  return ToolToml(tool);
}

nb::dict Nuisances(const std::vector<BenchNuisance>& nuisances) {
  nb::list name, unit;
  std::vector<double> value, sigma, prior;
  for (const BenchNuisance& n : nuisances) {
    name.append(n.name);
    unit.append(n.unit);
    value.push_back(n.value);
    sigma.push_back(n.sigma);
    prior.push_back(n.prior_sigma);
  }
  nb::dict columns;
  columns["name"] = name;
  columns["value"] = Array(std::move(value));
  columns["sigma"] = Array(std::move(sigma));
  columns["prior_sigma"] = Array(std::move(prior));
  columns["unit"] = unit;
  return columns;
}

// A column a source, and the degrees of freedom.
nb::dict Budget(const UncertaintyBudget& budget) {
  nb::dict columns;
  for (std::size_t k = 0; k < budget.sources.size(); ++k) {
    const auto column = budget.contributions.col(static_cast<Eigen::Index>(k));
    columns[budget.sources[k].c_str()] = Array(std::vector<double>(column.begin(), column.end()));
  }
  columns["dof"] = Array(std::vector<double>(budget.dof.begin(), budget.dof.end()));
  return columns;
}

nb::dict Calibrate(const std::vector<std::pair<std::string, std::optional<std::string>>>& data,
                   const Bench& bench) {
  CalibrationFile file;
  ToolFit fit;
  std::optional<std::string> tool;
  std::string text, summary;
  {
    const nb::gil_scoped_release released;
    file.program = "wellgyro " WELLGYRO_VERSION;
    const ToolFitSetup setup = SetupOf(bench, file.references);
    fit = Taken(FitTool(TablesOf(data, file), setup));
    file.report = fit.calibration.report;
    tool = ToolOf(bench, fit, file.inputs);
    text = CalibrationToml(file);
    summary = CalibrationSummary(file);
  }
  const FitReport& report = file.report;
  const auto n = static_cast<std::size_t>(report.values.size());
  std::vector<double> cov(report.cov.size() > 0 ? n * n : 0);
  for (std::size_t i = 0; i < cov.size(); ++i) {
    cov[i] = report.cov(static_cast<int>(i / n), static_cast<int>(i % n));
  }
  const std::size_t m = cov.empty() ? 0 : n;
  std::vector<std::string> left_out;
  for (const LeftOutTerm& term : fit.left_out) left_out.push_back(TextOf(term));
  nb::dict all;
  all["parameters"] = report.parameters;
  all["values"] = Array(std::vector<double>(report.values.begin(), report.values.end()));
  all["cov"] = Array(std::move(cov), {m, m});
  all["bench"] = Nuisances(fit.nuisances);
  all["budget"] = Budget(report.budget);
  all["left_out"] = left_out;
  all["remarks"] = report.remarks;
  all["outlier_lines"] = report.outlier_lines;
  all["text"] = text;
  all["tool"] = tool ? nb::object(nb::cast(*tool)) : nb::none();
  all["summary"] = summary;
  return all;
}

}  // namespace

void AddBench(nb::module_& m) {
  nb::class_<Bench>(m, "Bench")
      .def(nb::init<>())
      .def_rw("gravity_g", &Bench::gravity_g)
      .def_rw("gravity_mps2", &Bench::gravity_mps2)
      .def_rw("latitude_deg", &Bench::latitude_deg)
      .def_rw("tool_axes", &Bench::tool_axes)
      .def_rw("sigmas", &Bench::sigmas)
      .def_rw("max_degree", &Bench::max_degree)
      .def_rw("tool", &Bench::tool)
      .def_rw("date", &Bench::date)
      .def_rw("expires", &Bench::expires)
      .def_prop_rw(
          "channels", [](const Bench& b) { return b.update.channels; },
          [](Bench& b, std::vector<int> channels) { b.update.channels = std::move(channels); })
      .def_prop_rw(
          "unit_per_count", [](const Bench& b) { return b.update.unit_per_count; },
          [](Bench& b, std::vector<double> units) { b.update.unit_per_count = std::move(units); })
      .def_prop_rw(
          "asset_serial", [](const Bench& b) { return b.update.asset_serial; },
          [](Bench& b, std::string serial) { b.update.asset_serial = std::move(serial); })
      .def_prop_rw(
          "sensor_serials", [](const Bench& b) { return b.update.sensor_serials; },
          [](Bench& b, std::string serials) { b.update.sensor_serials = std::move(serials); });
  m.def("calibrate", &Calibrate);
  m.def("sigma_names", &SigmaNames);
}

}  // namespace wellgyro::python
