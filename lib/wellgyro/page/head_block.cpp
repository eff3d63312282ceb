// The verdict, and block 1: what the survey is of, where it ends, and who signs.
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/io/text_internal.h"
#include "wellgyro/page/html_internal.h"
#include "wellgyro/page/page_internal.h"

namespace wellgyro {
namespace {

constexpr std::string_view kNotStated = "<span class=\"absent\">not stated</span>";

/// Facts as two columns; a value is HTML.
class Facts {
 public:
  explicit Facts(std::string& html) : html_(html) { html_ += "<dl class=\"facts\">\n"; }
  ~Facts() { html_ += "</dl>\n"; }
  Facts(const Facts&) = delete;
  Facts& operator=(const Facts&) = delete;

  void Html(std::string_view name, std::string_view value) {
    html_ += fmt::format("<div><dt>{}</dt><dd>{}</dd></div>\n", Escaped(name),
                         value.empty() ? kNotStated : value);
  }
  void Text(std::string_view name, std::string_view value) {
    Html(name, value.empty() ? std::string() : Isolated(value));
  }

 private:
  std::string& html_;
};

/// What the job's [identity] says under one of several names, and which were asked for.
class Identity {
 public:
  explicit Identity(const Json& table) {
    if (!table.is_object()) return;
    for (const auto& [key, value] : table.items()) {
      entries_.emplace_back(key, value.is_string() ? value.get<std::string>() : value.dump());
    }
  }

  std::string Take(std::initializer_list<std::string_view> names) {
    for (const auto& [key, value] : entries_) {
      for (const std::string_view name : names) {
        if (LettersAndDigits(key) != name) continue;
        taken_.insert(key);
        return value;
      }
    }
    return {};
  }

  void WriteRest(Facts& facts) const {
    for (const auto& [key, value] : entries_) {
      if (!taken_.contains(key)) facts.Text(key, value);
    }
  }

