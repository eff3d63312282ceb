// Block 5: how the run fits together, and what came of its samples.
#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/page/html_internal.h"
#include "wellgyro/page/page_internal.h"

namespace wellgyro {
namespace {

/// An error of the tool as run.toml calls it: its name, its unit, the key of its prior, the check.
struct ToolError {
  const char *name, *unit, *prior, *words, *unit_words;
};
constexpr std::array kErrors = {
    ToolError{"toolface_offset", "_deg", "roll_offset_sigma_deg", "toolface offset", "\u00b0"},
    ToolError{"time_skew", "_s", "time_skew_sigma_s", "time skew", "s"},
    ToolError{"gyro_bias_x", "_deg_per_h", "gyro_bias_sigma_deg_per_h", "gyro bias x", "\u00b0/h"},
    ToolError{"gyro_bias_y", "_deg_per_h", "gyro_bias_sigma_deg_per_h", "gyro bias y", "\u00b0/h"},
    ToolError{"mass_unbalance", "_deg_per_h_per_g", "mass_unbalance_sigma_deg_per_h_per_g",
              "mass unbalance", "\u00b0/h/g"},
    ToolError{"quadrature", "_deg_per_h_per_g", "quadrature_sigma_deg_per_h_per_g", "quadrature",
              "\u00b0/h/g"},
    ToolError{"gyro_scale_x", "", "gyro_scale_sigma", "gyro scale x", "1"},
    ToolError{"gyro_scale_y", "", "gyro_scale_sigma", "gyro scale y", "1"},
    ToolError{"gyro_misalignment_x", "_rad", "gyro_misalignment_sigma_rad", "gyro misalignment x",
              "rad"},
    ToolError{"gyro_misalignment_y", "_rad", "gyro_misalignment_sigma_rad", "gyro misalignment y",
              "rad"},
    ToolError{"accel_bias_x", "_mps2", "accel_bias_sigma_mps2", "accelerometer bias x",
              "m/s\u00b2"},
    ToolError{"accel_bias_y", "_mps2", "accel_bias_sigma_mps2", "accelerometer bias y",
              "m/s\u00b2"},
    ToolError{"accel_bias_z", "_mps2", "accel_bias_sigma_mps2", "accelerometer bias z",
              "m/s\u00b2"},
};

std::string VerdictOf(const Columns& checks, std::string_view code, double run) {
  for (std::size_t i = 0; i < checks.rows(); ++i) {
    if (checks.Text(i, "CODE") == code && checks.Number(i, "RUN") == run) {
      return checks.Text(i, "VERDICT");
    }
  }
  return {};
}

void WriteParts(PageText& page, const Json& fit) {
  HtmlTable table(page.html, "parts", "Residuals by kind, against the noise that the job states",
                  {"Kind", ">Chi-square", ">Degrees of freedom", ">Noise found over stated"});
  const auto row = [&](const char* words, const std::string& sum, const std::string& freedom) {
    const auto chi_square = NumberAt(fit, {sum}), free = NumberAt(fit, {freedom});
    const bool told = chi_square && free && *free >= 1;
    table.Row()
        .Text(words)
        .Number(chi_square, 1)
        .Number(free, 1)
        .Number(told ? std::optional(std::sqrt(*chi_square / *free)) : std::nullopt, 3);
  };
  row("all", "chi_square", "degrees_of_freedom");
  for (const char* part : {"inclination", "force", "rest", "azimuth"}) {
    row(part, std::string(part) + "_chi_square", std::string(part) + "_degrees_of_freedom");
  }
}

void WriteErrors(PageText& page, const Json& run) {
  const Json& fit = At(run, {"fit"});
  const Columns checks(At(page.survey, {"checks"}));
  HtmlTable table(
      page.html, "errors", "Errors of the tool that the run tells, against their priors",
      {"Error", "Unit", ">Found", ">Sigma", ">Prior sigma", ">Found / prior", "Verdict"});
  for (const ToolError& error : kErrors) {
    const std::string name(error.name), unit(error.unit);
    const auto found = NumberAt(fit, {name + unit}),
               sigma = NumberAt(fit, {name + "_sigma" + unit});
    auto prior = NumberAt(page.survey, {"job", "errors", error.prior});
    if (!prior) prior = NumberAt(page.survey, {"tool_file", "errors", error.prior});
    const std::string verdict = VerdictOf(checks, name, NumberAt(run, {"number"}).value_or(0));
    const bool ratio = found && prior && *prior > 0;
    table.Row(verdict)
        .Text(error.words)
        .Text(error.unit_words)
        .Short(found)
        .Short(sigma)
        .Cell(prior ? "<span class=\"n\">" + ShortText(prior) + "</span>" : "of published tools")
        .Number(ratio ? std::optional(*found / *prior) : std::nullopt, 2)
        .Text(found ? verdict : "not measured");
  }
}

void WriteSamples(PageText& page, const Json& runs) {
  HtmlTable table(page.html, "samples", "Samples",
                  {"Run", ">Samples", ">Lost", ">Sent again", ">Refused", ">Gyros at full scale",
                   ">Accelerometers at full scale", ">Turned too fast", ">Clock doubtful",
                   ">Without depth [s]", "Temperature [\u00b0C]", "Verdict"});
  for (const Json& run : runs) {
    const auto low = NumberAt(run, {"temperature_min_degc"}),
               high = NumberAt(run, {"temperature_max_degc"});
    table.Row(TextAt(run, {"verdict"})).Text(TextAt(run, {"number"}));
    for (const char* key : {"samples", "samples_lost", "duplicates"})
      table.Number(NumberAt(run, {key}), 0);
    table.Number(NumberAt(run, {"samples_refused"}).value_or(0), 0);
    for (const char* key :
         {"gyro_saturated", "accel_saturated", "samples_aliased", "clock_unsynced"}) {
      table.Number(NumberAt(run, {key}), 0);
    }
    table.Number(NumberAt(run, {"seconds_without_depth"}), 1)
        .Cell(low ? NumberText(low, 1) + " to " + NumberText(high, 1) : "not measured")
        .Text(At(run, {"misrun"}) == true ? "misrun" : TextAt(run, {"verdict"}));
  }
}

/// A column of stretches.csv that is charted, and by which name.
struct AlongTime {
  const char *column, *name;
  int colour;
};

/// One run's columns along time, each point with its depth. Nothing where no run has them.
void AddAlongTime(PageText& page, double run, const char* id, const std::string& title,
                  const char* unit, std::initializer_list<AlongTime> columns) {
  const Columns stretches(At(page.survey, {"stretches"}));
  Chart chart{.title = title, .x_name = "time since the run began [h]", .y_name = unit};
  chart.height = 200;
  bool any = false;
  for (const AlongTime& column : columns) {
    ChartSeries series{.name = column.name, .colour = column.colour};
    for (std::size_t i = 0; i < stretches.rows(); ++i) {
      const auto t = stretches.Number(i, "T[s]"), value = stretches.Number(i, column.column);
      if (!t || stretches.Number(i, "RUN") != run) continue;
      any = any || value;
      series.points.emplace_back(*t / units::kHour, value.value_or(NAN));
      series.md.push_back(page.Length(stretches.Number(i, "MD[m]")).value_or(NAN));
    }
    chart.series.push_back(std::move(series));
  }
  if (any) return AddChart(page, fmt::format("run-{:.0f}-{}", run, id), chart, false);
  SayNotMeasured(page, title);
}

void WriteAlongTime(PageText& page, double run, const std::optional<double>& lost) {
  AddAlongTime(page, run, "residuals", fmt::format("Run {:.0f}: residuals over their sigma", run),
               "rms, expected 1", {{"RES_GYRO", "gyros", 0}, {"RES_ACCEL", "accelerometers", 1}});
  AddAlongTime(page, run, "rotation", fmt::format("Run {:.0f}: rotation of the tool", run), "[rpm]",
               {{"ROTATION[rpm]", "", 0}});
  AddAlongTime(page, run, "speed", fmt::format("Run {:.0f}: running speed, down positive", run),
               "[m/s]", {{"SPEED[m/s]", "", 0}});
  AddAlongTime(page, run, "temperature", fmt::format("Run {:.0f}: temperature of the tool", run),
               "[\u00b0C]", {{"TEMPERATURE[degC]", "", 1}});
  if (lost == 0.) {
    page.html += "<p>No sample was lost.</p>\n";
    return;
  }
  AddAlongTime(page, run, "lost", fmt::format("Run {:.0f}: samples lost", run), "a stretch",
               {{"SAMPLES_LOST", "", 1}});
}

}  // namespace

void WriteFits(PageText& page) {
  BeginBlock(page, 5, "The fit");
  const Json& runs = At(page.survey, {"run", "run"});
  if (!runs.is_array() || runs.empty()) {
    SayNotMeasured(page, "Runs");
    return EndBlock(page);
  }
  WriteSamples(page, runs);
  for (const Json& run : runs) {
    page.html += "<h3>Run " + Isolated(TextAt(run, {"number"})) + "</h3>\n";
    const std::string remark = TextAt(run, {"remark"});
    if (!remark.empty()) page.html += "<p>" + Isolated(remark) + "</p>\n";
    WriteAlongTime(page, NumberAt(run, {"number"}).value_or(0), NumberAt(run, {"samples_lost"}));
    if (!At(run, {"fit"}).is_object()) {
      SayNotMeasured(page, "The adjustment of this run");
      continue;
    }
    if (At(run, {"fit", "converged"}) == false)
      page.html += "<p><strong>The adjustment did not converge.</strong></p>\n";
    if (At(run, {"fit", "ambiguous"}) == true)
      page.html += "<p><strong>A second solution fits as well.</strong></p>\n";
    WriteParts(page, At(run, {"fit"}));
    WriteErrors(page, run);
  }
  EndBlock(page);
}

}  // namespace wellgyro
