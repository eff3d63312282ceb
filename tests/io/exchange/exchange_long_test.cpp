// Ten million lines, through a CSV file and through LAS. Half a minute and 3 GB; run as tests/run
// --long, or .build/release/tests/io/test-io-long.
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "wellgyro/io/exchange/exchange.h"

#include "support/scratch.h"

namespace wellgyro {
namespace {

constexpr int kLines = 10'000'000;

constexpr char kCsvHead[] = "MD[m],INC[deg],AZI_TRUE[deg]\n";
constexpr char kLasHead[] =
    "~V\n VERS. 2.0 :\n WRAP. NO :\n~W\n STRT.M 0 :\n STOP.M 9999.999 :\n STEP.M 0.001 :\n"
    " NULL. -999.25 :\n~C\n DEPT.M :\n DEVI.DEG :\n AZIM.DEG :\n~A\n";

// A straight hole at 60 deg, a station every millimetre; `bad`: the line, from 1, that is no row.
std::string WriteLines(const support::Scratch& scratch, int bad, bool las = false) {
  const std::string path = (scratch.path() / "lines").string();
  std::FILE* file = std::fopen(path.c_str(), "w");
  std::fputs(las ? kLasHead : kCsvHead, file);
  for (int i = 0; i < kLines; ++i) {
    if (i + 2 == bad) {
      std::fputs("?\n", file);
    } else {
      std::fprintf(file, las ? "%d.%03d 60 45\n" : "%d.%03d,60,45\n", i / 1000, i % 1000);
    }
  }
  std::fclose(file);
  return path;
}

// The most that this process has held at once [MB].
double PeakMegabytes() {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word) {
    double kilobytes = 0;
    if (word == "VmHWM:" && status >> kilobytes) return kilobytes / 1024;
  }
  return 0;
}

// Beyond the table, whose columns grow by doubling, reading holds some blocks of the file alone.
void ExpectBoundedReading(const SurveyTable& table, const char* what) {
  const double held = 8 * static_cast<double>(table.cells()) / (1 << 20);
  const double peak = PeakMegabytes();
  std::printf("%s: %.0f MB at the peak, %.0f MB of numbers\n", what, peak, held);
  EXPECT_GT(peak, held);
  EXPECT_LT(peak, 3 * held + 100);
}

void ExpectTheHole(const SurveyTable& table) {
  ASSERT_EQ(table.rows(), std::size_t{kLines});
  for (const std::size_t row : {std::size_t{1}, std::size_t{kLines} / 2, std::size_t{kLines} - 1}) {
    const double md = 1e-3 * static_cast<double>(row);
    EXPECT_NEAR(table.md(row), md, 1e-9);
    EXPECT_NEAR(*table.Get(Column::kTvd, row), md / 2, 2e-6);
    EXPECT_NEAR(*table.Get(Column::kNorth, row), md * std::sqrt(0.375), 2e-6);
    EXPECT_NEAR(*table.Get(Column::kEast, row), md * std::sqrt(0.375), 2e-6);
  }
}

// First, as the peak is that of the whole process.
TEST(ExchangeLong, MemoryOfReadingIsBounded) {
  for (const bool las : {false, true}) {
    const support::Scratch scratch;
    const Result<SurveyTable> table = ReadSurvey(WriteLines(scratch, 0, las));
    ASSERT_TRUE(table) << table.fault().text;
    ASSERT_EQ(table->rows(), std::size_t{kLines});
    ExpectBoundedReading(*table, las ? "LAS" : "CSV");
  }
}

TEST(ExchangeLong, TenMillionLinesAreReadSummedAndWritten) {
  std::string las;
  {
    const support::Scratch scratch;
    Result<SurveyTable> table = ReadSurvey(WriteLines(scratch, 0));
    ASSERT_TRUE(table) << table.fault().text;
    ASSERT_TRUE(FillPositions(*table));
    ExpectTheHole(*table);
    table->head.names.well = "Long";
    las = WriteSurvey(*table, SurveyFormat::kLas);
  }
  const Result<SurveyTable> again = ParseSurvey(las, "again.las");
  ASSERT_TRUE(again) << again.fault().text;
  ExpectTheHole(*again);
  std::printf("%d lines: LAS of %zu bytes\n", kLines, las.size());
}

TEST(ExchangeLong, ABadLineAmongTenMillionIsNamed) {
  const support::Scratch scratch;
  const Result<SurveyTable> table = ReadSurvey(WriteLines(scratch, 9'876'543));
  ASSERT_FALSE(table);
  EXPECT_EQ(table.fault().line, 9'876'543);
}

}  // namespace
}  // namespace wellgyro
