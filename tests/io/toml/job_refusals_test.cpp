#include <algorithm>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "wellgyro/io/toml/job_file.h"

#include "io/toml/whole_job.h"

namespace wellgyro {
namespace {

using test::kWholeJob;
using test::ParsedJob;
using testing::HasSubstr;

// Every "key = value" line of kWholeJob with its number, from 1.
std::vector<std::pair<int, std::string>> KeyLines() {
  std::vector<std::pair<int, std::string>> lines;
  std::istringstream text{std::string(kWholeJob)};
  std::string line;
  for (int number = 1; std::getline(text, line); ++number) {
    if (line.find(" = ") != std::string::npos) lines.emplace_back(number, line);
  }
  return lines;
}

std::string WithLine(int wanted, const std::string& replacement) {
  std::istringstream text{std::string(kWholeJob)};
  std::string line, all;
  for (int number = 1; std::getline(text, line); ++number) {
    all += (number == wanted ? replacement : line) + "\n";
  }
  return all;
}

TEST(ReadJob, AnUnknownKeyIsAnErrorWithItsLine) {
  for (const auto& [number, line] : KeyLines()) {
    if (number >= 8 && number <= 10) continue;  // identity: keys are free
    const std::string key = line.substr(0, line.find(' '));
    const auto file = ParsedJob(WithLine(number, key + "_x" + line.substr(key.size())));
    ASSERT_FALSE(file) << line;
    // The first line may be missing altogether, but a format line always stands at the head.
    EXPECT_EQ(file.fault().line, number) << line << ": " << file.fault().text;
    if (number > 1) {
      EXPECT_THAT(file.fault().text, HasSubstr(key + "_x")) << line;
    }
    EXPECT_EQ(file.fault().source, "a/job.toml");
  }
}

TEST(ReadJob, AWrongTypeIsAnErrorWithItsLine) {
  for (const auto& [number, line] : KeyLines()) {
    const std::string key = line.substr(0, line.find(' '));
    const bool identity = number >= 8 && number <= 10;
    const bool text = line.find('"') != std::string::npos;
    for (const char* value : {"{}", "[1, 'x']", "1979-05-27", "true", "'word'", "nan", "-inf"}) {
      if (identity && value[0] != '{' && value[0] != '[') continue;
      if (value[0] == '\'' && text) continue;
      if (value[0] == 't' && (key == "use_fixes" || key == "at_stops" || key == "tie")) continue;
      const auto file = ParsedJob(WithLine(number, key + " = " + value));
      ASSERT_FALSE(file) << key << " = " << value;
      EXPECT_EQ(file.fault().line, number) << key << " = " << value << ": " << file.fault().text;
    }
  }
}

TEST(ReadJob, OutOfRangeIsAnErrorWithItsLineAndValue) {
  const std::vector<std::pair<std::string, std::vector<const char*>>> odd{
      {"format", {"'wellgyro.job/2'", "'wellgyro.noise/1'"}},
      {"latitude_deg", {"90", "-91", "1e9"}},
      {"longitude_deg", {"-180.5", "361"}},
      {"datum_elevation_m", {"-2e4", "1e5"}},
      {"projection", {"'mercator'"}},
      {"semi_major_m", {"0", "-6e6", "1e99"}},
      {"inverse_flattening", {"0", "-1"}},
      {"latitude_origin_deg", {"91"}},
      {"parallel_1_deg", {"91"}},
      {"scale_origin", {"0", "-1", "3"}},
      {"scale", {"0", "-1", "3"}},
      {"convergence_deg", {"181"}},
      {"inclination_deg", {"-0.1", "180.5"}},
      {"azimuth_true_deg", {"361", "-361"}},
      {"covariance_m2",
       {"[[1,0,0],[0,1,0]]", "[[1,0],[0,1]]", "[[1,2,0],[2,1,0],[0,0,1]]",
        "[[1,0.5,0],[0,1,0],[0,0,1]]", "[1,2,3]"}},
      {"quantization_arcsec", {"-1", "1e300"}},
      {"bias_instability_correlation_time_h", {"0", "-1"}},
      {"gyro_bias_sigma_deg_per_h", {"-1"}},
      {"latitude_sigma_deg", {"-1"}},
      {"raw", {"''"}},
      {"status", {"'A'"}},
      {"method", {"'magnetic'", "'External'"}},
      {"of", {"'hole'"}},
      {"sigma_azimuth_deg", {"0", "-1"}},
      {"min_still_s", {"0", "-60"}},
      {"order", {"'first'", "'Third'"}},
      {"every_m", {"-1"}},
      {"at_m", {"[2.0, 1.0]", "[1.0, 1.0]", "[1.0, 1e300]"}},
      {"kind", {"'rope'", "''"}},
      {"latency_s", {"-1", "1e6"}},
      {"corrections", {"[[1, 0], [1, 0]]", "[[1, 0, 0]]", "[1, 0]", "[[1, 20000]]"}},
      {"sag_deg", {"91"}},
      {"sag_sigma_deg", {"-1"}},
      {"gravity_mps2", {"0", "-1"}},
      {"number", {"0", "-1", "1.5", "3000000000"}},
      {"end_utime_us", {"1767225600000000", "-1", "9223372036854775807"}},
      {"verdict", {"'bad'", "'OK'"}},
      {"event", {"'zero'", "'Remark'"}},
      {"run", {"-1"}},
      {"value_m", {"1e300"}},
      {"sigma_m", {"-1", "1e300"}}};
  for (const auto& [key, values] : odd) {
    const auto lines = KeyLines();
    const auto line = std::find_if(lines.begin(), lines.end(), [&, k = key](const auto& l) {
      // A channel bears the name of the event's key.
      return l.second.starts_with(k + " ") && l.second != "event = \"G\"";
    });
    ASSERT_NE(line, lines.end()) << key;
    for (const char* value : values) {
      const auto file = ParsedJob(WithLine(line->first, key + " = " + value));
      ASSERT_FALSE(file) << key << " = " << value;
      EXPECT_EQ(file.fault().line, line->first) << key << " = " << value << file.fault().text;
    }
  }
}

TEST(ReadJob, SaysWhichKeyWasMeant) {
  const auto file =
      ParsedJob("format = \"wellgyro.job/1\"\n[well]\nlattitude_deg = 60\nname = 'x'\n");
  ASSERT_FALSE(file);
  EXPECT_EQ(file.fault().text,
            "'lattitude_deg' is not a key that belongs here; is 'latitude_deg' meant?");
  EXPECT_EQ(file.fault().line, 3);
  EXPECT_EQ(file.fault().column, 1);
}

std::string FaultOf(const std::string& text) {
  const auto file = ParsedJob("format = \"wellgyro.job/1\"\n" + text);
  return file ? "accepted" : file.fault().text;
}

TEST(ReadJob, KeysThatContradictEachOtherAreRefused) {
  const std::string well = "well = {latitude_deg = 60, longitude_deg = 3}\n";
  EXPECT_EQ(FaultOf(well), "accepted");
  EXPECT_THAT(FaultOf(""), HasSubstr("well: is missing"));
  EXPECT_THAT(FaultOf(well + "tie_in.inclination_deg = 1"), HasSubstr("is missing beside"));
  EXPECT_THAT(FaultOf(well + "tie_in.azimuth_true_deg = 1"), HasSubstr("is missing beside"));
  EXPECT_THAT(FaultOf(well + "grid = {utm_zone = '31N', projection = 'transverse_mercator'}"),
              HasSubstr("only one of them"));
  EXPECT_THAT(FaultOf(well + "grid.utm_zone = '61N'"), HasSubstr("61N"));
  EXPECT_THAT(FaultOf(well + "grid.utm_zone = '1N'"), HasSubstr("well head"));
  EXPECT_THAT(FaultOf("well.latitude_deg = 60\ngrid.utm_zone = '31N'"), HasSubstr("longitude_deg"));
  EXPECT_THAT(FaultOf(well + "alignment = {method = 'gyrocompass', azimuth_true_deg = 1}"),
              HasSubstr("azimuth_true_deg"));
  EXPECT_THAT(FaultOf(well + "alignment = {method = 'external', azimuth_true_deg = 1}"),
              HasSubstr("sigma_azimuth_deg: is missing"));
  EXPECT_THAT(FaultOf(well + "alignment = {method = 'external', azimuth_true_deg = 1, "
                             "sigma_azimuth_deg = 1, at_md_m = 1, at_utime_us = 1}"),
              HasSubstr("at_utime_us"));
  EXPECT_THAT(FaultOf(well + "run = [{number = 1}, {number = 1}]"), HasSubstr("twice"));
  EXPECT_THAT(FaultOf(well + "event = [{utime_us = 1}]"), HasSubstr("event: is missing"));
  EXPECT_THAT(FaultOf(well + "event = [{event = 'remark'}]"), HasSubstr("utime_us: is missing"));
  EXPECT_THAT(FaultOf(well + "noise.rate_ramp_deg_per_h2_sigma = 1"),
              HasSubstr("while its sigma is there"));
  EXPECT_THAT(
      FaultOf(well + "noise = {rate_ramp_deg_per_h2 = 1, rate_ramp_deg_per_h2_upper95 = 1}"),
      HasSubstr("stands alone"));
}

TEST(ReadJob, AnEventWithoutTheValueOfItsKindIsAnErrorWithItsLine) {
  struct Without {
    std::string event, key;
  };
  for (const auto& [event, key] : {Without{"event = 'foresight'", "value_rad"},
                                   Without{"event = 'foresight'\nvalue_m = 1", "value_rad"},
                                   Without{"event = 'depth_rezero'", "value_m"},
                                   Without{"event = 'depth_tie'\nvalue_rad = 1", "value_m"}}) {
    const auto file =
        ParsedJob("format = \"wellgyro.job/1\"\nwell.latitude_deg = 60\n[[event]]\nutime_us = 1\n" +
                  event + "\n");
    ASSERT_FALSE(file) << event;
    EXPECT_EQ(file.fault().line, 3) << event;
    EXPECT_THAT(file.fault().text, HasSubstr(key + ": is missing")) << event;
  }
  for (const char* event : {"depth_zero", "return_to_zero", "accept", "run_end", "remark"}) {
    EXPECT_EQ(FaultOf(std::string("well.latitude_deg = 60\nevent = [{utime_us = 1, event = '") +
                      event + "'}]"),
              "accepted");
  }
}

TEST(ReadJob, WhatIsNotTomlIsRefusedWithItsPlace) {
  const auto file = ParsedJob("format = \"wellgyro.job/1\"\n[well\n");
  ASSERT_FALSE(file);
  EXPECT_EQ(file.fault().code, FaultCode::kSyntax);
  EXPECT_EQ(file.fault().line, 2);
  EXPECT_EQ(ParsedJob("").fault().code, FaultCode::kForeign);
  EXPECT_FALSE(ParsedJob("MD,INC,AZI\n1,2,3\n"));
  EXPECT_FALSE(ParsedJob(std::string("format = \"wellgyro.job/1\"\n\x00\xff\xfe", 30)));
  EXPECT_FALSE(ParsedJob("format = " + std::string(100'000, '[')));
  EXPECT_EQ(ReadJob("no/such/job.toml").fault().code, FaultCode::kIo);
}

TEST(ReadJob, EveryPrefixIsRightOrRefused) {
  int accepted = 0;
  for (std::size_t n = 0; n < kWholeJob.size(); n += 3) {
    if (ParsedJob(kWholeJob.substr(0, n))) ++accepted;
  }
  EXPECT_GT(accepted, 0);
}

}  // namespace
}  // namespace wellgyro
