#include "calibrate_tool.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/calibration/error_sources.h"
#include "wellgyro/calibration/uncertainty_budget.h"
#include "wellgyro/fit/bench_sigmas.h"
#include "wellgyro/fit/tool_fit.h"
#include "wellgyro/io/atomic_file.h"
#include "wellgyro/io/result/certificate.h"
#include "wellgyro/io/sensor/bench_data.h"
#include "wellgyro/io/sha256.h"
#include "wellgyro/io/toml/calibration_file.h"
#include "wellgyro/io/toml/tool_file.h"

#include "bench_options.h"
#include "chromium.h"
#include "commands.h"
#include "distinct.h"
#include "on_call.h"
#include "report.h"
#include "tool_prior.h"

namespace wellgyro::apps {
namespace {

struct ToolFitOptions {
  BenchOptions bench;
  std::vector<std::string> data, traceability;
  std::string certificate, pdf, number, laboratory, prior;
  ToolFitSetup fit;
  std::set<std::string, std::less<>> stated;  ///< of fit, as BenchReferences takes them
};

Result<std::vector<BenchTable>> ReadInputs(const ToolFitOptions& o, CalibrationFile& file) {
  std::vector<BenchTable> tables;
  for (const std::string& name : o.data) {
    const Result<std::string> text = ReadTextFile(name);
    if (!text) return text.fault();
    file.inputs.push_back({"data", name, name, Sha256Hex(*text)});
    auto table = ParseBenchTable(*text, name);
    if (!table) return table.fault();
    tables.push_back(*std::move(table));
  }
  return tables;
}

Result<Calibrated> ToolOf(const ToolFitOptions& o, const ToolFit& fit, CalibrationFile& file) {
  ToolCalibration tool;
  if (!o.bench.tool.empty() && std::filesystem::exists(o.bench.tool)) {
    auto known = ReadToolFile(o.bench.tool);
    if (!known) return known.fault();
    tool = *std::move(known);
  }
  tool = Updated(std::move(tool), fit, o.bench.update);
  tool.rests_on.clear();
  for (const InputFile& input : file.inputs) tool.rests_on.push_back(input.sha256);
  Calibrated found{std::move(tool), fit.members.names, fit.members_by_source};
  if (o.prior.empty()) return found;
  return WithPrior(o.prior, std::move(found), file);
}

// Errors left in samples, in the units that people use.
void AddSamples(const Calibrated& found, const ToolFit& fit, Certificate& certificate) {
  const SensorGroup& group =
      fit.calibration.gyro.n_channels > 0 ? fit.calibration.gyro : fit.calibration.accel;
  const bool varies = group.thermometer >= 0;
  certificate.temperature_low = varies ? group.min : 0;
  certificate.temperature_high = varies ? group.max : 0;
  std::vector<double> temperatures = {group.reference};
  if (varies) temperatures = {group.min, group.reference, group.max};
  for (const double T : temperatures) {
    const UncertaintyBudget budget =
        BudgetOf(SourcesByParts(found.tool, found.members, found.by_source, T));
    for (Certificate::Line& line : SampleErrors(SourcesOf(found.tool, T), budget)) {
      if (varies) line.name += fmt::format(" at {:.4g} degC", T);
      certificate.samples.push_back(std::move(line));
    }
  }
}

// What the readings say of the bench, of their own scatter and of drift through a table, apart from
// the tool's result.
void MoveBench(const ToolFit& fit, Certificate& certificate) {
  std::vector<Certificate::Line>& result = certificate.result;
  for (const BenchNuisance& nuisance : fit.nuisances) {
    const auto found =
        std::find_if(result.begin(), result.end(),
                     [&](const Certificate::Line& line) { return line.name == nuisance.name; });
    Certificate::Line line{nuisance.name, "", nuisance.value, nuisance.sigma,
                           nuisance.sigma > 0 ? "A" : "B"};
    if (found != result.end()) {
      line = std::move(*found);
      result.erase(found);
    }
    line.unit = nuisance.unit == "rad" ? "deg" : nuisance.unit;
    if (nuisance.unit == "rad") line.Scale(ToDegrees(1));
    certificate.bench.push_back(std::move(line));
  }
  const auto of_bench = [](const Certificate::Line& line) {
    return line.name.find("_drift_") != std::string::npos || line.name.rfind("sigma_", 0) == 0;
  };
  std::copy_if(certificate.result.begin(), certificate.result.end(),
               std::back_inserter(certificate.bench), of_bench);
  std::erase_if(certificate.result, of_bench);
}

// Its terms left out have a list of their own.
void MoveLeftOut(const ToolFit& fit, Certificate& certificate) {
  for (const LeftOutTerm& term : fit.left_out) certificate.left_out.push_back(TextOf(term));
  std::erase_if(certificate.remarks,
                [](const std::string& remark) { return remark.rfind("left out:", 0) == 0; });
}

std::string CertificateText(const ToolFitOptions& o, const CalibrationFile& file,
                            const ToolFit& fit, const Calibrated& found,
                            std::vector<InputFile> outputs) {
  Certificate certificate = CertificateOf(file.report);
  for (Certificate::Line& line : certificate.result) {
    if (line.name.rfind("accel_S", 0) == 0) {
      line.unit = o.bench.reference.gravity > 2 ? "reading per m/s2" : "reading per g";
    }
  }
  certificate.number = o.number;
  certificate.laboratory = o.laboratory;
  certificate.outputs = std::move(outputs);
  certificate.asset_serial = found.tool.asset_serial;
  certificate.sensor_serials = found.tool.sensor_serials;
  certificate.program = file.program;
  certificate.calibrated = o.bench.date;
  certificate.expires = o.bench.expires;
  certificate.references = file.references;
  certificate.traceability = o.traceability;
  certificate.inputs = file.inputs;
  MoveBench(fit, certificate);
  MoveLeftOut(fit, certificate);
  AddSamples(found, fit, certificate);
  return CertificateHtml(certificate);
}

void RequireOthers(const ToolFitOptions& o) {
  std::vector<NamedFile> files = {{"--out", o.bench.out},
                                  {"--tool", o.bench.tool},
                                  {"--certificate", o.certificate},
                                  {"--pdf", o.pdf},
                                  {"--prior", o.prior}};
  for (const std::string& name : o.data) files.push_back({"--data", name});
  RequireDistinct(files);
}

std::vector<OutputFile> OutputsOf(const ToolFitOptions& o, const CalibrationFile& file,
                                  const ToolFit& fit, const Calibrated& found) {
  std::vector<OutputFile> files = {{o.bench.out, CalibrationToml(file)}};
  if (!o.bench.tool.empty()) files.push_back({o.bench.tool, ToolToml(found.tool)});
  if (o.certificate.empty()) return files;
  std::vector<InputFile> certified;
  for (const OutputFile& each : files) {
    certified.push_back(
        {certified.empty() ? "calibration" : "tool", each.name, each.name, Sha256Hex(each.bytes)});
  }
  files.push_back({o.certificate, CertificateText(o, file, fit, found, std::move(certified))});
  return files;
}

// A fit may take minutes, which are lost where its result has no place.
std::optional<Fault> WithoutPlace(const ToolFitOptions& o) {
  for (const std::string* name : {&o.bench.out, &o.bench.tool, &o.certificate}) {
    if (name->empty()) continue;
    if (auto fault = CannotWrite(*name)) return fault;
  }
  if (o.pdf.empty()) return std::nullopt;
  const auto complaint = CannotPrint(o.pdf);
  return complaint ? std::optional(Fault{.text = *complaint}) : std::nullopt;
}

// What the names of terms stand for, on paper and in the file.
void NameTau(const ToolFit& fit, CalibrationFile& file) {
  const SensorGroup& group =
      fit.calibration.gyro.n_channels > 0 ? fit.calibration.gyro : fit.calibration.accel;
  if (group.thermometer < 0) return;
  file.references.push_back(
      fmt::format("tau = (T - {:.6g} degC) / {:.6g} degC: of it the terms _tau1, _tau2, _tau3 are "
                  "the first, second and third power",
                  group.reference, group.half_range));
}

std::optional<Fault> RunToolFit(ToolFitOptions& o) {
  Complete(o.bench);
  RequireOthers(o);
  if (auto fault = WithoutPlace(o)) return fault;
  o.fit.reference = o.bench.reference;
  CalibrationFile file;
  file.program = "wellgyro " WELLGYRO_VERSION;
  file.references = BenchReferences(o.bench.said, o.fit, o.stated);
  const auto tables = ReadInputs(o, file);
  if (!tables) return tables.fault();
  const auto fit = FitTool(*tables, o.fit);
  if (!fit) return fit.fault();
  file.report = fit->calibration.report;
  NameTau(*fit, file);
  const auto tool = ToolOf(o, *fit, file);
  if (!tool) return tool.fault();
  fmt::print("{}", CalibrationSummary(file));
  if (auto fault = WriteAndName(OutputsOf(o, file, *fit, *tool))) return fault;
  if (o.pdf.empty()) return std::nullopt;
  if (const auto complaint = PrintByChromium(o.certificate, o.pdf)) {
    return Fault{.text = *complaint, .source = o.pdf};
  }
  fmt::print("{}\n", o.pdf);
  return std::nullopt;
}

void AddBenchSigmas(CLI::App& command, ToolFitOptions& o) {
  const auto list = [&o](CLI::Option* option) {
    option->each([&o, name = option->get_name(false, true).substr(2)](const std::string&) {
      o.stated.insert(name);
    });
  };
  for (const BenchSigma& sigma : BenchSigmas()) {
    list(AddSigma(command, sigma, o.fit, "found if not given"));
  }
  list(command
           .add_option("--max-degree", o.fit.max_degree,
                       fmt::format("of biases in temperature, default {}", o.fit.max_degree))
           ->check(CLI::Range(0, 3)));
}

}  // namespace

std::optional<Fault> WriteAndName(std::span<const OutputFile> files) {
  if (auto fault = WriteFiles(".", files)) return fault;
  for (const OutputFile& file : files) fmt::print("{}\n", file.name);
  return std::nullopt;
}

std::optional<Fault> WriteAndName(const std::filesystem::path& path, const std::string& bytes) {
  const OutputFile file{path.string(), bytes};
  return WriteAndName({&file, 1});
}

void AddCalibrateTool(CLI::App& calibrate, int& exit_code) {
  const auto o = std::make_shared<ToolFitOptions>();
  CLI::App* const command = calibrate.add_subcommand(
      "tool", "all bench data of a tool in one adjustment, with its whole covariance");
  command
      ->add_option("--data", o->data,
                   "readings (CSV), repeat it for more: positions (inc,az,tf and Gx,Gy,Gz or "
                   "fx,fy,fz or vx,vy,vz and m_x1,m_y1 ...) or rate table (axis,rate_deg_s,m_x1 "
                   "...), T_C and t_s where written down")
      ->required();
  command->add_option("--out", o->bench.out, "calibration file to write (TOML)")->required();
  CLI::Option* const certificate =
      command->add_option("--certificate", o->certificate, "certificate to write (HTML)");
  command->add_option("--pdf", o->pdf, "the certificate printed too, by a Chromium that is here")
      ->needs(certificate);
  command->add_option("--certificate-number", o->number, "of the certificate")->needs(certificate);
  command->add_option("--laboratory", o->laboratory, "that issues it")->needs(certificate);
  command
      ->add_option("--traceability", o->traceability,
                   "a reference instrument and its certificate, repeat it for more")
      ->needs(certificate);
  command->add_option("--prior", o->prior,
                      "what was known of the tool before, from other readings: a tool file of "
                      "calibrate tool or learn, joined into --tool");
  AddGravity(*command, o->bench);
  AddLatitude(*command, o->bench);
  AddAxes(*command, o->bench);
  AddBenchSigmas(*command, *o);
  AddTool(*command, o->bench);
  command->footer(
      "Example:\n  wellgyro calibrate tool --data up.csv --data down.csv --data rates.csv \\\n"
      "      --latitude-deg 60 --out tool-cal.toml --tool tool.toml \\\n"
      "      --certificate tool.html");
  OnCall(command, exit_code, [o] { return Concluded(RunToolFit(*o)); });
}

}  // namespace wellgyro::apps
