#include "wellgyro/io/result/diagnosis_csv.h"

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <fmt/core.h>

#include "wellgyro/io/iso_time_internal.h"
#include "wellgyro/io/number_text_internal.h"
#include "wellgyro/io/text_internal.h"
#include "wellgyro/record/run_fit.h"
#include "wellgyro/survey/verdict/run_diagnosis.h"

namespace wellgyro {
namespace {

std::string Number(const std::optional<double>& v) { return v ? Significant(*v) : ""; }

std::string Length(const std::optional<double>& v) { return v ? Metres(*v) : ""; }

std::string Shift(const std::optional<Eigen::Vector3d>& shift) {
  if (!shift) return ",,";
  return fmt::format("{},{},{}", Metres(shift->x()), Metres(shift->y()), Metres(shift->z()));
}

std::string Joined(const std::vector<std::string>& codes) {
  std::string text;
  for (const std::string& code : codes) text += (text.empty() ? "" : "+") + code;
  return text;
}

}  // namespace

std::string DiagnosisCsv(const Survey& survey) {
  std::string text =
      "RUN,CODE,BEGIN_UTC,BEGIN_MD[m],SIZE,SIGMA,UNIT,LN_BAYES,POSTERIOR,DN[m],DE[m],DV[m],ALIKE,"
      "REMEDY\n";
  for (const RunSummary& run : survey.runs) {
    for (const RunCause& cause : CausesOf(run, survey.checks)) {
      const std::string begin =
          cause.begin ? IsoUtc(1e-9 * static_cast<double>(cause.begin->ns)) : "";
      text +=
          fmt::format("{},{},{},{},{},{},{},{},{},{},{},{}\n", run.run, CsvQuoted(cause.code),
                      begin, Length(cause.begin_md), Number(cause.size), Number(cause.sigma),
                      CsvQuoted(cause.unit), Number(cause.ln_bayes), Significant(cause.posterior),
                      Shift(cause.shift_W), Joined(cause.alike), CsvQuoted(cause.remedy));
    }
  }
  return text;
}

std::string ReliabilityCsv(const Survey& survey) {
  std::string text = "RUN,CODE,SMALLEST,UNIT,AT_MD[m],DN[m],DE[m],DV[m]\n";
  for (const RunSummary& run : survey.runs) {
    if (!run.fit || !run.fit->diagnosis) continue;
    std::vector<RunReliability> faults = run.fit->diagnosis->reliability;
    if (run.slip) faults.push_back(run.slip->reliability);
    for (const RunReliability& hidden : faults) {
      text += fmt::format("{},{},{},{},{},{}\n", run.run, hidden.code, Number(hidden.smallest),
                          hidden.unit, Length(hidden.md), Shift(hidden.shift_W));
    }
  }
  return text;
}

}  // namespace wellgyro
