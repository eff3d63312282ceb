#include "wellgyro/io/result/run_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/io/exchange/exchange.h"
#include "wellgyro/io/exchange/survey_csv.h"
#include "wellgyro/io/exchange/survey_files.h"
#include "wellgyro/io/formats.h"
#include "wellgyro/io/result/diagnosis_csv.h"
#include "wellgyro/io/result/stretches_csv.h"
#include "wellgyro/io/result/summary.h"
#include "wellgyro/io/sha256.h"
#include "wellgyro/io/text_internal.h"
#include "wellgyro/io/toml/run_lesson_internal.h"
#include "wellgyro/io/toml/toml_writer_internal.h"
#include "wellgyro/io/words.h"
#include "wellgyro/record/run_fit.h"
#include "wellgyro/survey/verdict/verdict.h"

namespace wellgyro {
namespace {

constexpr std::size_t kFaultsListed = 100;  // then their count, so that the file can be read

/// In 15 digits, so that what a text of no more said in degrees comes back as it was: there and
/// back again errs by less than half of the last one.
double Degrees(double radians) {
  const double degrees = ToDegrees(radians);
  return AnyNumberOf(fmt::format("{:.15g}", degrees)).value_or(degrees);
}

void WriteInputsWhole(TomlWriter& toml, const std::vector<InputFile>& inputs) {
  for (const InputFile& input : inputs) {
    toml.Element("input");
    WriteInput(toml, input);
    if (!input.text.empty()) toml.Lines("text", input.text);
  }
}

void WriteChannels(TomlWriter& toml, const std::vector<ChannelRecord>& channels) {
  for (const ChannelRecord& channel : channels) {
    toml.Element("channel");
    toml.Text("name", channel.channel);
    toml.Text("type", channel.type);
    toml.Whole("messages", channel.messages);
    toml.Text("sha256", channel.sha256);
  }
}

void WriteTools(TomlWriter& toml, const std::vector<ToolInfo>& tools) {
  for (const ToolInfo& tool : tools) {
    toml.Element("tool");
    toml.Whole("tool", tool.tool);
    toml.Whole("run", tool.run);
    toml.Text("asset_serial", tool.asset_serial);
    toml.Text("sensor_serials", tool.sensor_serials);
    toml.Text("firmware", tool.firmware);
    toml.Text("calibration_sha256", tool.calibration_sha256);
    toml.Whole("string_position", tool.string_position);
    toml.Number("sensor_below_reference_m", tool.sensor_below_reference);
  }
}

/// What the sensors of a fix were found to read.
void WriteFixSensors(TomlWriter& toml, const NorthFix& fix) {
  const auto rate = [&](std::string_view key, double v) {
    toml.Number(key, v / units::kDegPerHour);
  };
  if (fix.gyro_bias) {
    rate("gyro_bias_x_deg_per_h", fix.gyro_bias->x());
    rate("gyro_bias_y_deg_per_h", fix.gyro_bias->y());
    rate("sigma_gyro_bias_x_deg_per_h", fix.sigma_gyro_bias.x());
    rate("sigma_gyro_bias_y_deg_per_h", fix.sigma_gyro_bias.y());
  }
  if (fix.roll_rate) {
    rate("roll_rate_deg_per_h", *fix.roll_rate);
    rate("sigma_roll_rate_deg_per_h", fix.sigma_roll_rate);
  }
  toml.Number("gravity_mps2", fix.gravity);
  toml.Number("gravity_ref_mps2", fix.gravity_ref);
  toml.Number("sigma_gravity_mps2", fix.sigma_gravity);
  if (fix.earth_rate) {
    rate("earth_rate_deg_per_h", *fix.earth_rate);
    rate("earth_rate_ref_deg_per_h", fix.earth_rate_ref);
    rate("sigma_earth_rate_deg_per_h", fix.sigma_earth_rate);
  }
}

void WriteFix(TomlWriter& toml, const NorthFix& fix) {
  const auto deg = [&](std::string_view key, double v) { toml.Number(key, Degrees(v)); };
  toml.Element("run.north_fix");
  if (fix.md) toml.Number("md_m", *fix.md);
  toml.Whole("begin_utime_us", fix.utc_begin.ns / 1000);
  toml.Whole("end_utime_us", fix.utc_end.ns / 1000);
  if (fix.from_samples) {
    toml.Whole("seq_begin", fix.seq_begin);
    toml.Whole("seq_end", fix.seq_end);
  }
  toml.Flag("external", fix.external);
  deg("azimuth_true_deg", WrapTwoPi(fix.azimuth));
  deg("inclination_deg", fix.inclination);
  deg("toolface_deg", WrapTwoPi(fix.toolface));
  deg("sigma_inclination_deg", std::sqrt(fix.cov_attitude(0, 0)));
  deg("sigma_azimuth_deg", std::sqrt(fix.cov_attitude(1, 1)));
  deg("sigma_toolface_deg", std::sqrt(fix.cov_attitude(2, 2)));
  if (fix.magnetic_azimuth) deg("azimuth_magnetic_deg", *fix.magnetic_azimuth);
  if (fix.mirror_azimuth) {
    deg("mirror_azimuth_true_deg", WrapTwoPi(*fix.mirror_azimuth));
    toml.Number("mirror_cost", fix.mirror_cost);
  }
  if (fix.chi_square) {
    deg("closure_deg", fix.closure);
    deg("sigma_closure_deg", fix.sigma_closure);
  }
  WriteFixSensors(toml, fix);
  toml.Text("quality", QualityText(fix.quality));
}

/// Of one kind of error, by its name without axis.
void WriteFound(TomlWriter& toml, const RunFit& fit, ErrorSource source, const std::string& name,
                const std::string& unit_name, double unit) {
  if (!(fit.sigma_errors[source] > 0)) return;
  toml.Number(name + unit_name, fit.errors[source] / unit);
  toml.Number(name + "_sigma" + unit_name, fit.sigma_errors[source] / unit);
}

void WriteFit(TomlWriter& toml, const RunFit& fit) {
  toml.Table("run.fit");
  toml.Flag("converged", fit.converged);
  toml.Flag("ambiguous", fit.ambiguous);
  toml.Number("chi_square", fit.chi_square);
  toml.Whole("degrees_of_freedom", fit.degrees_of_freedom);
  const std::array<std::pair<std::string, RunFit::Part>, RunFit::kParts> parts{
      {{"inclination", RunFit::kInclination},
       {"force", RunFit::kForce},
       {"rest", RunFit::kRest},
       {"azimuth", RunFit::kAzimuth}}};
  for (const auto& [name, part] : parts) {
    toml.Number(name + "_chi_square", fit.parts[part].sum);
    toml.Number(name + "_degrees_of_freedom", fit.parts[part].freedom);
  }
  WriteFound(toml, fit, kToolfaceOffset, "toolface_offset", "_deg", units::kDeg);
  WriteFound(toml, fit, kTimeSkew, "time_skew", "_s", 1);
  WriteFound(toml, fit, kGyroBiasX, "gyro_bias_x", "_deg_per_h", units::kDegPerHour);
  WriteFound(toml, fit, kGyroBiasY, "gyro_bias_y", "_deg_per_h", units::kDegPerHour);
  WriteFound(toml, fit, kMassUnbalance, "mass_unbalance", "_deg_per_h_per_g",
             units::kDegPerHourPerG);
  WriteFound(toml, fit, kQuadrature, "quadrature", "_deg_per_h_per_g", units::kDegPerHourPerG);
  WriteFound(toml, fit, kGyroScaleX, "gyro_scale_x", "", 1);
  WriteFound(toml, fit, kGyroScaleY, "gyro_scale_y", "", 1);
  WriteFound(toml, fit, kMisalignmentX, "gyro_misalignment_x", "_rad", 1);
  WriteFound(toml, fit, kMisalignmentY, "gyro_misalignment_y", "_rad", 1);
  WriteFound(toml, fit, kAccelBiasX, "accel_bias_x", "_mps2", 1);
  WriteFound(toml, fit, kAccelBiasY, "accel_bias_y", "_mps2", 1);
  WriteFound(toml, fit, kAccelBiasZ, "accel_bias_z", "_mps2", 1);
}

void WriteSamples(TomlWriter& toml, const RunSummary& run) {
  toml.Whole("gyro_saturated", run.samples_gyro_saturated);
  toml.Whole("accel_saturated", run.samples_accel_saturated);
  toml.Whole("samples_aliased", run.samples_aliased);
  toml.Whole("clock_unsynced", run.samples_unsynced);
  toml.Number("seconds_without_depth", run.seconds_without_depth);
  toml.Number("temperature_min_degc", static_cast<double>(run.temperature_min));
  toml.Number("temperature_max_degc", static_cast<double>(run.temperature_max));
  toml.Whole("temperature_outside", run.samples_temperature_outside);
}

void WriteVerdict(TomlWriter& toml, const RunVerdict& verdict) {
  toml.Text("verdict", WordOf(verdict.verdict));
  toml.Texts("causes", verdict.causes);
}

void WriteRuns(TomlWriter& toml, const std::vector<RunSummary>& runs) {
  for (const RunSummary& run : runs) {
    toml.Element("run");
    toml.Whole("number", run.run);
    toml.Whole("tool", run.tool);
    if (run.misrun) toml.Flag("misrun", true);
    WriteVerdict(toml, run.verdict);
    if (!run.remark.empty()) toml.Text("remark", run.remark);
    toml.Whole("begin_utime_us", run.begin.ns / 1000);
    toml.Whole("end_utime_us", run.end.ns / 1000);
    toml.Whole("samples", run.samples);
    toml.Whole("samples_lost", run.samples_lost);
    if (run.samples_after_end > 0) toml.Whole("samples_after_end", run.samples_after_end);
    toml.Whole("duplicates", run.duplicates);
    if (run.samples_refused > 0) toml.Whole("samples_refused", run.samples_refused);
    if (run.clock_jumps > 0) toml.Whole("clock_jumps", run.clock_jumps);
    if (run.samples > 0) WriteSamples(toml, run);
    if (run.fit) WriteFit(toml, *run.fit);
    if (run.fit && run.fit->lesson) WriteRunLesson(toml, *run.fit->lesson);
    for (const NorthFix& fix : run.fixes) WriteFix(toml, fix);
  }
}

void WriteChecks(TomlWriter& toml, const std::vector<Check>& checks) {
  toml.Table("checks");
  for (const Verdict verdict :
       {Verdict::kPass, Verdict::kWarn, Verdict::kFail, Verdict::kNotDone}) {
    toml.Whole(WordOf(verdict), std::count_if(checks.begin(), checks.end(), [&](const Check& c) {
                 return c.verdict == verdict;
               }));
  }
}

void WriteFaultCounts(TomlWriter& toml, const std::vector<Fault>& faults) {
  std::map<FaultCode, std::int64_t> counts;
  for (const Fault& fault : faults) ++counts[fault.code];
  toml.Table("faults");
  for (const auto& [code, count] : counts) toml.Whole(WordOf(code), count);
}

void WriteFault(TomlWriter& toml, const Fault& fault) {
  toml.Element("fault");
  toml.Text("code", WordOf(fault.code));
  if (!fault.source.empty()) toml.Text("source", fault.source);
  toml.Text("text", fault.text);
}

void WriteOperations(TomlWriter& toml, const RunRecord& record) {
  if (record.operations_obeyed + record.operations_refused == 0) return;
  toml.Table("operations");
  toml.Whole("obeyed", record.operations_obeyed);
  toml.Whole("refused", record.operations_refused);
  for (const OperationRecord& operation : record.operations) {
    toml.Element("operation");
    toml.Text("key", operation.key);
    toml.Whole("session", operation.session);
    toml.Whole("id", operation.id);
    toml.Whole("utime_us", operation.utc.ns / 1000);
    toml.Text("kind", operation.kind);
    if (!operation.who.empty()) toml.Text("who", operation.who);
    toml.Flag("obeyed", operation.obeyed);
    toml.Text("effect", operation.effect);
  }
}

void WriteClock(TomlWriter& toml, const RunRecord& record) {
  const StopMatch& clock = *record.clock;
  toml.Table("clock_by_stops");
  toml.Whole("tool_ns", clock.tool.ns);
  toml.Whole("utime_us", clock.utc.ns / 1000);
  toml.Number("drift", clock.drift);
  toml.Number("sigma_offset_s", std::sqrt(clock.cov(0, 0)));
  toml.Number("sigma_drift", std::sqrt(clock.cov(1, 1)));
  toml.Number("sigma_edge_s", clock.sigma_edge);
  toml.Whole("stops", clock.matched);
  if (record.stamps_less_stops) toml.Number("stamps_less_stops_s", *record.stamps_less_stops);
}

bool Sampled(const Survey& survey) {
  return std::any_of(survey.runs.begin(), survey.runs.end(),
                     [](const RunSummary& run) { return run.samples > 0; });
}

constexpr const char* kExportStem = "survey";

std::optional<WellGrid> GridOf(const Job& job) {
  if (!job.grid) return std::nullopt;
  return WellGrid(*job.grid,
                  GeodeticPoint{.latitude = job.well.latitude, .longitude = job.well.longitude});
}

// survey.csv is there always.
std::vector<SurveyFormat> BesidesCsv(std::span<const SurveyFormat> formats) {
  std::vector<SurveyFormat> others;
  for (const SurveyFormat format : formats) {
    const bool twice = std::find(others.begin(), others.end(), format) != others.end();
    if (format != SurveyFormat::kCsv && !twice) others.push_back(format);
  }
  return others;
}

}  // namespace

std::string RunToml(const RunRecord& record, const Job& job, const Survey& survey,
                    const std::vector<OutputFile>& outputs) {
  TomlWriter toml;
  toml.Text("format", formats::kRun);
  toml.Text("program", record.program);
  const auto adjusted =
      std::ranges::find_if(survey.runs, [](const RunSummary& run) { return run.fit != nullptr; });
  toml.Text("adjuster", adjusted != survey.runs.end() ? adjusted->fit->adjuster : "none");
  toml.Flag("accepted", survey.accepted);
  toml.Whole("stations", std::ssize(survey.chosen));
  toml.Whole("stations_of_all_passes", std::ssize(survey.passes));
  toml.Text("md_kind", WordOf(job.depth.kind));
  if (job.attitude.order == AttitudeSpec::Order::kSecond) toml.Text("attitude_order", "second");
  // Whoever sums the stations of survey.csv again gets other positions where the run was seen.
  toml.Text("positions_summed_over", Sampled(survey) ? "run, every second" : "stations");
  toml.Table("well");
  toml.Text("name", job.well.name);
  toml.Number("latitude_deg", Degrees(job.well.latitude));
  toml.Number("longitude_deg", Degrees(job.well.longitude));
  toml.Number("datum_elevation_m", job.well.datum_elevation);
  toml.Table("identity");
  for (const auto& [key, value] : job.identity) toml.Text(key, value);
  toml.Table("verdict");
  WriteVerdict(toml, survey.verdict);
  toml.Number("false_alarm_rate", kFalseAlarmRate);
  WriteChecks(toml, survey.checks);
  WriteFaultCounts(toml, record.faults);
  WriteRuns(toml, survey.runs);
  if (record.clock) WriteClock(toml, record);
  WriteTools(toml, record.tools);
  WriteOperations(toml, record);
  WriteChannels(toml, record.channels);
  for (const OutputFile& output : outputs) {
    toml.Element("output");
    toml.Text("name", output.name);
    toml.Text("sha256", Sha256Hex(output.bytes));
  }
  for (std::size_t i = 0; i < std::min(record.faults.size(), kFaultsListed); ++i) {
    WriteFault(toml, record.faults[i]);
  }
  WriteInputsWhole(toml, record.inputs);
  return toml.text();
}

std::string SourceToml(const SourceRecord& record) {
  TomlWriter toml;
  toml.Text("format", formats::kSource);
  toml.Text("name", record.name);
  if (!record.ended.empty()) toml.Text("ended", record.ended);
  toml.Table("counts");
  for (const auto& [name, count] : record.counts) toml.Whole(name, count);
  for (const Fault& fault : record.faults) {
    WriteFault(toml, fault);
    if (fault.offset >= 0) toml.Whole("offset", fault.offset);
  }
  return toml.text();
}

std::vector<OutputFile> ResultFiles(const RunRecord& record, const SourceRecord& source,
                                    const Job& job, const Survey& survey) {
  const std::optional<WellGrid> grid = GridOf(job);
  const WellGrid* const columns = grid ? &*grid : nullptr;
  std::vector<OutputFile> files{{"survey.csv", SurveyCsv(survey.chosen, columns)},
                                {"passes.csv", PassesCsv(survey.passes, columns)},
                                {"checks.csv", ChecksCsv(survey.checks)},
                                {"diagnosis.csv", DiagnosisCsv(survey)},
                                {"reliability.csv", ReliabilityCsv(survey)},
                                {"stretches.csv", StretchesCsv(survey)}};
  SurveyTable table = TableOfSurvey(job, survey.chosen, columns);
  table.head.remarks.push_back(VerdictText(survey.verdict));
  for (OutputFile& file : ExportFormats(table, BesidesCsv(record.formats), kExportStem)) {
    files.push_back(std::move(file));
  }
  std::string run = RunToml(record, job, survey, files);
  files.push_back({"source.toml", SourceToml(source)});
  files.push_back({"run.toml", std::move(run)});
  return files;
}

void RequireFormats(const Job& job, std::span<const SurveyFormat> formats) {
  const std::optional<WellGrid> grid = GridOf(job);
  Station deep;
  deep.md = 1;
  deep.p_WT_W.z() = 1;
  const std::array<Station, 2> stations{Station{}, deep};
  ExportFormats(TableOfSurvey(job, stations, grid ? &*grid : nullptr), BesidesCsv(formats),
                kExportStem);
}

}  // namespace wellgyro
