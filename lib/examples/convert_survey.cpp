// A survey from any format that wellgyro reads to LAS in feet: convert_survey IN > OUT.las
#include <cstdio>

#include "wellgyro/io/exchange/exchange.h"

int main(int argc, char** argv) {
  if (argc != 2) return std::fputs("usage: convert_survey IN\n", stderr), 1;
  auto table = wellgyro::ReadSurvey(argv[1]);
  if (!table) return std::fprintf(stderr, "%s\n", SentenceOf(table.fault()).c_str()), 2;
  wellgyro::FillPositions(*table);
  wellgyro::SetUnits(*table, wellgyro::LengthUnit::kFoot);
  std::fputs(wellgyro::WriteSurvey(*table, wellgyro::SurveyFormat::kLas).c_str(), stdout);
}
