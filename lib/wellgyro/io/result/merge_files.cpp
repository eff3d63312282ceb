#include "wellgyro/io/result/merge_files.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/exchange/exchange.h"
#include "wellgyro/io/exchange/survey_files.h"
#include "wellgyro/io/formats.h"
#include "wellgyro/io/number_text_internal.h"
#include "wellgyro/io/result/covariance_csv.h"
#include "wellgyro/io/text_internal.h"
#include "wellgyro/io/toml/merge_file.h"
#include "wellgyro/io/toml/toml_internal.h"
#include "wellgyro/io/toml/toml_writer_internal.h"
#include "wellgyro/io/words.h"
#include "wellgyro/survey/hole/hole_line.h"
#include "wellgyro/survey/hole/well_line.h"
#include "wellgyro/survey/verdict/verdict.h"
#include "wellgyro/survey/wells/compare.h"
#include "wellgyro/trajectory/trajectory.h"
#include "wellgyro/uncertainty/ellipse.h"

namespace wellgyro {
namespace {

constexpr std::size_t kRowsMax = 100'000;  // a decimetre of 10 km each

/// Two legs where they overlap.
struct Held {
  std::size_t first = 0, second = 0;
  std::optional<Comparison> comparison;  ///< absent: it could not be made
  std::string why;
};

Surroundings PlaceOf(const MergeRequest& request) {
  Surroundings place = request.surroundings;
  place.convergence = request.convergence.value_or(0);
  return place;
}

ComparedSurvey Compared(const MergeLeg& leg, const Surroundings& place) {
  ComparedSurvey survey;
  survey.well = SurveyWell(leg.stations, Eigen::Vector3d::Zero());
  const ToolLeg whole{leg.model, 0, leg.stations.size(), leg.run};
  survey.errors = ErrorsAtStations(survey.well.survey, place, {&whole, 1});
  return survey;
}

/// Legs that overlap over two stations and more; directions only, as their places hang on ties.
std::vector<Held> HoldAgainstEachOther(const MergePlan& plan, const Surroundings& place) {
  std::vector<Held> all;
  for (std::size_t i = 0; i < plan.legs.size(); ++i) {
    for (std::size_t j = i + 1; j < plan.legs.size(); ++j) {
      const MergeLeg &a = plan.legs[i], &b = plan.legs[j];
      const double begin = std::max(a.stations.front().md, b.stations.front().md);
      const double end = std::min(a.stations.back().md, b.stations.back().md);
      if (!(begin < end) || (a.kept && b.kept)) continue;
      Held held{i, j, std::nullopt, {}};
      CompareOptions options;
      options.same_run = a.model == b.model && a.run == b.run;
      try {
        held.comparison = Compare(Compared(a, place), Compared(b, place), options);
        std::erase_if(held.comparison->checks,
                      [](const Check& check) { return check.code == "compare_position"; });
        held.comparison->verdict = VerdictOfRun(held.comparison->checks, 0);
      } catch (const std::invalid_argument& error) {
        held.why = error.what();
      }
      all.push_back(std::move(held));
    }
  }
  return all;
}

std::string ComparisonsCsv(const MergePlan& plan, const std::vector<Held>& all) {
  std::string text = "FIRST,SECOND,FROM_MD[m],TO_MD[m],CODE,VALUE,SIGMA,LIMIT,UNIT,VERDICT\n";
  const auto number = [](const std::optional<double>& v) { return v ? Significant(*v) : ""; };
  for (const Held& held : all) {
    if (!held.comparison) continue;
    const Comparison& c = *held.comparison;
    for (const Check& check : c.checks) {
      text +=
          fmt::format("{},{},{},{},{},{},{},{},{},{}\n", CsvQuoted(plan.legs[held.first].name),
                      CsvQuoted(plan.legs[held.second].name), Metres(c.places.front().md),
                      Metres(c.places.back().md), check.code, number(check.value),
                      number(check.sigma), number(check.limit), check.unit, WordOf(check.verdict));
    }
  }
  return text;
}

std::string ChoicesCsv(const MergePlan& plan, const MergedSurvey& merged) {
  std::string text = "FROM_MD[m],TO_MD[m],LEG,MODEL,RUN,REASON\n";
  for (const MergeChoice& c : merged.choices) {
    const MergeLeg& leg = plan.legs[c.leg];
    text +=
        fmt::format("{},{},{},{},{},{}\n", Metres(c.from_md), Metres(c.to_md), CsvQuoted(leg.name),
                    CsvQuoted(leg.model->name), leg.run, CsvQuoted(c.reason));
  }
  for (const std::string& why : merged.unused)
    text += ",,,,," + CsvQuoted("not taken: " + why) + "\n";
  return text;
}

/// Between the last station of one leg and the first of the next, so that rounding in the survey
/// file moves no station across.
double BoundBelow(const MergedSurvey& merged, std::size_t leg) {
  const auto& stations = merged.well.survey;
  const std::size_t last = merged.legs[leg].end - 1;
  return last + 1 < stations.size() ? (stations[last].md + stations[last + 1].md) / 2
                                    : stations[last].md + 1;
}

std::string ProgramToml(const MergePlan& plan, const MergedSurvey& merged) {
  TomlWriter toml;
  toml.Text("format", formats::kProgram);
  toml.Table("tie_in");
  const Eigen::Vector3d& start = merged.well.position_W.front();
  toml.Number("north_m", start.x());
  toml.Number("east_m", start.y());
  toml.Number("tvd_m", start.z());
  const char* keys[] = {"sigma_north_m", "sigma_east_m", "sigma_tvd_m"};
  for (int i = 0; i < 3; ++i) toml.Number(keys[i], std::sqrt(plan.cov_tie_in_W(i, i)));
  for (std::size_t i = 0; i < merged.legs.size(); ++i) {
    toml.Element("leg");
    toml.Text("survey", "definitive.csv");
    toml.Text("model", plan.model_names[merged.choices[i].leg]);
    toml.Whole("run", merged.legs[i].run);
    if (i > 0) toml.Number("from_md_m", BoundBelow(merged, i - 1));
    toml.Number("to_md_m", BoundBelow(merged, i));
  }
  return toml.text();
}

std::string MergeToml(const MergePlan& plan, const MergeAnswer& answer) {
  TomlWriter toml;
  toml.Text("format", formats::kMerged);
  toml.Text("verdict", WordOf(answer.verdict.verdict));
  toml.Texts("causes", answer.verdict.causes);
  toml.Number("measure_m", answer.merged.measure);
  for (const MergeChoice& c : answer.merged.choices) {
    const MergeLeg& leg = plan.legs[c.leg];
    toml.Element("choice");
    toml.Text("leg", leg.name);
    toml.Text("model", leg.model->name);
    toml.Whole("run", leg.run);
    toml.Number("from_md_m", c.from_md);
    toml.Number("to_md_m", c.to_md);
    toml.Text("reason", c.reason);
  }
  for (const std::string& why : answer.merged.unused) {
    toml.Element("unused");
    toml.Text("text", why);
  }
  for (const std::string& note : answer.notes) toml.Element("note"), toml.Text("text", note);
  WriteInputs(toml, plan.inputs);
  return toml.text();
}

void SetPlace(const Eigen::Vector3d& position, const Eigen::Matrix3d& cov, double severity,
              std::size_t row, SurveyTable& table) {
  table.Set(Column::kTvd, row, position.z());
  table.Set(Column::kNorth, row, position.x());
  table.Set(Column::kEast, row, position.y());
  table.Set(Column::kDogleg, row, severity);
  table.Set(Column::kVarNN, row, cov(0, 0));
  table.Set(Column::kCovNE, row, cov(0, 1));
  table.Set(Column::kCovNV, row, cov(0, 2));
  table.Set(Column::kVarEE, row, cov(1, 1));
  table.Set(Column::kCovEV, row, cov(1, 2));
  table.Set(Column::kVarVV, row, cov(2, 2));
}

void SetHead(const MergePlan& plan, const MergeRequest& request, SurveyTable& table) {
  SurveyHead& head = table.head;
  head.names.well = head.names.wellbore = plan.name.empty() ? "merged" : plan.name;
  head.names.survey = "Definitive survey";
  head.azimuth.north = head.offsets = request.convergence ? North::kGrid : North::kTrue;
  if (request.convergence) head.azimuth.convergence = *request.convergence;
  head.datum = "depth datum";
  head.vertical_reference = "MSL";
  head.method = "minimum curvature";
  head.planned = false;
  head.memory = false;
}

std::vector<double> Depths(const MergeRequest& request, const SurveyedWell& well) {
  std::vector<double> depths = request.at;
  const double begin = well.survey.front().md, end = well.survey.back().md;
  if (request.every > 0) {
    const double first = std::ceil(begin / request.every - 1e-9);
    const double count = std::floor(end / request.every + 1e-9) - first;
    if (!(count < kRowsMax)) throw std::invalid_argument("more than 100000 depths to resample at");
    for (int i = 0; i <= static_cast<int>(count); ++i) {
      depths.push_back(std::clamp((first + i) * request.every, begin, end));
    }
  }
  for (const double md : depths) {
    if (!(md >= begin && md <= end)) {
      throw std::invalid_argument(
          fmt::format("MD {} m is not in the survey, which has {} to {} m", md, begin, end));
    }
  }
  std::ranges::sort(depths);
  depths.erase(std::unique(depths.begin(), depths.end()), depths.end());
  return depths;
}

std::string Summary(const MergePlan& plan, const MergedSurvey& merged) {
  std::string text;
  for (const MergeChoice& c : merged.choices) {
    text += fmt::format("MD {:.2f} to {:.2f} m: {} ({}); {}\n", c.from_md, c.to_md,
                        plan.legs[c.leg].name, plan.legs[c.leg].model->name, c.reason);
  }
  for (const std::string& why : merged.unused) text += "not taken: " + why + "\n";
  const Eigen::Matrix3d& cov = merged.errors.cov_p_W.back();
  const ErrorEllipse e = HorizontalEllipse(cov, kConfidence);
  return text + fmt::format(
                    "MD {:.2f} m: 95 % ellipse {:.2f} x {:.2f} m (semi-axes), azimuth {:.1f} "
                    "deg; vertical 1 sigma {:.2f} m",
                    merged.well.survey.back().md, e.semi_major, e.semi_minor,
                    ToDegrees(e.azimuth_major), std::sqrt(std::max(0.0, cov(2, 2))));
}

void Judge(const MergePlan& plan, const std::vector<Held>& all, MergeAnswer& answer) {
  for (const Held& held : all) {
    const std::string pair = plan.legs[held.first].name + " and " + plan.legs[held.second].name;
    if (!held.comparison) {
      answer.notes.push_back(pair + " could not be compared: " + held.why);
      continue;
    }
    const RunVerdict& verdict = held.comparison->verdict;
    if (verdict.verdict == Verdict::kPass) continue;
    const bool fails =
        verdict.verdict == Verdict::kFail && plan.disagreement == OnDisagreement::kFail;
    const Verdict worth = fails ? Verdict::kFail : Verdict::kWarn;
    if (answer.verdict.verdict != Verdict::kFail) answer.verdict.verdict = worth;
    for (const std::string& cause : verdict.causes) {
      answer.verdict.causes.push_back(pair + ": " + cause);
    }
  }
}

MergeAnswer Answer(const MergeRequest& request) {
  const North wanted = request.convergence ? North::kGrid : North::kTrue;
  Result<MergePlan> read = request.text.empty()
                               ? ReadMergePlan(request.plan, wanted)
                               : ParseMergePlan(request.text, "plan", request.plan, wanted);
  if (!read) throw TomlError{read.fault()};
  const MergePlan plan = *std::move(read);
  const Surroundings place = PlaceOf(request);
  MergeAnswer answer;
  answer.inputs = PathsOf(plan.inputs);
  answer.inputs.push_back(request.plan);
  answer.notes = plan.notes;
  answer.merged = Merge(plan.legs, plan.start_W, plan.cov_tie_in_W, place, plan.policy);
  const MergedSurvey& merged = answer.merged;
  for (const std::string& note : merged.errors.notes) answer.notes.push_back(note);
  std::vector<double> own;
  for (const SurveyPoint& p : merged.well.survey) own.push_back(p.md);
  answer.table = Resampled(merged.well, merged.errors, own);
  SetHead(plan, request, answer.table);
  const std::vector<Held> held = HoldAgainstEachOther(plan, place);
  Judge(plan, held, answer);
  answer.files.push_back(
      {"definitive.csv", WriteSurvey(Rounded(answer.table), SurveyFormat::kCsv)});
  for (OutputFile& file : ExportFormats(answer.table, request.formats, "definitive")) {
    answer.files.push_back(std::move(file));
  }
  if (!request.at.empty() || request.every > 0) {
    SurveyTable table = Resampled(merged.well, merged.errors, Depths(request, merged.well));
    SetHead(plan, request, table);
    answer.files.push_back({"resampled.csv", WriteSurvey(Rounded(table), SurveyFormat::kCsv)});
  }
  answer.files.push_back({"choices.csv", ChoicesCsv(plan, merged)});
  answer.files.push_back({"comparisons.csv", ComparisonsCsv(plan, held)});
  answer.files.push_back({"program.toml", ProgramToml(plan, merged)});
  answer.files.push_back({"merge.toml", MergeToml(plan, answer)});
  answer.summary = Summary(plan, merged);
  return answer;
}

}  // namespace

SurveyTable Resampled(const SurveyedWell& well, const PositionUncertainty& errors,
                      const std::vector<double>& depths) {
  const HoleLine line({&well, &errors});
  const Trajectory trajectory = LineOf(well);
  SurveyTable table;
  for (const double md : depths) {
    const auto next = std::ranges::lower_bound(well.survey, md, {}, &SurveyPoint::md);
    const auto below = std::clamp<std::size_t>(static_cast<std::size_t>(next - well.survey.begin()),
                                               1, line.stations() - 1);
    const HoleLine::Place place{below - 1, md - well.survey[below - 1].md};
    const bool listed = next != well.survey.end() && next->md == md;
    const TrajectoryPoint p = trajectory.AtMd(md);
    const double azimuth = listed ? next->azimuth : p.azimuth;
    const std::size_t row = table.Add(md, listed ? next->inclination : p.inclination, azimuth,
                                      listed ? RowStatus::kSurveyed : RowStatus::kInterpolated);
    SetPlace(p.position_W, line.Cov(place), p.dogleg_severity, row, table);
  }
  return table;
}

Result<MergeAnswer> AnswerMerge(const MergeRequest& request) {
  try {
    return Answer(request);
  } catch (const TomlError& error) {
    return error.fault;
  } catch (const std::domain_error& error) {
    throw std::invalid_argument(error.what());
  }
}

}  // namespace wellgyro
