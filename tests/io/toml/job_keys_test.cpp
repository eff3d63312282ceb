#include "wellgyro/survey/job_keys.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "wellgyro/io/toml/job_file.h"
#include "wellgyro/io/toml/job_sections_internal.h"
#include "wellgyro/survey/job_words.h"

namespace wellgyro {
namespace {

using testing::HasSubstr;

const std::string kHead = "format = \"wellgyro.job/1\"\n";
const std::string kWell = "well = {latitude_deg = 60, longitude_deg = 4}\n";

// Jobs that between them come through every branch of the reader.
std::vector<std::string> Jobs() {
  return {
      kHead + kWell +
          "grid = {projection = 'lambert_conformal_conic', parallel_1_deg = 58}\n"
          "tie_in = {}\nnoise = {}\nerrors = {}\nchannels = {}\nattitude = {}\nstations = {}\n"
          "alignment = {method = 'external', azimuth_true_deg = 1, sigma_azimuth_deg = 1}\n"
          "depth.cable = {}\nstring = {}\nacceptance = {}\n"
          "magnetic = {declination_deg = 1, sigma_deg = 1}\nrun = [{number = 1}]\n"
          "operations = {}\noperator = [{name = 'a', public_key = '" +
          std::string(64, '0') +
          "'}]\n"
          "event = [{utime_us = 1, event = 'remark'}]\n",
      kHead + kWell + "grid = {projection = 'polar_stereographic', pole = 'north'}\n",
      kHead + kWell + "[tool]\n",
      kHead + kWell + "[error_model]\n",
  };
}

std::string NameOf(const JobKey& key) {
  return std::string(key.table) + "." + std::string(key.key);
}

bool IsCompanion(const std::string& name, const std::set<std::string>& listed) {
  for (const std::string ending : {"_sigma", "_upper95"}) {
    if (name.starts_with("noise.") && name.ends_with(ending) &&
        listed.contains(name.substr(0, name.size() - ending.size()))) {
      return true;
    }
  }
  return false;
}

TEST(JobKeys, AreAllThatTheReaderAsksFor) {
  std::set<std::string> listed, tables{"identity"}, asked;
  for (const JobKey& key : JobKeys()) {
    EXPECT_TRUE(listed.insert(NameOf(key)).second) << NameOf(key) << " stands twice";
    EXPECT_FALSE(key.meaning.empty()) << NameOf(key) << " says nothing";
    const std::string table(key.table);
    tables.insert(table);
    tables.insert(table.substr(0, table.find('.')));
  }
  for (const std::string& job : Jobs()) {
    for (const std::string& name : KeysAskedOfJob(job, ".")) {
      if (!tables.contains(name) && !IsCompanion(name, listed)) asked.insert(name);
    }
  }
  EXPECT_THAT(asked, testing::ContainerEq(listed))
      << "survey/job_keys.cpp lists every key of a job, and no other";
}

// A choice is read as its word's place, and written by it.
TEST(JobKeys, WordsStandInTheOrderOfTheirEnumerators) {
  const auto at = [](const auto& words, auto value) {
    return words.at(static_cast<std::size_t>(value));
  };
  using Projection = GridSpec::Projection;
  EXPECT_EQ(at(words::kProjection, Projection::kTransverseMercator), "transverse_mercator");
  EXPECT_EQ(at(words::kProjection, Projection::kPolarStereographic), "polar_stereographic");
  EXPECT_EQ(at(words::kPole, true), "north");
  EXPECT_EQ(at(words::kAlignment, AlignmentSpec::Method::kExternal), "external");
  EXPECT_EQ(at(words::kAzimuthOf, AlignmentSpec::Of::kMark), "mark");
  EXPECT_EQ(at(words::kOrder, AttitudeSpec::Order::kThird), "third");
  EXPECT_EQ(at(words::kDepthKind, DepthKind::kDrillPipe), "drill_pipe");
  EXPECT_EQ(at(words::kDepthKind, DepthKind::kOther), "other");
  EXPECT_EQ(at(words::kRunVerdict, true), "misrun");
  EXPECT_EQ(at(words::kEvent, Event::Kind::kDepthZero), "depth_zero");
  EXPECT_EQ(at(words::kEvent, Event::Kind::kRemark), "remark");
}

// What a choice, a switch or a channel is where the file does not say.
TEST(JobKeys, AbsentWordsAreThoseOfAJob) {
  const Job job;
  const auto word = [](const auto& words, auto value) {
    return words.at(static_cast<std::size_t>(value));
  };
  const auto is = [](bool value) { return value ? "true" : "false"; };
  EXPECT_EQ(JobKeyOf("alignment", "method").absent, word(words::kAlignment, job.alignment.method));
  EXPECT_EQ(JobKeyOf("alignment", "of").absent, word(words::kAzimuthOf, job.alignment.of));
  EXPECT_EQ(JobKeyOf("alignment", "use_fixes").absent, is(job.alignment.use_fixes));
  EXPECT_EQ(JobKeyOf("attitude", "order").absent, word(words::kOrder, job.attitude.order));
  EXPECT_EQ(JobKeyOf("stations", "at_stops").absent, is(job.stations.at_stops));
  EXPECT_EQ(JobKeyOf("depth", "kind").absent, word(words::kDepthKind, job.depth.kind));
  EXPECT_EQ(JobKeyOf("magnetic", "tie").absent, is(MagneticSpec{}.tie));
  EXPECT_EQ(JobKeyOf("operations", "unsigned_tool").absent, is(OperationSpec{}.unsigned_tool));
  EXPECT_EQ(JobKeyOf("run", "verdict").absent, word(words::kRunVerdict, RunSpec{}.misrun));
  for (const JobKey& key : JobKeys()) {
    if (key.channel != nullptr) EXPECT_EQ(key.absent, Channels{}.*key.channel) << NameOf(key);
  }
}

// `value` of `key` alone in a job that has what else it needs; `line` gets its place.
std::string JobWith(const JobKey& key, double value, int& line) {
  std::string text = kHead;
  const std::string table(key.table), name(key.key);
  const auto add = [&](const std::string& each) {
    if (!each.starts_with(name + " ")) text += each + "\n";
  };
  if (table != "well") text += kWell;
  text += (table == "event" || table == "run") ? "[[" + table + "]]\n" : "[" + table + "]\n";
  if (table == "well") add("latitude_deg = 60"), add("longitude_deg = 4");
  if (table == "alignment") {
    add("method = 'external'"), add("azimuth_true_deg = 1"), add("sigma_azimuth_deg = 1");
  }
  if (table == "magnetic") add("declination_deg = 1"), add("sigma_deg = 1");
  if (table == "grid") add("projection = 'lambert_conformal_conic'"), add("parallel_1_deg = 58");
  if (table == "tie_in" && name == "md_m") add("tvd_m = 1");
  if (table == "tie_in" && name == "inclination_deg") add("azimuth_true_deg = 1");
  if (table == "tie_in" && name == "azimuth_true_deg") add("inclination_deg = 1");
  if (table == "run") add("number = 1");
  if (table == "event") add("utime_us = 1"), add("event = 'remark'");
  line = 1 + static_cast<int>(std::count(text.begin(), text.end(), '\n'));
  char number[40];
  std::snprintf(number, sizeof number, key.type == "number" ? "%.17g" : "%.0f", value);
  return text + name + " = " + number + "\n";
}

TEST(JobKeys, ANumberOutOfItsRangeIsRefusedWithItsLineAndInAProgramAlike) {
  for (const JobKey& key : JobKeys()) {
    if (key.type != "number" && key.type != "whole number") continue;
    for (const double end : {key.range.min, key.range.max}) {
      ASSERT_TRUE(std::isfinite(end)) << NameOf(key) << " has no limit";
      // Of whole numbers above 2^53 the neighbour is another double only some way off.
      const double step = key.type == "number" ? 1e-3 * (1 + std::abs(end)) : 1 + 1e-15 * end;
      const double beyond = end == key.range.min ? end - step : end + step;
      int line = 0;
      const std::string text = JobWith(key, beyond, line);
      const auto file = ParseJob(text, "job.toml", ".");
      ASSERT_FALSE(file) << text;
      EXPECT_EQ(file.fault().line, line) << text << file.fault().text;
      EXPECT_THAT(file.fault().text, HasSubstr(std::string(key.key)));
      if (!key.make) continue;
      Job job;
      if (key.table == "alignment") {
        job.alignment.method = AlignmentSpec::Method::kExternal;
        job.alignment.sigma_azimuth = 0.01;
      }
      if (key.table == "magnetic") job.magnetic = MagneticSpec{.sigma = 0.01};
      EXPECT_NO_THROW(CheckJob(job)) << NameOf(key);
      *key.make(job) = beyond * key.unit;
      EXPECT_THROW(CheckJob(job), std::invalid_argument) << NameOf(key) << " = " << beyond;
    }
  }
}

TEST(JobKeys, TheEndsOfEveryRangeAreTakenInTheKeysUnit) {
  for (const JobKey& key : JobKeys()) {
    if (!key.make || key.table == "grid") continue;  // a grid has to hold the well head too
    for (const double end : {key.range.min, key.range.max, 1.0}) {
      if (ComplaintOf(end, key.range)) continue;
      int line = 0;
      const std::string text = JobWith(key, end, line);
      const auto file = ParseJob(text, "job.toml", ".");
      ASSERT_TRUE(file) << text << file.fault().text;
      const double* const value = key.find(file->job);
      ASSERT_NE(value, nullptr) << text;
      const double turn = key.key == "azimuth_true_deg" ? 360 : 0;  // azimuths are wrapped
      const double found = *value / key.unit;
      EXPECT_NEAR(turn > 0 ? std::remainder(found - end, turn) : found - end, 0,
                  1e-9 * (1 + std::abs(end)))
          << text;
      EXPECT_FALSE(FindNumberComplaint(file->job)) << text;
    }
  }
}

TEST(JobKeys, TheReferenceInTheDocumentationIsThisOne) {
  std::ifstream file(std::string(WELLGYRO_DATA_DIR) + "/../lib/docs/job-keys.md");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::size_t begin = text.find("\n## [well]");
  ASSERT_NE(begin, std::string::npos) << "no lib/docs/job-keys.md";
  EXPECT_EQ(text.substr(begin), JobReference())
      << "make it anew: wellgyro check --job-keys > lib/docs/job-keys.md";
}

}  // namespace
}  // namespace wellgyro
