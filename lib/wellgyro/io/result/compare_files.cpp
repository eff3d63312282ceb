#include "wellgyro/io/result/compare_files.h"

#include <cmath>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/io/exchange/survey_csv.h"
#include "wellgyro/io/formats.h"
#include "wellgyro/io/number_text_internal.h"
#include "wellgyro/io/result/taken_survey.h"
#include "wellgyro/io/toml/toml_internal.h"
#include "wellgyro/io/toml/toml_writer_internal.h"
#include "wellgyro/io/words.h"

namespace wellgyro {
namespace {

ComparedSurvey Known(const TakenSurvey& taken, const std::filesystem::path& path,
                     const CompareRequest& request, CompareAnswer& answer) {
  for (const std::string& note : taken.notes) answer.notes.push_back(note);
  ComparedSurvey survey;
  survey.well = taken.well;
  survey.cov_tie_in_W = taken.cov_tie_in_W;
  if (taken.legs.empty()) {
    if (taken.own.empty()) {
      throw std::invalid_argument(path.string() + " has no covariances and sigmas of its own" +
                                  (taken.lacks.empty() ? "" : " (no column " + taken.lacks + ")") +
                                  ": name its error model");
    }
    survey.own = taken.own;
    return survey;
  }
  Surroundings place = request.surroundings;
  place.convergence = request.convergence.value_or(0);
  survey.errors = ErrorsAtStations(taken.well.survey, place, taken.legs);
  if (survey.errors->refusal) {
    answer.refusals.push_back(path.string() + ": " + survey.errors->refusal->text);
  }
  return survey;
}

struct ShiftLine {
  const char *key, *words, *unit;
  double in_unit;
  const std::optional<ShiftEstimate>* shift;
};

std::vector<ShiftLine> ShiftLines(const Comparison& c) {
  return {{"depth_offset_m", "depth offset", "m", 1, &c.depth_offset},
          {"depth_stretch_m_per_km", "depth stretch", "m/km", 1e-3, &c.depth_stretch},
          {"azimuth_offset_deg", "azimuth offset", "deg", kPi / 180, &c.azimuth_offset}};
}

std::string Summary(const Comparison& c) {
  std::string text = fmt::format("{} depths from MD {:.2f} to {:.2f} m, second less first\n",
                                 c.places.size(), c.places.front().md, c.places.back().md);
  for (const ShiftLine& line : ShiftLines(c)) {
    if (const auto& shift = *line.shift) {
      text += fmt::format("{}: {:.3g} +- {:.2g} {}; {:.2g} {} would be found four times in five\n",
                          line.words, shift->value / line.in_unit, shift->sigma / line.in_unit,
                          line.unit, shift->smallest / line.in_unit, line.unit);
    }
  }
  const ComparedPlace& end = c.places.back();
  const Eigen::Vector3d& d = end.position_difference_W;
  text += fmt::format("at MD {:.2f} m: {:.2f} m north, {:.2f} m east, {:.2f} m down", end.md, d.x(),
                      d.y(), d.z());
  const Eigen::Vector3d& between = end.between_stations_W;
  text += fmt::format("; of that by different stations {:.2f}, {:.2f}, {:.2f} m", between.x(),
                      between.y(), between.z());
  if (end.position_sigmas) text += fmt::format("; the rest {:.2f} sigmas", *end.position_sigmas);
  return text;
}

void WriteInputOf(TomlWriter& toml, std::string_view of, const InputFile& input) {
  toml.Element("input");
  toml.Text("of", of);
  WriteInput(toml, input);
}

std::string CompareToml(const CompareRequest& request, const CompareAnswer& answer,
                        const TakenSurvey& first, const TakenSurvey& second) {
  const Comparison& c = answer.comparison;
  TomlWriter toml;
  toml.Text("format", formats::kComparison);
  toml.Text("verdict", WordOf(c.verdict.verdict));
  toml.Texts("causes", c.verdict.causes);
  toml.Whole("places", static_cast<std::int64_t>(c.places.size()));
  toml.Whole("joint_places", static_cast<std::int64_t>(c.joint));
  toml.Number("local_sigma_deg", ToDegrees(request.options.local_sigma));
  toml.Flag("same_run", request.options.same_run);
  constexpr double kSquare = units::kDeg * units::kDeg;
  toml.Number("hole_kink_deg2_per_m", c.kink / kSquare);
  toml.Number("hole_wander_deg2_per_m3", c.wander / kSquare);
  for (const ShiftLine& line : ShiftLines(c)) {
    const auto& shift = *line.shift;
    if (!shift) continue;
    toml.Table(line.key);
    toml.Number("value", shift->value / line.in_unit);
    toml.Number("sigma", shift->sigma / line.in_unit);
    toml.Number("smallest_found_4_in_5", shift->smallest / line.in_unit);
    if (line.shift == &c.depth_stretch) toml.Number("about_md_m", c.joint_middle);
  }
  for (const std::string& note : answer.notes) toml.Element("note"), toml.Text("text", note);
  for (const std::string& why : answer.refusals) toml.Element("refusal"), toml.Text("text", why);
  for (const InputFile& input : first.inputs) WriteInputOf(toml, "first", input);
  for (const InputFile& input : second.inputs) WriteInputOf(toml, "second", input);
  return toml.text();
}

TakenSurvey Taken(const std::filesystem::path& path, const std::string& model,
                  const CompareRequest& request) {
  Result<TakenSurvey> taken = TakeSurvey({path, model, request.convergence});
  if (!taken) throw TomlError{taken.fault()};
  return *std::move(taken);
}

CompareAnswer Answer(const CompareRequest& request) {
  const TakenSurvey first = Taken(request.first, request.first_model, request);
  const TakenSurvey second = Taken(request.second, request.second_model, request);
  CompareAnswer answer;
  const ComparedSurvey a = Known(first, request.first, request, answer);
  const ComparedSurvey b = Known(second, request.second, request, answer);
  answer.comparison = Compare(a, b, request.options);
  for (const std::string& note : answer.comparison.notes) answer.notes.push_back(note);
  if (a.well.survey.front().md != b.well.survey.front().md) {
    answer.notes.push_back(
        "the surveys begin at different depths: each one's first place is taken with its tie-in's "
        "covariance only");
  }
  answer.summary = Summary(answer.comparison);
  answer.inputs = {request.first, request.second};
  for (const TakenSurvey* survey : {&first, &second}) {
    for (const auto& path : PathsOf(survey->inputs)) answer.inputs.push_back(path);
  }
  answer.files = {{"compare.csv", CompareCsv(answer.comparison.places)},
                  {"checks.csv", ChecksCsv(answer.comparison.checks)},
                  {"compare.toml", CompareToml(request, answer, first, second)}};
  return answer;
}

}  // namespace

std::string CompareCsv(const std::vector<ComparedPlace>& places) {
  std::string text =
      "MD[m],INC_A[deg],INC_B[deg],D_INC[deg],SIG_D_INC[deg],AZI_A[deg],AZI_B[deg],D_AZI[deg],"
      "SIG_D_AZI[deg],DN[m],DE[m],DV[m],VAR_NN[m2],COV_NE[m2],COV_NV[m2],VAR_EE[m2],COV_EV[m2],"
      "VAR_VV[m2],POS_SIGMAS,BETWEEN_N[m],BETWEEN_E[m],BETWEEN_V[m]\n";
  const auto angle = [](const std::optional<double>& value) {
    return value ? AngleDeg(*value) : std::string();
  };
  for (const ComparedPlace& p : places) {
    text += fmt::format(
        "{},{},{},{},{},{},{},{},{},{},{},{}", Metres(p.md), AngleDeg(p.inclination[0]),
        AngleDeg(p.inclination[1]), AngleDeg(p.inclination_difference),
        AngleDeg(p.sigma_inclination), AzimuthDeg(p.azimuth[0]), AzimuthDeg(p.azimuth[1]),
        angle(p.azimuth_difference), angle(p.sigma_azimuth), Metres(p.position_difference_W.x()),
        Metres(p.position_difference_W.y()), Metres(p.position_difference_W.z()));
    for (int row = 0; row < 3; ++row) {
      for (int column = row; column < 3; ++column) {
        text.append(",").append(Significant(p.cov_position_W(row, column)));
      }
    }
    text.append(",").append(p.position_sigmas ? Significant(*p.position_sigmas) : "");
    for (const double d : p.between_stations_W) text.append(",").append(Metres(d));
    text.append("\n");
  }
  return text;
}

Result<CompareAnswer> AnswerCompare(const CompareRequest& request) {
  try {
    return Answer(request);
  } catch (const TomlError& error) {
    return error.fault;
  }
}

}  // namespace wellgyro
