#include "wellgyro/io/result/certificate.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/html_text_internal.h"

namespace wellgyro {
namespace {

constexpr std::string_view kHead = R"(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>Calibration certificate</title><style>
body{font:10.5pt/1.4 "DejaVu Sans",Arial,sans-serif;color:#1a1a1a;max-width:190mm;margin:12mm auto}
h1{font-size:17pt;margin:0 0 4mm}h2{font-size:12pt;margin:7mm 0 2mm;border-bottom:1px solid #999}
table{border-collapse:collapse;width:100%;font-size:9pt}
td,th{padding:.6mm 2mm;text-align:right;border-bottom:1px solid #ddd}
td:first-child,th:first-child{text-align:left}td.t{text-align:left;word-break:break-all}
table.b{font-size:6.5pt;margin-bottom:4mm}.b td,.b th{padding:.3mm .8mm}
.b th{vertical-align:bottom}.b td{white-space:nowrap}
ul{margin:1mm 0;padding-left:5mm}figure{margin:3mm 0;page-break-inside:avoid}
figcaption{font-size:8.5pt}@page{size:A4;margin:14mm}@media print{body{margin:0}}
</style></head><body>
)";

void Pairs(std::string& html, const std::vector<std::pair<std::string, std::string>>& rows) {
  html += "<table>\n";
  for (const auto& [name, value] : rows) {
    if (value.empty()) continue;
    html += fmt::format("<tr><td>{}</td><td class=\"t\">{}</td></tr>\n", name, Escaped(value));
  }
  html += "</table>\n";
}

void List(std::string& html, std::string_view title, const std::vector<std::string>& lines) {
  if (lines.empty()) return;
  html += fmt::format("<h2>{}</h2>\n<ul>\n", title);
  for (const std::string& line : lines) html += fmt::format("<li>{}</li>\n", Escaped(line));
  html += "</ul>\n";
}

// The value to the digit of its uncertainty's second.
std::string Rounded(double value, double uncertainty) {
  if (!(uncertainty > 0)) return fmt::format("{:.6g}", value);
  const int place = static_cast<int>(std::floor(std::log10(uncertainty))) - 1;
  if (place >= 0 || place < -12) return fmt::format("{:.6g}", value);
  return fmt::format("{:.{}f}", value, -place);
}

// Two digits, without an exponent where people read numbers without one.
std::string TwoDigits(double u) {
  if (!(u >= 1e-4 && u < 1e6)) return fmt::format("{:.2g}", u);
  const int place = static_cast<int>(std::floor(std::log10(u))) - 1;
  const double step = std::pow(10.0, place);
  return fmt::format("{:.{}f}", std::round(u / step) * step, std::max(0, -place));
}

std::string Known(double u) { return u > 0 ? TwoDigits(u) : std::string("not known"); }

// What contributes to u, to the third digit of u; 0 below.
std::string Share(double part, double u) {
  if (!(u > 0)) return "0";
  const int place = static_cast<int>(std::floor(std::log10(u))) - 2;
  if (!(part >= std::pow(10.0, place) / 2)) return "0";
  return u >= 1e-4 ? fmt::format("{:.{}f}", part, std::max(0, -place)) : TwoDigits(part);
}

// k and U = k u; a line without degrees of freedom has k = 2.
std::string Expanded(const Certificate::Line& line) {
  const std::optional<double> k = line.dof > 0 ? CoverageFactor(line.dof) : 2;
  if (!k) return "<td>-</td><td>not known</td>";
  return fmt::format("<td>{:.2f}</td><td>{}</td>", *k, Known(*k * line.uncertainty));
}

void Lines(std::string& html, std::string_view title, const std::vector<Certificate::Line>& lines,
           bool with_value) {
  if (lines.empty()) return;
  html += fmt::format(
      "<h2>{}</h2>\n<table>\n<tr><th>quantity</th>{}<th>standard uncertainty "
      "u</th><th>k</th><th>expanded U = k u</th><th>unit</th><th>evaluation</th></tr>\n",
      title, with_value ? "<th>value</th>" : "");
  for (const Certificate::Line& line : lines) {
    const std::string value =
        with_value ? fmt::format("<td>{}</td>", Rounded(line.value, line.uncertainty)) : "";
    html += fmt::format("<tr><td>{}</td>{}<td>{}</td>{}<td>{}</td><td>{}</td></tr>\n",
                        Escaped(line.name), value, Known(line.uncertainty), Expanded(line),
                        Escaped(line.unit), line.evaluation);
  }
  html += "</table>\n";
}

// Sources that contribute to any of the lines, in their order: those of type A first.
std::vector<Certificate::Contribution> SourcesOfLines(const std::vector<Certificate::Line>& lines) {
  std::vector<Certificate::Contribution> sources;
  for (const Certificate::Line& line : lines) {
    for (const Certificate::Contribution& part : line.budget) {
      const bool known = std::any_of(sources.begin(), sources.end(), [&](const auto& source) {
        return source.source == part.source;
      });
      if (!known && part.uncertainty > 0) sources.push_back(part);
    }
  }
  std::stable_partition(sources.begin(), sources.end(),
                        [](const Certificate::Contribution& source) { return source.type_a; });
  return sources;
}

void BudgetTable(std::string& html, std::string_view title,
                 const std::vector<Certificate::Line>& lines) {
  const std::vector<Certificate::Contribution> sources = SourcesOfLines(lines);
  if (sources.empty()) return;
  html += fmt::format("<table class=\"b\">\n<tr><th>{}</th><th>unit</th>", title);
  for (const auto& source : sources) {
    html += fmt::format("<th>{} ({})</th>", Escaped(source.source), source.type_a ? "A" : "B");
  }
  html += "<th>u</th><th>dof</th><th>k</th><th>U</th></tr>\n";
  for (const Certificate::Line& line : lines) {
    if (line.budget.empty()) continue;
    html += fmt::format("<tr><td>{}</td><td>{}</td>", Escaped(line.name), Escaped(line.unit));
    for (const auto& source : sources) {
      const auto part = std::find_if(line.budget.begin(), line.budget.end(),
                                     [&](const auto& p) { return p.source == source.source; });
      html += fmt::format("<td>{}</td>", Share(part == line.budget.end() ? 0 : part->uncertainty,
                                               line.uncertainty));
    }
    constexpr double kMany = 1e4;  // k = 2.0002
    html += fmt::format("<td>{}</td><td>{}</td>{}</tr>\n", Known(line.uncertainty),
                        line.dof < kMany ? fmt::format("{:.0f}", std::floor(line.dof)) : "&infin;",
                        Expanded(line));
  }
  html += "</table>\n";
}

// What each source contributes, u^2 = sum of their squares.
void Budget(std::string& html, const Certificate& certificate) {
  std::string tables;
  BudgetTable(tables, "errors left in calibrated samples", certificate.samples);
  BudgetTable(tables, "result", certificate.result);
  BudgetTable(tables, "bench", certificate.bench);
  if (tables.empty()) return;
  html +=
      "<h2>Uncertainty budget</h2>\n<p>What each source contributes to u, in the unit of the "
      "quantity; u&sup2; is the sum of their squares. A: from the scatter of the readings; B: from "
      "what was stated of the bench, as References has it, carried through the adjustment; terms "
      "left out: they may be there after all. dof: effective degrees of freedom (JCGM 100, G.4), "
      "&infin; from 10000 on. Gravity enters as it was stated, without an uncertainty.</p>\n" +
      tables;
}

// Units of the joint fit's parameters; of accelerometers as they were read.
std::string UnitOf(std::string_view name) {
  const auto begins = [&](std::string_view with) { return name.substr(0, with.size()) == with; };
  if (begins("gyro_b") || begins("gyro_drift") || begins("gyro_hysteresis")) return "deg/h";
  if (begins("gyro_heating")) return "deg/h per degC/s";
  if (begins("gyro_N")) return "deg/h/g^2";
  if (begins("gyro_M") || begins("gyro_Q") || begins("gyro_G")) return "deg/h/g";
  if (begins("gyro_S")) return "1";
  if (begins("accel_b") || begins("accel_drift") || begins("accel_hysteresis")) return "reading";
  if (begins("accel_S")) return "reading/gravity";
  if (begins("accel_K2")) return "reading/gravity^2";
  return "";
}

// Residuals over their sigmas in the order of the readings, with the limit of chance.
void Picture(std::string& html, const std::string& channel,
             const std::vector<const FitResidual*>& residuals, double limit) {
  constexpr double kWidth = 640, kHeight = 110, kLeft = 30;  // pixels
  double most = std::max(3.0, limit);
  for (const FitResidual* residual : residuals) {
    most = std::max(most, std::abs(residual->studentised));
  }
  const auto y = [&](double value) { return kHeight / 2 * (1 - value / (1.05 * most)); };
  html += fmt::format(
      "<figure><svg viewBox=\"0 0 {} {}\" width=\"100%\" role=\"img\">\n<rect x=\"{}\" y=\"0\" "
      "width=\"{}\" height=\"{}\" fill=\"#f7f7f7\"/>\n",
      kWidth, kHeight, kLeft, kWidth - kLeft, kHeight);
  for (const double level : {-limit, 0.0, limit}) {
    html += fmt::format(
        "<line x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\"/>\n<text x=\"0\" "
        "y=\"{:.1f}\" font-size=\"9\">{:.1f}</text>\n",
        kLeft, kWidth, y(level), y(level), level == 0 ? "#888" : "#c00", y(level) + 3, level);
  }
  const auto n = static_cast<double>(residuals.size());
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    html += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"1.6\" fill=\"#1f4e8c\"/>\n",
                        kLeft + (kWidth - kLeft) * (static_cast<double>(i) + 0.5) / n,
                        y(residuals[i]->studentised));
  }
  html += fmt::format(
      "</svg><figcaption>{}: residual over its sigma, in the order of the readings"
      "</figcaption></figure>\n",
      Escaped(channel));
}

void Pictures(std::string& html, const Certificate& certificate) {
  constexpr std::size_t kMost = 2000;  // a picture's points
  std::map<std::string, std::vector<const FitResidual*>> of;
  for (const FitResidual& residual : certificate.residuals) {
    auto& list = of[residual.channel];
    if (list.size() < kMost) list.push_back(&residual);
  }
  if (of.empty()) return;
  html += "<h2>Residuals</h2>\n";
  html += fmt::format(
      "<p>{} readings, {} to spare; the sum of squares over their sigmas is {:.0f} (95 % of sound "
      "fits: {:.0f} to {:.0f}). The red lines are passed by the largest of so many once in a "
      "hundred fits.</p>\n",
      certificate.readings, certificate.dof, certificate.chi_square, certificate.chi_low,
      certificate.chi_high);
  for (const auto& [channel, residuals] : of) {
    Picture(html, channel, residuals, certificate.studentised_limit);
  }
}

void Files(std::string& html, std::string_view title, const std::vector<InputFile>& files) {
  if (files.empty()) return;
  html += fmt::format("<h2>{}</h2>\n<table>\n<tr><th>file</th><th>SHA-256</th></tr>\n", title);
  for (const InputFile& file : files) {
    html += fmt::format("<tr><td>{}</td><td class=\"t\">{}</td></tr>\n", Escaped(file.name),
                        Escaped(file.sha256));
  }
  html += "</table>\n";
}

// A row of a budget, if it has any.
void TakeBudget(const UncertaintyBudget& budget, Eigen::Index row, Certificate::Line& line) {
  if (budget.sources.empty()) return;
  line.evaluation = "budget";
  line.dof = budget.dof[row];
  for (std::size_t k = 0; k < budget.sources.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    line.budget.push_back(
        {budget.sources[k], column < budget.n_type_a, budget.contributions(row, column)});
  }
}

}  // namespace

void Certificate::Line::Scale(double per_unit) {
  value *= per_unit;
  uncertainty *= per_unit;
  for (Contribution& part : budget) part.uncertainty *= per_unit;
}

Certificate CertificateOf(const FitReport& report) {
  Certificate c;
  c.method = report.method;
  for (const FitQuantity& quantity : report.result) {
    for (Eigen::Index i = 0; i < quantity.sigma.rows(); ++i) {
      for (Eigen::Index j = 0; j < quantity.sigma.cols(); ++j) {
        if (!(quantity.sigma(i, j) > 0)) continue;
        std::string name = quantity.name;
        if (quantity.shape == FitQuantity::Shape::kVector) name += fmt::format("[{}]", i);
        if (quantity.shape == FitQuantity::Shape::kMatrix) name += fmt::format("[{},{}]", i, j);
        c.result.push_back({name, UnitOf(name), quantity.value(i, j), quantity.sigma(i, j), "A"});
        const auto at = std::find(report.parameters.begin(), report.parameters.end(), name);
        if (at == report.parameters.end()) continue;
        TakeBudget(report.budget, at - report.parameters.begin(), c.result.back());
      }
    }
  }
  c.remarks = report.remarks;
  c.residuals = report.residuals;
  c.studentised_limit = report.studentised_limit;
  c.chi_square = report.chi_square;
  c.chi_low = report.chi_low;
  c.chi_high = report.chi_high;
  c.readings = report.readings;
  c.dof = report.dof;
  return c;
}

SourceUnit UnitOfSource(const std::string& source) {
  const auto begins = [&](const char* with) { return source.rfind(with, 0) == 0; };
  if (begins("gyro_bias")) return {"deg/h", 1 / units::kDegPerHour};
  if (begins("gyro_force") || source == "mass_unbalance" || source == "quadrature") {
    return {"deg/h/g", 1 / units::kDegPerHourPerG};
  }
  if (begins("accel_bias")) return {"mg", 1 / units::kMilliG};
  return {};
}

std::vector<Certificate::Line> SampleErrors(const CalibrationSources& sources,
                                            const UncertaintyBudget& budget) {
  std::vector<Certificate::Line> lines;
  for (std::size_t i = 0; i < sources.names.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const SourceUnit unit = UnitOfSource(sources.names[i]);
    Certificate::Line line{sources.names[i], unit.name, 0,
                           std::sqrt(std::max(0.0, sources.cov(at, at))), "A"};
    TakeBudget(budget, at, line);
    line.Scale(unit.per_si);
    if (line.uncertainty > 0) lines.push_back(std::move(line));
  }
  return lines;
}

std::string CertificateHtml(const Certificate& certificate) {
  std::string html(kHead);
  html += "<h1>Calibration certificate</h1>\n";
  const bool range = certificate.temperature_high > certificate.temperature_low;
  Pairs(html,
        {{"certificate", certificate.number},
         {"issued by", certificate.laboratory},
         {"tool", certificate.asset_serial},
         {"sensors", certificate.sensor_serials},
         {"method", certificate.method},
         {"calibrated", certificate.calibrated},
         {"expires", certificate.expires},
         {"temperatures", range ? fmt::format("{:.4g} to {:.4g} degC", certificate.temperature_low,
                                              certificate.temperature_high)
                                : std::string()},
         {"program", certificate.program}});
  List(html, "References", certificate.references);
  List(html, "Traceability",
       certificate.traceability.empty()
           ? std::vector<std::string>{"none was stated: no reference instrument is named"}
           : certificate.traceability);
  html +=
      "<p>u is the standard uncertainty; U = k u covers 95 %, k = 2 where errors are normal and "
      "more where few readings gave their scatter (Student's t, JCGM 100). A: evaluated from the "
      "scatter of the readings; B: from what was stated; budget: from both in one adjustment, "
      "source by source in the uncertainty budget.</p>\n";
  Lines(html, "Errors left in calibrated samples", certificate.samples, false);
  Lines(html, "Result", certificate.result, true);
  Lines(html, "Bench", certificate.bench, true);
  Budget(html, certificate);
  List(html, "Terms left out", certificate.left_out);
  List(html, "Remarks", certificate.remarks);
  Pictures(html, certificate);
  Files(html, "Readings", certificate.inputs);
  Files(html, "Files that this certifies", certificate.outputs);
  html += "</body></html>\n";
  return html;
}

}  // namespace wellgyro
