// A whole survey from an LCM log: survey_a_log JOB.toml RUN.lcm > survey.csv
#include <cstdio>

#include "wellgyro/bus/survey_log.h"
#include "wellgyro/io/exchange/survey_csv.h"
#include "wellgyro/io/toml/job_file.h"

int main(int argc, char** argv) {
  if (argc != 3) return std::fputs("usage: survey_a_log JOB.toml RUN.lcm\n", stderr), 1;
  const auto file = wellgyro::ReadJob(argv[1]);
  if (!file) return std::fprintf(stderr, "%s\n", SentenceOf(file.fault()).c_str()), 2;
  const auto log = wellgyro::SurveyLog(file->job, argv[2]);
  if (!log) return std::fprintf(stderr, "%s\n", SentenceOf(log.fault()).c_str()), 2;
  const wellgyro::Survey& survey = log->tools.begin()->second;
  if (!survey.unusable.empty()) return std::fprintf(stderr, "%s\n", survey.unusable.c_str()), 2;
  std::fputs(wellgyro::SurveyCsv(survey.chosen, nullptr).c_str(), stdout);
}
