#include "wellgyro/io/result/clearance_report_internal.h"

#include <algorithm>
#include <limits>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/number_text_internal.h"
#include "wellgyro/io/plot/plot_text_internal.h"
#include "wellgyro/io/result/covariance_csv.h"

namespace wellgyro {
namespace {

double FactorOf(const OffsetResult& offset) {
  if (!offset.lowest || !offset.lowest->factor) return std::numeric_limits<double>::infinity();
  return *offset.lowest->factor;
}

std::string Text(const std::optional<double>& factor) {
  return factor ? Significant(*factor) : std::string();
}

/// A name without what would break a CSV line.
std::string Cell(const std::string& name) {
  std::string cell = name;
  std::ranges::replace_if(
      cell, [](unsigned char c) { return c < ' ' || c == ',' || c == '"'; }, ' ');
  return cell;
}

const char* WordFor(Correlation correlation) {
  constexpr const char* kWords[] = {"none", "global", "full"};
  return kWords[static_cast<int>(correlation)];
}

const char* WordFor(Scan scan) {
  constexpr const char* kWords[] = {"nearest in space", "horizontal", "travelling cylinder"};
  return kWords[static_cast<int>(scan)];
}

std::string RuleHtml(const ClearancePolicy& policy) {
  const SeparationRule& rule = policy.rule;
  return fmt::format(
      "<p>Separation rule of the ISCWSA (SPE-187073): k = {:g}, &sigma;<sub>pa</sub> = {:g} m, "
      "surface margin {:g} m; correlation {}; {}; scan {}. Stop below {:g}, alert below {:g}; "
      "wells "
      "that cannot come below {:g} are screened out.</p>\n",
      rule.k, rule.sigma_ahead, rule.surface_margin, WordFor(rule.correlation),
      rule.surface == ErrorSurface::kPedal ? "pedal curve" : "ellipsoid", WordFor(rule.scan),
      policy.stop, policy.alert, policy.report);
}

std::string WellRow(const OffsetResult& offset, const ClearancePolicy& policy) {
  if (!offset.lowest) {
    return fmt::format(
        "<tr><td>{0}</td><td colspan=\"6\">{1}</td><td class=\"{2}\">{2}</td></tr>\n",
        SvgText(offset.name), offset.screened_out ? "screened out" : "never opposite the reference",
        VerdictWord(offset, policy));
  }
  const Separation& s = *offset.lowest;
  const char* verdict = VerdictWord(offset, policy);
  return fmt::format(
      "<tr><td>{}</td><td>{:.2f}</td><td>{:.2f}</td><td>{:.2f}</td><td>{:.2f}</td><td>{:.2f}</td>"
      "<td>{}</td><td class=\"{}\">{}</td></tr>\n",
      SvgText(offset.name), s.md, s.other_md, s.distance, s.allowed, s.sigma,
      s.factor ? fmt::format("{:.3f}", *s.factor) : "", verdict, verdict);
}

}  // namespace

std::vector<ClearanceSeries> SeriesOf(const std::vector<OffsetResult>& offsets) {
  std::vector<const OffsetResult*> shown;
  for (const OffsetResult& offset : offsets) {
    if (!offset.rows.empty()) shown.push_back(&offset);
  }
  std::ranges::stable_sort(shown, {}, [](const OffsetResult* o) { return FactorOf(*o); });
  std::vector<ClearanceSeries> series;
  for (const OffsetResult* offset : shown) series.push_back({offset->name, &offset->rows});
  return series;
}

const char* VerdictWord(const OffsetResult& offset, const ClearancePolicy& policy) {
  const double factor = FactorOf(offset);
  if (factor < policy.stop) return "fail";
  return factor < policy.alert || offset.cut_short ? "warn" : "pass";
}

std::string ClearanceCsv(const std::vector<OffsetResult>& offsets) {
  std::string text =
      "WELL,MD[m],OTHER_MD[m],DISTANCE[m],N[m],E[m],V[m],TOOLFACE[deg],SIGMA[m],HOLES[m],"
      "ALLOWED[m],FACTOR,KIND\n";
  for (const OffsetResult& offset : offsets) {
    const std::string name = Cell(offset.name);
    for (const Separation& s : offset.rows) {
      text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", name, Metres(s.md),
                          Metres(s.other_md), Metres(s.distance), Metres(s.vector_W.x()),
                          Metres(s.vector_W.y()), Metres(s.vector_W.z()), AngleDeg(s.toolface),
                          Metres(s.sigma), Metres(s.holes), Metres(s.allowed), Text(s.factor),
                          KindWord(s.kind));
    }
  }
  return text;
}

std::string WellsCsv(const std::vector<OffsetResult>& offsets, const ClearancePolicy& policy) {
  std::string text =
      "WELL,MD[m],OTHER_MD[m],DISTANCE[m],ALLOWED[m],SIGMA[m],FACTOR,VERDICT,SCREENED_OUT\n";
  for (const OffsetResult& offset : offsets) {
    const std::string name = Cell(offset.name);
    if (!offset.lowest) {
      text += fmt::format("{},,,,,,,{},{}\n", name, VerdictWord(offset, policy),
                          offset.screened_out ? "yes" : "no");
      continue;
    }
    const Separation& s = *offset.lowest;
    text += fmt::format("{},{},{},{},{},{},{},{},no\n", name, Metres(s.md), Metres(s.other_md),
                        Metres(s.distance), Metres(s.allowed), Metres(s.sigma), Text(s.factor),
                        VerdictWord(offset, policy));
  }
  return text;
}

std::string ClearanceHtml(const std::string& reference, const std::vector<OffsetResult>& offsets,
                          const ClearancePolicy& policy, const std::vector<std::string>& notes,
                          const std::string& ladder, const std::string& cylinder) {
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Clearance of {0}"
      "</title>\n<style>body{{font-family:sans-serif;margin:2em}}table{{border-collapse:collapse}}"
      "td,th{{border:1px solid #bbb;padding:2px 8px;text-align:right}}td:first-child{{text-align:"
      "left}}.fail{{background:#f3b7b0}}.warn{{background:#f7dfa5}}.pass{{background:#cfe8cf}}"
      "svg{{max-width:100%;height:auto}}</style></head><body>\n<h1>Clearance of {0}</h1>\n",
      SvgText(reference));
  html += RuleHtml(policy);
  html +=
      "<table><tr><th>offset</th><th>MD [m]</th><th>offset MD [m]</th><th>distance [m]</th>"
      "<th>allowed [m]</th><th>sigma [m]</th><th>separation factor</th><th>verdict</th></tr>\n";
  std::vector<const OffsetResult*> sorted;
  for (const OffsetResult& offset : offsets) sorted.push_back(&offset);
  std::ranges::stable_sort(sorted, {}, [](const OffsetResult* o) { return FactorOf(*o); });
  for (const OffsetResult* offset : sorted) html += WellRow(*offset, policy);
  html += "</table>\n";
  html += ladder;
  html += cylinder;
  if (!notes.empty()) {
    html += "<h2>Taken as given</h2><ul>\n";
    for (const std::string& note : notes) html += "<li>" + SvgText(note) + "</li>\n";
    html += "</ul>\n";
  }
  return html + "</body></html>\n";
}

}  // namespace wellgyro
