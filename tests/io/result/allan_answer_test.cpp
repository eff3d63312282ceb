#include "wellgyro/io/result/allan_answer.h"

#include <cmath>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pugixml.hpp>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/random.h"

namespace wellgyro {
namespace {

using testing::HasSubstr;

SampleSeries White(std::size_t samples, double sigma, std::uint64_t seed = 1) {
  Random random(seed);
  SampleSeries series;
  series.period = 0.01;
  series.values.resize(samples);
  for (auto& y : series.values) y = sigma * random.Normal();
  return series;
}

AllanRequest Asking(const std::string& unit) {
  AllanRequest request;
  request.unit = unit;
  request.source = "log <1>";
  request.fit.replicates = 40;
  return request;
}

std::vector<double> SecondColumn(const std::string& table) {
  std::istringstream in(table);
  std::string line;
  std::getline(in, line);
  std::vector<double> column;
  while (std::getline(in, line)) column.push_back(std::stod(line.substr(line.find(',') + 1)));
  return column;
}

TEST(AllanAnswer, ScalesReadingsIntoTheTablesUnit) {
  const auto series = White(4096, 1);
  AllanRequest plain = Asking("rad_per_s");
  plain.unitless = true;
  const auto bare = AnswerAllan(series, plain);
  ASSERT_TRUE(bare);
  EXPECT_THAT(bare->table, testing::StartsWith("tau_s,adev,n,edf,lower95,upper95\n"));
  EXPECT_FALSE(bare->noise);
  const auto degrees = AnswerAllan(series, Asking("deg_per_h"));
  ASSERT_TRUE(degrees);
  EXPECT_THAT(
      degrees->table,
      testing::StartsWith("tau_s,adev_deg_per_h,n,edf,lower95_deg_per_h,upper95_deg_per_h\n"));
  AllanRequest counts = Asking("counts");
  counts.scale = 1e-6;
  const auto counted = AnswerAllan(series, counts);
  const auto acc = AnswerAllan(series, Asking("milli_g"));
  ASSERT_TRUE(counted && acc);
  EXPECT_THAT(acc->table, testing::StartsWith("tau_s,adev_mps2,"));
  EXPECT_THAT(*acc->noise, HasSubstr("velocity_random_walk_mps_per_sqrt_s"));
  const auto a = SecondColumn(bare->table);
  const auto b = SecondColumn(degrees->table);
  const auto c = SecondColumn(counted->table);
  const auto d = SecondColumn(acc->table);
  ASSERT_EQ(a.size(), 12u);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_NEAR(b[i] / a[i], 1, 1e-13);
    EXPECT_NEAR(c[i] / a[i], 1e-6 * 180 / kPi * 3600, 1e-11);
    EXPECT_NEAR(d[i] / a[i], 9.80665e-3, 1e-13);
  }
}

TEST(AllanAnswer, PhasesGiveWhatTheirRatesGive) {
  const auto rates = White(2000, 1);
  SampleSeries phases = rates;
  phases.values.insert(phases.values.begin(), 5);
  for (std::size_t i = 0; i < rates.values.size(); ++i) {
    phases.values[i + 1] = phases.values[i] + rates.values[i] * 0.01;
  }
  AllanRequest request = Asking("rad_per_s");
  const auto a = AnswerAllan(rates, request);
  request.phases = true;
  const auto b = AnswerAllan(phases, request);
  ASSERT_TRUE(a && b);
  const auto x = SecondColumn(a->table);
  const auto y = SecondColumn(b->table);
  ASSERT_EQ(x.size(), y.size());
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(x[i] / y[i], 1, 1e-9);
}

TEST(AllanAnswer, TellsWhatTheLogWasNot) {
  auto series = White(20000, 1);
  series.values[123] = std::nan("");
  series.gaps.push_back({500, 510});
  series.saturated.push_back({700, 701});
  for (std::size_t i = 9000; i < 9200; ++i) series.values[i] += 30;
  const auto answer = AnswerAllan(series, Asking("deg_per_h"));
  ASSERT_TRUE(answer);
  EXPECT_TRUE(answer->losses);
  const std::string notes = testing::PrintToString(answer->notes);
  EXPECT_THAT(notes, HasSubstr("10 samples missing by number: samples 500 to 509 (5 s to 5.1 s)"));
  EXPECT_THAT(notes, HasSubstr("1 sample saturated, as the source says: sample 700 (7 s)"));
  EXPECT_THAT(notes, HasSubstr("1 sample not finite, left out: sample 123 (1.23 s)"));
  EXPECT_THAT(notes, HasSubstr("moved or shook at samples 8"));
  EXPECT_THAT(*answer->noise, HasSubstr("missing = 11\n"));
}

TEST(AllanAnswer, SaysWhyThereIsNoFit) {
  SampleSeries constant;
  constant.period = 1;
  constant.values.assign(100, 3);
  const auto answer = AnswerAllan(constant, Asking("deg_per_h"));
  ASSERT_TRUE(answer);
  EXPECT_TRUE(answer->unfit);
  EXPECT_FALSE(answer->noise);
  EXPECT_THAT(testing::PrintToString(answer->notes), HasSubstr("every sample reads 3"));
  SampleSeries one;
  one.period = 1;
  one.values = {1};
  EXPECT_EQ(AnswerAllan(one, Asking("deg_per_h")).fault().code, FaultCode::kRange);
  EXPECT_THROW(static_cast<void>(AnswerAllan(one, Asking("furlong"))), std::invalid_argument);
  one.period = 0;
  EXPECT_THROW(static_cast<void>(AnswerAllan(one, Asking("deg_per_h"))), std::invalid_argument);
}

TEST(AllanAnswer, DrawsAPictureThatXmlReadersTake) {
  for (const auto deviation : {Deviation::kAllan, Deviation::kOverlapped, Deviation::kModified}) {
    AllanRequest request = Asking("deg_per_h");
    request.plot = true;
    request.deviation = deviation;
    request.taus = AllanRequest::Taus::kDecade;
    const auto answer = AnswerAllan(White(5000, 1), request);
    ASSERT_TRUE(answer);
    pugi::xml_document svg;
    ASSERT_TRUE(svg.load_string(answer->plot.c_str()));
    const std::size_t points =
        svg.select_nodes("//*[local-name()='g']/*[local-name()='circle']").size();
    EXPECT_EQ(points, SecondColumn(answer->table).size());
    EXPECT_THAT(answer->plot, HasSubstr("log &lt;1&gt;"));
    EXPECT_EQ(answer->plot.find("nan"), std::string::npos);
    EXPECT_EQ(answer->plot.find("inf"), std::string::npos);
  }
}

TEST(AllanAnswer, LeavesOutTimesThatDoNotFit) {
  AllanRequest request = Asking("deg_per_h");
  request.taus = AllanRequest::Taus::kList;
  request.tau_list = {0.01, 1, 1e6};
  const auto answer = AnswerAllan(White(5000, 1), request);
  ASSERT_TRUE(answer);
  EXPECT_EQ(SecondColumn(answer->table).size(), 2u);
  EXPECT_THAT(testing::PrintToString(answer->notes), HasSubstr("left out"));
}

}  // namespace
}  // namespace wellgyro