 private:
  std::vector<std::pair<std::string, std::string>> entries_;
  std::set<std::string> taken_;
};

std::string Degrees(const std::optional<double>& value, int decimals) {
  return value ? NumberText(value, decimals) + "\u00b0" : std::string();
}

/// "28.000000° north" or, of what is negative, south.
std::string Toward(const std::optional<double>& value, const char* word, const char* opposite) {
  if (!value) return std::string(kNotStated);
  return Degrees(std::abs(*value), 6) + ' ' + (*value < 0 ? opposite : word);
}

std::string DatesOf(const Json& runs) {
  std::string begin, end;
  if (runs.is_array()) {
    for (const Json& run : runs) {
      const std::string first = TimeText(NumberAt(run, {"begin_utime_us"}));
      const std::string last = TimeText(NumberAt(run, {"end_utime_us"}));
      if (!first.empty() && (begin.empty() || first < begin)) begin = first;
      end = std::max(end, last);
    }
  }
  return begin.empty() ? begin : begin + " to " + end + " UTC";
}

std::string NorthText(const Json& north) {
  std::string text = "azimuths from true north";
  const std::string grid = TextAt(north, {"grid"});
  if (grid.empty()) return text + "; no map grid";
  text += "; grid " + Isolated(grid);
  const auto convergence = NumberAt(north, {"convergence_deg"});
  if (!convergence) return text;
  const bool stated = TextAt(north, {"convergence_source"}) == "stated";
  return text + fmt::format(", convergence at the well {} (true azimuth less grid), {}",
                            Degrees(convergence, 4),
                            stated ? "stated by the operator" : "of the projection");
}

std::string TieText(const PageText& page) {
  const Columns stations(At(page.survey, {"stations"}));
  if (stations.rows() == 0) return {};
  const auto at = [&](const char* name) {
    return NumberText(page.Length(stations.Number(0, name)), 2);
  };
  return fmt::format("MD {} {}: TVD {}, north {}, east {}; inclination {}, azimuth {}{}",
                     at("MD[m]"), page.units.length_name, at("TVD[m]"), at("N[m]"), at("E[m]"),
                     Degrees(stations.Number(0, "INC[deg]"), 2),
                     Degrees(stations.Number(0, "AZI_TRUE[deg]"), 2),
                     At(page.survey, {"job", "tie_in"}).is_object() ? "" : " (of the run itself)");
}

void WriteTools(Facts& facts, const Json& survey) {
  const Json& tools = At(survey, {"run", "tool"});
  if (tools.is_array()) {
    for (const Json& tool : tools) {
      std::string text = Isolated(TextAt(tool, {"asset_serial"}));
      const std::string sensors = TextAt(tool, {"sensor_serials"});
      const std::string firmware = TextAt(tool, {"firmware"});
      if (!sensors.empty()) text += ", sensors " + Isolated(sensors);
      if (!firmware.empty()) text += ", firmware " + Isolated(firmware);
      facts.Html("Tool " + TextAt(tool, {"tool"}) + ", run " + TextAt(tool, {"run"}), text);
    }
  } else {
    facts.Text("Tool and serials", "");
  }
  const Json& file = At(survey, {"tool_file"});
  const std::string expires = TextAt(file, {"expires"});
  facts.Text("Calibrated",
             TextAt(file, {"calibrated"}) + (expires.empty() ? "" : ", expires " + expires));
}

void WriteWell(PageText& page, Facts& facts, Identity& identity) {
  const Json& well = At(page.survey, {"run", "well"});
  facts.Text("Operator", identity.Take({"operator"}));
  facts.Text("Field", identity.Take({"field"}));
  facts.Text("Well", TextAt(well, {"name"}));
  facts.Text("Slot", identity.Take({"slot"}));
  facts.Text("Rig", identity.Take({"rig"}));
  facts.Text("Job", identity.Take({"jobnumber", "job"}));
  facts.Text("Dates", DatesOf(At(page.survey, {"run", "run"})));
  facts.Html("Well head", Toward(NumberAt(well, {"latitude_deg"}), "north", "south") + ", " +
                              Toward(NumberAt(well, {"longitude_deg"}), "east", "west") +
                              ", WGS 84");
  facts.Html("North reference", NorthText(At(page.survey, {"north"})));
  facts.Html("Depth datum",
             fmt::format("{} {} above mean sea level",
                         NumberText(page.Length(NumberAt(well, {"datum_elevation_m"})), 2),
                         page.units.length_name));
  facts.Text("Depth reference", identity.Take({"depthreference", "datum"}));
  facts.Text("Measured depth", TextAt(page.survey, {"run", "md_kind"}));
  facts.Html("Tie-in", TieText(page));
}

void WriteEnd(PageText& page) {
  const Json& end = At(page.survey, {"end"});
  page.html += "<h3>End of survey</h3>\n";
  if (!end.is_object()) return SayNotMeasured(page, "End of survey");
  const auto length = [&](const char* name) {
    return NumberText(page.Length(NumberAt(end, {name})), 2);
  };
  Facts facts(page.html);
  const std::string unit(page.units.length_name);
  facts.Html("MD", length("MD[m]") + ' ' + unit);
  facts.Html("Direction", "inclination " + Degrees(NumberAt(end, {"INC[deg]"}), 2) + ", azimuth " +
                              Degrees(NumberAt(end, {"AZI_TRUE[deg]"}), 2) + " true");
  facts.Html("Position", fmt::format("north {0} {3}, east {1} {3}, TVD {2} {3}", length("N[m]"),
                                     length("E[m]"), length("TVD[m]"), unit));
  const Json& ellipse = At(end, {"ellipse"});
  const auto half = [&](const char* name) {
    return NumberText(page.Length(NumberAt(ellipse, {name})), 2);
  };
  facts.Html(
      "95 % error ellipse",
      ellipse.is_object()
          ? fmt::format("{0} by {1} {2} (half axes), the long one towards {3}; TVD \u00b1 {4} {2}",
                        half("semi_major_m"), half("semi_minor_m"), unit,
                        Degrees(NumberAt(ellipse, {"azimuth_major_deg"}), 0),
                        half("vertical_half_m"))
          : std::string("<strong>none: the end is unfit</strong>"));
  const Columns hidden(At(page.survey, {"reliability"}));
  facts.Html("Reliability ellipse",
             hidden.rows() > 0 ? "see block 7" : "<span class=\"absent\">not measured</span>");
}

void WriteSignatures(PageText& page) {
  page.html +=
      "<table class=\"signatures\"><thead><tr><th scope=\"col\"></th><th scope=\"col\">Name</th>"
      "<th scope=\"col\">Signature</th><th scope=\"col\">Date</th></tr></thead><tbody>";
  for (const char* who : {"Survey engineer", "Checked by", "For the operator"}) {
    page.html += fmt::format("<tr><th scope=\"row\">{}</th><td></td><td></td><td></td></tr>", who);
  }
  page.html += "</tbody></table>\n";
}

}  // namespace

void WriteVerdict(PageText& page) {
  const Json& run = At(page.survey, {"run"});
  std::string verdict = TextAt(run, {"verdict", "verdict"});
  constexpr std::array kKnown = {"pass", "warn", "fail"};
  const bool known = std::ranges::find(kKnown, verdict) != kKnown.end();
  page.html += fmt::format(
      "<section class=\"verdict {0}\"><h1>Gyro survey report: {1}</h1>\n"
      "<p class=\"word\">Verdict: {2}</p>\n",
      known ? verdict : "none", Isolated(Clipped(TextAt(run, {"well", "name"}), 200)),
      known ? verdict : "not given");
  if (verdict == "fail") {
    page.html += "<p>Not to be handed over as it is: every sigma and ellipse is withheld.</p>\n";
  }
  const Json& causes = At(run, {"verdict", "causes"});
  if (causes.is_array() && !causes.empty()) {
    page.html += "<ul>\n";
    for (const Json& cause : causes) {
      page.html += "<li>" + Isolated(cause.is_string() ? cause.get<std::string>() : cause.dump()) +
                   "</li>\n";
    }
    page.html += "</ul>\n";
  } else {
    page.html += "<p>No check failed or warned.</p>\n";
  }
  const std::string ended = TextAt(page.survey, {"source", "ended"});
  if (!ended.empty())
    page.html += "<p>Surveyed live; the stream ended: " + Isolated(ended) + "</p>\n";
  page.html += "</section>\n";
}

void WriteHead(PageText& page) {
  BeginBlock(page, 1, "The survey");
  {
    Identity identity(At(page.survey, {"run", "identity"}));
    Facts facts(page.html);
    WriteWell(page, facts, identity);
    facts.Text("Tool type", identity.Take({"tooltype", "tool"}));
    WriteTools(facts, page.survey);
    facts.Text("Conveyance", identity.Take({"conveyance", "conveyedby"}));
    facts.Text("Survey engineer", identity.Take({"surveyengineer", "engineer", "surveyor"}));
    identity.WriteRest(facts);
  }
  WriteEnd(page);
  WriteSignatures(page);
  EndBlock(page);
}

}  // namespace wellgyro
