// Against figures that others published: W. Riley, Handbook of Frequency Stability Analysis, NIST
// SP 1065 (2008), section 12; tables printed by Stable32; exact integer sums over a real gyro's
// log.
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numeric>

#include <gtest/gtest.h>

#include "wellgyro/noise/allan_variance.h"

#include "noise/reference_files.h"

namespace wellgyro {
namespace {

using test::ReferencePath;

constexpr std::array<double, 9> kNbs10{892, 809, 823, 798, 671, 644, 883, 903, 677};

std::vector<double> Riley1000() {
  std::vector<double> rate;
  std::int64_t n = 1234567890;
  for (int i = 0; i < 1000; ++i) {
    rate.push_back(static_cast<double>(n) / 2147483647.);
    n = 16807 * n % 2147483647;
  }
  EXPECT_EQ(n, 16807 * std::int64_t{1560135652} % 2147483647);
  return rate;
}

AllanPoint At(std::span<const double> rate, std::int64_t m, Deviation deviation) {
  AllanOptions options;
  options.deviation = deviation;
  return AllanVariance(rate, 1, std::array{m}, options).points.at(0);
}

struct Published {
  std::int64_t m;
  Deviation deviation;
  std::int64_t terms;
  double printed;
  double unit;   // of the last digit printed
  double exact;  // rational arithmetic
};

void ExpectPublished(std::span<const double> rate, std::span<const Published> cases) {
  for (const auto& c : cases) {
    const AllanPoint point = At(rate, c.m, c.deviation);
    const double sigma = std::sqrt(point.variance);
    EXPECT_EQ(point.terms, c.terms) << c.m;
    EXPECT_LE(std::abs(sigma - c.printed), c.unit * 0.500001) << c.m;
    EXPECT_NEAR(sigma / c.exact, 1, 1e-13) << c.m;
  }
}

TEST(AllanPublished, Nbs10) {
  ExpectPublished(
      kNbs10, std::array{
                  Published{1, Deviation::kAllan, 8, 91.22945, 1e-5, 91.2294497407498342519},
                  Published{1, Deviation::kOverlapped, 8, 91.22945, 1e-5, 91.2294497407498342519},
                  Published{1, Deviation::kModified, 7 + 1, 91.22945, 1e-5, 91.2294497407498342519},
                  Published{2, Deviation::kAllan, 3, 115.8082, 1e-4, 115.808210704883385080},
                  Published{2, Deviation::kOverlapped, 6, 85.95287, 1e-5, 85.9528698376810065038},
                  Published{2, Deviation::kModified, 5, 74.78849, 1e-5, 74.7884934331478561306},
              });
}

TEST(AllanPublished, Riley1000) {
  ExpectPublished(
      Riley1000(),
      std::array{
          Published{1, Deviation::kAllan, 999, 0.2922319, 1e-7, 0.29223187810675917745},
          Published{1, Deviation::kOverlapped, 999, 0.2922319, 1e-7, 0.29223187810675917745},
          Published{1, Deviation::kModified, 999, 0.2922319, 1e-7, 0.29223187810675917745},
          Published{10, Deviation::kAllan, 99, 0.09965736, 1e-8, 0.09965736063174785625},
          Published{10, Deviation::kOverlapped, 981, 0.09159953, 1e-8, 0.09159953420118653109},
          Published{10, Deviation::kModified, 972, 0.06172376, 1e-8, 0.06172376382452217643},
          Published{100, Deviation::kAllan, 9, 0.03897804, 1e-8, 0.03897804330802650199},
          Published{100, Deviation::kOverlapped, 801, 0.03241343, 1e-8, 0.03241343026056983637},
          Published{100, Deviation::kModified, 702, 0.02170921, 1e-8, 0.02170920913694240422},
      });
}

// The last difference there is must count: 2m = M leaves one.
TEST(AllanPublished, Riley1000AtHalfItsLength) {
  const auto rate = Riley1000();
  for (const auto deviation : {Deviation::kAllan, Deviation::kOverlapped}) {
    const AllanPoint point = At(rate, 500, deviation);
    EXPECT_EQ(point.terms, 1);
    EXPECT_NEAR(std::sqrt(point.variance) / 0.00215816570366181893, 1, 1e-12);
  }
  EXPECT_EQ(At(rate, 501, Deviation::kOverlapped).terms, 0);
}

// Five digits are printed: half a unit of the fifth is 5e-5 of 1.0000.
void ExpectStable32(const std::string& table, std::span<const double> rate, Deviation deviation) {
  const auto rows = test::Stable32Table(ReferencePath(table));
  ASSERT_GT(rows.size(), 10u) << table;
  std::vector<std::int64_t> factors;
  for (const auto& row : rows) factors.push_back(row.factor);
  AllanOptions options;
  options.deviation = deviation;
  const auto points = AllanVariance(rate, 1, factors, options).points;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(points[i].terms, rows[i].terms) << table << " m=" << rows[i].factor;
    EXPECT_NEAR(std::sqrt(points[i].variance) / rows[i].sigma, 1, 5e-5)
        << table << " m=" << rows[i].factor;
  }
}

bool Absent(const std::string& name) { return !std::filesystem::exists(ReferencePath(name)); }

TEST(AllanPublished, Stable32OfAnOvenOscillator) {
  if (Absent("ocxo")) GTEST_SKIP() << "no reference data beside the project";
  auto frequency = test::NumbersOf(ReferencePath("ocxo/ocxo_frequency.txt"));
  for (double& f : frequency) f /= 1e7;
  ExpectStable32("ocxo/stable32_adev_alltau.txt", frequency, Deviation::kAllan);
  ExpectStable32("ocxo/stable32_oadev_alltau.txt", frequency, Deviation::kOverlapped);
}

TEST(AllanPublished, Stable32OfACaesiumClock) {
  if (Absent("cs5071a")) GTEST_SKIP() << "no reference data beside the project";
  const std::string command = "zcat '" + ReferencePath("cs5071a/5071A_phase.txt.gz") + "'";
  std::FILE* pipe = popen(command.c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  std::string text;
  std::array<char, 65536> buffer{};
  while (const auto n = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
    text.append(buffer.data(), n);
  }
  ASSERT_EQ(pclose(pipe), 0);
  std::istringstream in(text);
  std::vector<double> phase = test::Numbers(in);
  ASSERT_EQ(phase.size(), 556990u);
  std::adjacent_difference(phase.begin(), phase.end(), phase.begin());
  const std::span<const double> rate(phase.data() + 1, phase.size() - 1);
  ExpectStable32("cs5071a/adev_all.txt", rate, Deviation::kAllan);
  ExpectStable32("cs5071a/adev_decade.txt", rate, Deviation::kAllan);
  ExpectStable32("cs5071a/oadev_all.txt", rate, Deviation::kOverlapped);
  ExpectStable32("cs5071a/oadev_decade.txt", rate, Deviation::kOverlapped);
  ExpectStable32("cs5071a/mdev_decade.txt", rate, Deviation::kModified);
}

TEST(AllanPublished, ExactIntegerSumsOfAMemsGyro) {
  if (Absent("mems_gyro2x_mit")) GTEST_SKIP() << "no reference data beside the project";
  const auto counts = test::CountsOf(ReferencePath("mems_gyro2x_mit/gyro2_x_counts_i16le.bin"));
  std::ifstream table(ReferencePath("mems_gyro2x_mit/expected_oavar.csv"));
  std::string line;
  std::getline(table, line);
  int rows = 0;
  const auto points = AllanVariance(counts, 0.01, OctaveFactors(238256)).points;
  for (; std::getline(table, line); ++rows) {
    long long m = 0;
    long long terms = 0;
    long long squares = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lld,%lld,%lld", &m, &terms, &squares), 3);
    const AllanPoint& point = points.at(static_cast<std::size_t>(rows));
    ASSERT_EQ(point.factor, m);
    EXPECT_EQ(point.terms, terms);
    const long double exact = static_cast<long double>(squares) /
                              (2.L * static_cast<long double>(m) * static_cast<long double>(m) *
                               static_cast<long double>(terms));
    EXPECT_NEAR(point.variance / static_cast<double>(exact), 1, 1e-12) << m;
  }
  EXPECT_EQ(rows, 17);
}

}  // namespace
}  // namespace wellgyro
