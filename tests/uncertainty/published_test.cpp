#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include <gtest/gtest.h>

#include "wellgyro/uncertainty/propagate.h"

#include "cases.h"

namespace wellgyro {
namespace {

using test::CaseValues;
using test::CaseWell;
using test::StandardWell;

constexpr const char* kModelNames[] = {"NN", "NE", "NV", "EE", "EV", "VV"};

double Element(const Eigen::Matrix3d& c, int i) {
  constexpr int kRow[] = {0, 0, 0, 1, 1, 2};
  constexpr int kColumn[] = {0, 1, 2, 1, 2, 2};
  return c(kRow[i], kColumn[i]);
}

// The one number of the paper that is not met; its reason stands in the case file.
bool IsException(int well, int model, double md, int element) {
  return well == 3 && model == 1 && md == 3000 && element == 0;
}

class AppendixE : public testing::TestWithParam<std::tuple<int, int>> {};

// SPE 90408, Appendix E: "within 1 %, or within 2 units below 200".
TEST_P(AppendixE, EveryPublishedNumber) {
  const auto [number, example] = GetParam();
  const CaseWell well = StandardWell(number, "spe90408-appendix-e.txt");
  const ErrorModel model = test::Model("spe90408-" + std::to_string(example));
  const PositionUncertainty result = PropagateErrors(well.survey, well.place, model);
  int seen = 0;
  for (const auto& words : CaseValues("spe90408-appendix-e.txt")) {
    if (std::stoi(words.at(0)) != number || std::stoi(words.at(1)) != example) continue;
    const double md = std::stod(words.at(2));
    const std::size_t k = well.StationAt(md);
    ASSERT_LT(k, result.cov_p_W.size()) << result.refusal->text;
    for (int i = 0; i < 6; ++i, ++seen) {
      const double published = std::stod(words.at(static_cast<std::size_t>(3 + i)));
      const double ours = Element(result.cov_p_W[k], i) / (well.unit * well.unit);
      const double tolerance = std::abs(published) < 200 ? 2 : 0.01 * std::abs(published);
      if (IsException(number, example, md, i)) {
        EXPECT_NEAR(ours, 123.0, 0.1);  // published 118: an exception once met is none
        continue;
      }
      EXPECT_NEAR(ours, published, tolerance) << "MD " << md << " " << kModelNames[i];
    }
  }
  EXPECT_GE(seen, 18);
}

INSTANTIATE_TEST_SUITE_P(AllWells, AppendixE,
                         testing::Combine(testing::Values(1, 2, 3), testing::Range(1, 7)),
                         [](const auto& p) {
                           return "Well" + std::to_string(std::get<0>(p.param)) + "Model" +
                                  std::to_string(std::get<1>(p.param));
                         });

// Where the paper leaves its table empty the tool does not work, and neither may the engine.
TEST(AppendixERefusals, TwoAxisToolsEndBeforeHorizontal) {
  for (const auto& [number, md] : {std::pair(1, 5400.0), std::pair(3, 3030.0)}) {
    const CaseWell well = StandardWell(number, "spe90408-appendix-e.txt");
    for (const int example : {1, 2}) {
      const auto result = PropagateErrors(well.survey, well.place,
                                          test::Model("spe90408-" + std::to_string(example)));
      ASSERT_TRUE(result.refusal) << number << " " << example;
      EXPECT_EQ(result.refusal->station, well.StationAt(md));
      EXPECT_EQ(result.cov_p_W.size(), result.refusal->station);
    }
  }
}

using Sources = std::map<std::string, Eigen::Matrix3d>;

Sources AtStation(const PositionUncertainty& result, std::size_t k) {
  Sources sources;
  for (const auto& term : result.terms) sources[term.term] = term.cov_p_W[k];
  sources["TOTAL"] = result.cov_p_W[k];
  return sources;
}

class MwdRev51 : public testing::TestWithParam<int> {};

// The 35 sources and their total, to the four decimals that are published: half a unit of the last
// one, and what the wells' printed TVD to 0.01 m moves in DSTG and so in the total.
TEST_P(MwdRev51, EverySourceAtTotalDepth) {
  const int number = GetParam();
  const CaseWell well = StandardWell(number, "iscwsa-mwd-rev5.1.txt");
  PropagateOptions options;
  options.terms = true;
  const auto result =
      PropagateErrors(well.survey, well.place, test::Model("ISCWSA-MWD-Rev5.1"), options);
  ASSERT_FALSE(result.refusal);
  ASSERT_EQ(result.terms.size(), 35u);
  Sources sources = AtStation(result, well.survey.size() - 1);
  int seen = 0;
  for (const auto& words : CaseValues("iscwsa-mwd-rev5.1.txt")) {
    if (std::stoi(words.at(0)) != number) continue;
    ASSERT_TRUE(sources.contains(words.at(1))) << words.at(1);
    const Eigen::Matrix3d& c = sources[words.at(1)];
    const double ours[] = {c(0, 0), c(1, 1), c(2, 2), c(0, 1), c(0, 2), c(1, 2)};
    const bool total = words.at(1) == "TOTAL" || words.at(1) == "DSTG";
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_NEAR(ours[i], std::stod(words.at(2 + i)), total ? 1.5e-4 : 0.51e-4) << words.at(1);
    ++seen;
  }
  EXPECT_EQ(seen, 36);
}

// The workbook's own sheet, 16 digits, at four depths of wells 1 and 3.
// Rev 4, where the tie-on is single and XYM3 and XYM4 are systematic: 27 sources, four decimals.
TEST(MwdRev4, EverySourceAtTwoDepths) {
  const CaseWell well = StandardWell(1, "iscwsa-mwd-rev4.txt");
  PropagateOptions options;
  options.terms = true;
  const auto result =
      PropagateErrors(well.survey, well.place, test::Model("ISCWSA-MWD-Rev4"), options);
  ASSERT_EQ(result.terms.size(), 27u);
  int seen = 0;
  for (const auto& words : CaseValues("iscwsa-mwd-rev4.txt")) {
    const Sources sources = AtStation(result, well.StationAt(std::stod(words.at(1))));
    ASSERT_TRUE(sources.contains(words.at(2))) << words.at(2);
    const Eigen::Matrix3d& c = sources.at(words.at(2));
    const double ours[] = {c(0, 0), c(1, 1), c(2, 2), c(0, 1), c(0, 2), c(1, 2)};
    const bool total = words.at(2) == "TOTAL" || words.at(2) == "DSTG";
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_NEAR(ours[i], std::stod(words.at(3 + i)), total ? 1.5e-4 : 0.51e-4)
          << words.at(1) << " " << words.at(2);
    }
    ++seen;
  }
  EXPECT_EQ(seen, 56);
}

class MwdRev51Workbook : public testing::TestWithParam<int> {};

TEST_P(MwdRev51Workbook, EverySourceAtEveryDepth) {
  const int number = GetParam();
  const std::string path = std::string(WELLGYRO_REFERENCE_DIR) + "/error-model/mwdrev5-1-iscwsa-" +
                           std::to_string(number) + "_validation.csv";
  std::ifstream file(path);
  if (!file) GTEST_SKIP() << "no " << path;
  const CaseWell well = StandardWell(number, "iscwsa-mwd-rev5.1.txt");
  PropagateOptions options;
  options.terms = true;
  const auto result =
      PropagateErrors(well.survey, well.place, test::Model("ISCWSA-MWD-Rev5.1"), options);
  std::string line;
  std::getline(file, line);
  int seen = 0;
  while (std::getline(file, line)) {
    std::istringstream stream(line);
    std::vector<std::string> cells;
    for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
    if (cells.size() < 14) continue;
    Sources sources = AtStation(result, well.StationAt(std::stod(cells[0])));
    const Eigen::Matrix3d& c = sources.at(cells[1]);
    const double ours[] = {c(0, 0), c(1, 1), c(2, 2), c(0, 1), c(0, 2), c(1, 2)};
    for (std::size_t i = 0; i < 6; ++i) {
      const double sheet = std::stod(cells[8 + i]);
      EXPECT_NEAR(ours[i], sheet, 1e-4 + 1e-6 * std::abs(sheet)) << cells[0] << " " << cells[1];
    }
    ++seen;
  }
  EXPECT_GE(seen, 100);
}

INSTANTIATE_TEST_SUITE_P(Wells, MwdRev51, testing::Values(1, 2, 3));
INSTANTIATE_TEST_SUITE_P(Wells, MwdRev51Workbook, testing::Values(1, 3));

}  // namespace
}  // namespace wellgyro
