// A survey from any format that wellgyro reads to LAS in feet: convert_survey IN > OUT.las
#include <cstdio>

#include "wellgyro/io/exchange/exchange.h"

int main(int argc, char** argv) {
  if (argc != 2) return std::fputs("usage: convert_survey IN\n", stderr), 1;
  auto table = wellgyro::ReadSurvey(argv[1]);
  if (!table) {
    std::fprintf(stderr, "%s:%d: %s\n", argv[1], table.fault().line, table.fault().text.c_str());
    return 2;
  }
  wellgyro::FillPositions(*table);
  wellgyro::SetUnits(*table, wellgyro::LengthUnit::kFoot);
  std::fputs(wellgyro::WriteSurvey(*table, wellgyro::SurveyFormat::kLas).c_str(), stdout);
}
