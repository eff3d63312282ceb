#pragma once

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/fit/tool_fit.h"

#include "fit/tool_bench.h"

/// What a fit of a whole tool's bench says in words.
namespace wellgyro::test {

inline ToolFitSetup AtLatitude(double degrees) {
  ToolFitSetup setup;
  setup.reference.latitude = degrees * kRad;
  return setup;
}

/// The first remark with these words; empty: there is none.
inline std::string RemarkOf(const FitReport& report, const std::string& words) {
  const auto has = [&](const std::string& remark) {
    return remark.find(words) != std::string::npos;
  };
  const auto found = std::find_if(report.remarks.begin(), report.remarks.end(), has);
  return found == report.remarks.end() ? std::string() : *found;
}

inline std::string RemarkOf(const std::vector<BenchTable>& tables, const std::string& words) {
  const auto fit = FitTool(tables, AtLatitude(60));
  EXPECT_TRUE(fit.has_value()) << fit.fault().text;
  return fit ? RemarkOf(fit->calibration.report, words) : std::string();
}

inline bool Says(const FitReport& report, const std::string& words) {
  return !RemarkOf(report, words).empty();
}

/// A tool of one rotor, by positions and a rate table, with or without a chamber.
inline std::vector<BenchTable> SmallBench(bool chamber, Random& random) {
  ThermalTool tool = ThermalTool::Any(random);
  if (!chamber) tool.heating.setZero();
  const ThermalBench bench = ThermalBench::Any(random);
  const double hot = chamber ? 150 : 25.1;
  std::vector<BenchTable> tables = {ThermalPositions(tool, bench, 0, 84, 25, hot, random)};
  if (chamber) tables.push_back(ThermalPositions(tool, bench, 1, 84, hot, 25, random));
  tables.push_back(ThermalRates(tool, bench, 25, random));
  for (BenchTable& table : tables) table = WithoutColumns(table, {"m_z2", "m_x2"});
  return tables;
}

/// Of sound benches one in a hundred may be told of it: more than four have 0.4 % of chance.
inline void ExpectRarelyTold(const std::string& words, bool hundred, Random& random) {
  int told = 0;
  for (int bench = 0; bench < (hundred ? 100 : 3); ++bench) {
    told += RemarkOf(SmallBench(true, random), words).empty() ? 0 : 1;
  }
  std::printf("sound benches told \"%s\": %d\n", words.c_str(), told);
  EXPECT_LE(told, hundred ? 4 : 0) << words;
}

}  // namespace wellgyro::test
