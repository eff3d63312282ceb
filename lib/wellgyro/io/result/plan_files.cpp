#include "wellgyro/io/result/plan_files.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/exchange/well_stations.h"
#include "wellgyro/io/plot/plan_plot.h"
#include "wellgyro/io/toml/job_file.h"
#include "wellgyro/io/toml/named_file_internal.h"
#include "wellgyro/io/toml/plan_file.h"
#include "wellgyro/io/toml/toml_internal.h"
#include "wellgyro/io/toml/tool_file.h"
#include "wellgyro/io/words.h"
#include "wellgyro/uncertainty/ellipse.h"

namespace wellgyro {
namespace {

/// What the file of the tool, and the job, say.
struct ToolSide {
  NoiseCoefficients gyro;
  ErrorPriors errors;
  std::optional<double> latitude, convergence, sigma_start_azimuth;
  double elevation = 0;
  bool third_axis = false;
  double calibrated_to = 1e3;
  PreflightDates dates;
};

void TakeTool(const ToolCalibration& tool, ToolSide& side) {
  side.third_axis = tool.gyro.n_channels > 2;
  side.calibrated_to = std::min(tool.gyro.max, tool.accel.max);
  side.dates = {.calibrated = tool.calibrated, .expires = tool.expires};
  if (tool.errors) side.errors = *tool.errors;
}

ToolSide OfJob(const Job& job, std::vector<std::string>& notes) {
  ToolSide side;
  if (job.tool) TakeTool(*job.tool, side);
  side.gyro = job.noise;
  side.errors = job.errors;
  side.latitude = job.well.latitude;
  side.elevation = job.well.datum_elevation;
  if (job.grid) side.convergence = job.grid->convergence;
  if (job.alignment.method == AlignmentSpec::Method::kExternal) {
    side.sigma_start_azimuth = job.alignment.sigma_azimuth;
  }
  if (!job.noise_stated) notes.emplace_back("the job says no noise: that of a guess is taken");
  return side;
}

ToolSide ReadToolSide(const PlanRequest& request, NamedFiles& files,
                      std::vector<std::string>& notes) {
  const std::string name = request.tool.string();
  const std::string text = files.Take("tool", name);
  ToolSide side;
  if (text.find("\"wellgyro.job/") != std::string::npos) {
    const Result<JobFile> job = ParseJob(text, request.tool, request.tool.parent_path());
    if (!job) throw TomlError{job.fault()};
    side = OfJob(job->job, notes);
  } else {
    const Result<ToolCalibration> tool = ParseTool(text, name);
    if (!tool) throw TomlError{tool.fault()};
    TakeTool(*tool, side);
    if (!tool->errors) throw std::invalid_argument(name + " has no [errors], a plan needs them");
    if (!request.noise) {
      throw std::invalid_argument("beside a tool file --noise is needed, or a job as --tool");
    }
  }
  if (request.noise) side.gyro = NoiseOfFile(request.noise->string(), files);
  side.third_axis = side.third_axis || request.third_axis;
  return side;
}

Trajectory ReadPlannedWell(const PlanRequest& request, const std::optional<double>& convergence,
                           NamedFiles& files, std::vector<std::string>& notes) {
  const std::string name = request.well.string();
  const North wanted = convergence ? North::kGrid : North::kTrue;
  const Result<WellStations> read = ParseWellStations(files.Take("well", name), name, wanted);
  if (!read) throw TomlError{read.fault()};
  double turn = convergence.value_or(0);
  if (read->north == North::kGrid && !convergence) {
    throw std::invalid_argument("the well's azimuths are grid: --convergence-deg is needed");
  }
  if (read->north == North::kTrue) turn = 0;
  if (read->north == North::kUnknown) {
    notes.emplace_back(convergence ? "azimuths taken as grid" : "azimuths taken as true");
  }
  if (!read->depth_unit_stated) notes.emplace_back("the header names no unit of depth: metres");
  std::vector<double> md, inclination, azimuth;
  for (const SurveyPoint& p : read->stations) {
    md.push_back(p.md);
    inclination.push_back(p.inclination);
    azimuth.push_back(p.azimuth + turn);
  }
  const Eigen::Vector3d start =
      read->start_stated ? read->start_W : Eigen::Vector3d(0, 0, read->stations.front().md);
  return Trajectory(md, inclination, azimuth, start);
}

PlanReport MakeReport(const PlanRequest& request, NamedFiles& files,
                      std::vector<std::string>& notes) {
  const ToolSide tool = ReadToolSide(request, files, notes);
  const std::optional<double> latitude = request.latitude ? request.latitude : tool.latitude;
  if (!latitude) throw std::invalid_argument("--latitude-deg is needed beside a tool file");
  const std::optional<double> convergence =
      request.convergence ? request.convergence : tool.convergence;
  if (!std::isfinite(*latitude + convergence.value_or(0) + request.heat.at_surface +
                     request.heat.gradient)) {
    throw std::invalid_argument("latitude, convergence and temperatures must be finite");
  }
  Trajectory well = ReadPlannedWell(request, convergence, files, notes);
  PlannedWay way = request.way;
  way.begin_md = request.begin_md.value_or(well.md_begin());
  way.end_md = request.end_md.value_or(well.md_end());
  PlanReport report{
      .well = request.well.filename().string(),
      .c = {.well = std::move(well),
            .site = SiteAt(*latitude, tool.elevation),
            .gyro = tool.gyro,
            .errors = tool.errors,
            .third_axis = tool.third_axis,
            .way = way,
            .sigma_start_azimuth = request.sigma_start_azimuth ? request.sigma_start_azimuth
                                                               : tool.sigma_start_azimuth},
      .limits = request.limits,
      .plan = {}};
  report.plan = PlanStops(report.c, report.limits);
  if (request.practice) {
    report.practice_stops = Practice(way, request.practice->every, request.practice->seconds);
    report.practice = ExpectEnd(report.c, report.practice_stops, true);
  }
  if (report.plan.feasible) {
    report.worse = ExpectEnd(WorseTool(report.c, kWorseFactor), report.plan.stops, true);
  }
  PreflightHeat heat = request.heat;
  heat.calibrated_to = tool.calibrated_to;
  PreflightDates dates = tool.dates;
  dates.run = request.date;
  const ExpectedEnd& end = report.plan.stops.empty() ? report.plan.without : report.plan.expected;
  report.warnings = Preflight(report.c, end, heat, dates);
  report.inputs = files.all();
  return report;
}

std::string EndLine(const ExpectedEnd& end) {
  std::string text = fmt::format("ellipse {:.2f} x {:.2f} m", end.semi_major, end.semi_minor);
  if (!end.hidden_cause.empty()) {
    text += fmt::format(", unseen up to {:.2f} m ({})", end.hidden, end.hidden_cause);
  }
  return text;
}

std::string StopLines(const PlanReport& report) {
  const StopPlan& plan = report.plan;
  std::string text =
      fmt::format("{}, {:.0f} s at rest, {:.0f} s with {:.0f} s to each; the run {:.1f} h\n",
                  Counted(plan.stops.size(), "stop"), plan.at_rest, plan.cost,
                  report.limits.overhead, plan.expected.seconds / units::kHour);
  for (std::size_t i = 0; i < plan.stops.size(); ++i) {
    const PlannedStop& stop = plan.stops[i];
    text +=
        fmt::format("  {:<4}{:8.1f} m {:5.0f} s", stop.out ? "up" : "down", stop.md, stop.seconds);
    if (stop.toolface) text += fmt::format("  toolface {:3.0f} deg", ToDegrees(*stop.toolface));
    text += fmt::format("   without it: ellipse {:.2f} m", plan.worth[i].ellipse_without);
    if (report.limits.hidden) {
      text += fmt::format(", unseen up to {:.2f} m", plan.worth[i].hidden_without);
    }
    text += "\n";
  }
  return text;
}

std::string PracticeLine(const PlanReport& report) {
  double at_rest = 0;
  for (const PlannedStop& stop : report.practice_stops) at_rest += stop.seconds;
  const double cost =
      at_rest + report.limits.overhead * static_cast<double>(report.practice_stops.size());
  std::string text =
      fmt::format("practice, {}, {:.0f} s: {}", Counted(report.practice_stops.size(), "stop"), cost,
                  EndLine(*report.practice));
  if (report.plan.feasible && cost > 0) {
    const double saved = 100 * (1 - report.plan.cost / cost);
    text += saved >= 0 ? fmt::format("; the plan takes {:.0f} % less", saved)
                       : fmt::format("; the plan takes {:.0f} % more", -saved);
  }
  return text + "\n";
}

/// A tool that slides shows its gyros much the same face at every stop: what it would save to turn
/// it, which the plan does only if told that it can be.
std::string TurnedLine(const PlanReport& report) {
  if (report.limits.turns || report.c.way.roll_rate != 0) return {};
  PlanLimits limits = report.limits;
  limits.turns = true;
  const StopPlan turned = PlanStops(report.c, limits);
  if (!turned.feasible || (report.plan.feasible && turned.cost >= report.plan.cost)) return {};
  return fmt::format(
      "if the tool can be turned before a stop (--toolfaces): {}, {:.0f} s at rest, {:.0f} s "
      "with {:.0f} s to each\n",
      Counted(turned.stops.size(), "stop"), turned.at_rest, turned.cost, limits.overhead);
}

std::string Summary(const PlanReport& report) {
  const StopPlan& plan = report.plan;
  std::string text;
  if (plan.feasible) {
    text += "plan: " + StopLines(report);
    text += "with the plan: " + EndLine(plan.expected) + "\n";
  } else {
    text += "not feasible: " + plan.why_not + "\n";
  }
  text += TurnedLine(report);
  text += "without stops: " + EndLine(plan.without) + "\n";
  if (plan.least_at_rest) {
    text += fmt::format("bound: no plan meets the ellipse with less than {:.0f} s at rest",
                        *plan.least_at_rest);
    if (plan.least_cost) {
      text += fmt::format(", {:.0f} s with {:.0f} s to each stop", *plan.least_cost,
                          report.limits.overhead);
    }
    text += "\n";
  }
  if (report.practice) text += PracticeLine(report);
  if (report.worse) {
    text += fmt::format("tool {:g} times worse in drift, bias and g-dependence: {}\n", kWorseFactor,
                        EndLine(*report.worse));
  }
  return text;
}

/// What the surveys of the plan are to say along the way in, at some fifty places.
std::string AlongCsv(const PlanReport& report) {
  const PlannedWay& way = report.c.way;
  const double spacing = 10 * std::max(1.0, std::ceil((way.end_md - way.begin_md) / 500));
  std::string text =
      "MD[m],VAR_NN[m2],COV_NE[m2],COV_NV[m2],VAR_EE[m2],COV_EV[m2],VAR_VV[m2],SEMI_MAJOR[m],"
      "SEMI_MINOR[m],AZI_MAJOR[deg]\n";
  for (const ExpectedPlace& place : ExpectAlong(report.c, report.plan.stops, spacing)) {
    const Eigen::Matrix3d& cov = place.cov_p_WT_W;
    const ErrorEllipse ellipse = HorizontalEllipse(cov, kConfidence);
    text += fmt::format("{:.4f},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.4f},{:.4f},{:.3f}\n",
                        place.md, cov(0, 0), cov(0, 1), cov(0, 2), cov(1, 1), cov(1, 2), cov(2, 2),
                        ellipse.semi_major, ellipse.semi_minor, ToDegrees(ellipse.azimuth_major));
  }
  return text;
}

}  // namespace

Result<PlanAnswer> AnswerPlan(const PlanRequest& request) {
  try {
    PlanAnswer answer;
    NamedFiles files{std::filesystem::path()};
    const PlanReport report = MakeReport(request, files, answer.notes);
    answer.feasible = report.plan.feasible;
    answer.inputs = PathsOf(report.inputs);
    for (const std::string& warning : report.warnings) answer.notes.push_back(warning);
    answer.summary = Summary(report);
    answer.files.push_back(
        {"plan.svg", PlanSvg("Stops for " + report.well, report.c, report.limits, report.plan,
                             report.practice_stops, report.practice)});
    std::string text = answer.summary;
    for (const std::string& note : answer.notes) text += "note: " + note + "\n";
    answer.files.push_back({"plan.txt", text});
    answer.files.push_back({"expected.csv", AlongCsv(report)});
    answer.files.push_back({"plan.toml", PlanToml(report)});
    return answer;
  } catch (const TomlError& error) {
    return error.fault;
  }
}

}  // namespace wellgyro
