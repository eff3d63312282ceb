// A job's limits hold alike in a file and in a program: each value is tried both ways.
#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/toml/job_file.h"
#include "wellgyro/record/limits.h"

namespace wellgyro {
namespace {

using testing::HasSubstr;

const std::string kWellAlone =
    "format = 'wellgyro.job/1'\nwell = {latitude_deg = 60, longitude_deg = 4}\n";
constexpr double kInf = std::numeric_limits<double>::infinity();

struct Tried {
  std::string file;  ///< behind kWellAlone; its last line holds the value
  std::function<void(Job&)> change;
  std::string why;  ///< empty: it is taken
};

std::string WhyNotInAFile(const Tried& tried) {
  const std::string text = kWellAlone + tried.file;
  const auto file = ParseJob(text, "job.toml", ".");
  if (file) return "";
  EXPECT_EQ(file.fault().line, 1 + std::count(text.begin(), text.end(), '\n')) << text;
  return file.fault().text;
}

std::string WhyNotInAProgram(const Tried& tried) {
  Job job;
  job.well.latitude = 60 * units::kDeg;
  job.well.longitude = 4 * units::kDeg;
  tried.change(job);
  try {
    CheckJob(job);
  } catch (const std::invalid_argument& refused) {
    return refused.what();
  }
  return "";
}

void TryBothWays(const std::vector<Tried>& table) {
  for (const Tried& tried : table) {
    const std::string in_file = WhyNotInAFile(tried), in_program = WhyNotInAProgram(tried);
    if (tried.why.empty()) {
      EXPECT_EQ(in_file, "") << tried.file;
      EXPECT_EQ(in_program, "") << tried.file;
    } else {
      EXPECT_THAT(in_file, HasSubstr(tried.why)) << tried.file;
      EXPECT_THAT(in_program, HasSubstr(tried.why)) << tried.file;
    }
  }
}

Tried Stations(const std::string& list, std::vector<double> at, const std::string& why) {
  return {"[stations]\nat_m = " + list,
          [=](Job& job) { job.stations.at = at, job.stations.every = 0; }, why};
}

Tried Corrections(const std::string& list, std::vector<std::pair<double, double>> rows,
                  const std::string& why) {
  return {"[depth]\ncorrections = " + list, [=](Job& job) { job.depth.corrections = rows; }, why};
}

TEST(JobLimits, ListsOfDepths) {
  TryBothWays(
      {Stations("[1, 2]", {1, 2}, ""),
       Stations("[2, 1]", {2, 1}, "1 after 2: depths must increase"),
       Stations("[1, 1]", {1, 1}, "1 after 1: depths must increase"),
       Stations("[100001]", {100'001}, "100001 must be at most 100000"),
       {"[stations]\nevery_m = 0", [](Job& job) { job.stations.every = 0; }, "asks for no station"},
       Corrections("[[-1e5, -1e4], [1e5, 1e4]]", {{-1e5, -1e4}, {1e5, 1e4}}, ""),
       Corrections("[[200000, 1]]", {{200'000, 1}}, "200000 must be at most 100000"),
       Corrections("[[1e300, 1]]", {{1e300, 1}}, "1e+300 must be at most 100000"),
       Corrections("[[1, 10001]]", {{1, 10'001}}, "10001 must be at most 10000"),
       Corrections("[[1, inf]]", {{1, kInf}}, "inf is not a finite number"),
       Corrections("[[2, 0], [1, 0]]", {{2, 0}, {1, 0}}, "1 after 2: depths must")});
}

Tried OfEvent(const std::string& line, std::function<void(Event&)> change, const std::string& why) {
  const bool timed = line.starts_with("utime_us");
  return {std::string("[[event]]\nevent = 'remark'\n") + (timed ? "" : "utime_us = 1\n") + line,
          [=](Job& job) {
            Event& event = job.events.emplace_back();
            event.utc = {1000};
            change(event);
          },
          why};
}

TEST(JobLimits, NumbersOfAnEvent) {
  const std::string below = "must be at least 0", text(limits::kText + 1, 'a');
  TryBothWays(
      {OfEvent(
           "sigma_m = -5", [](Event& e) { e.sigma_m = -5; }, "-5 " + below),
       OfEvent(
           "sigma_rad = -5", [](Event& e) { e.sigma_rad = -5; }, "-5 " + below),
       OfEvent(
           "sigma_m = 1000", [](Event& e) { e.sigma_m = 1000; }, ""),
       OfEvent(
           "value_m = -2e5", [](Event& e) { e.value_m = -2e5; }, "-200000 must be at least"),
       OfEvent(
           "session = -1", [](Event& e) { e.session = -1; }, "-1 " + below),
       OfEvent(
           "run = -1", [](Event& e) { e.run = -1; }, "-1 " + below),
       OfEvent(
           "event_id = -1", [](Event& e) { e.event_id = -1; }, "-1 " + below),
       OfEvent(
           "seq = -1", [](Event& e) { e.seq = -1; }, "-1 " + below),
       OfEvent(
           "seq = 2305843009213693952", [](Event& e) { e.seq = limits::kCount; }, ""),
       OfEvent(
           "seq = 2305843009213693953", [](Event& e) { e.seq = limits::kCount + 1; },
           "2305843009213693953 must be at most 2305843009213693952"),
       OfEvent(
           "text = '" + text + "'", [=](Event& e) { e.text = text; },
           "has 4097 bytes, at most 4096 are allowed")});
}

TEST(JobLimits, TimesFrom1970ToTheLatestThatMessagesHold) {
  const std::string least = "-1 must be at least 0";
  const std::string most = "4000000000000001 must be at most 4000000000000000";
  const UtcTime last{limits::kUtcUs * 1000}, late{last.ns + 1000}, before{-1};
  const std::string external =
      "[alignment]\nmethod = 'external'\nazimuth_true_deg = 1\nsigma_azimuth_deg = 1\n";
  const auto at = [](UtcTime utc) {
    return [utc](Job& job) {
      job.alignment.method = AlignmentSpec::Method::kExternal;
      job.alignment.sigma_azimuth = units::kDeg;
      job.alignment.at_utc = utc;
    };
  };
  const auto run = [](std::optional<UtcTime> begin, std::optional<UtcTime> end) {
    return [=](Job& job) { job.runs = {{.number = 1, .begin = begin, .end = end}}; };
  };
  TryBothWays(
      {OfEvent(
           "utime_us = -1", [=](Event& e) { e.utc = before; }, least),
       OfEvent(
           "utime_us = 4000000000000000", [=](Event& e) { e.utc = last; }, ""),
       OfEvent(
           "utime_us = 4000000000000001", [=](Event& e) { e.utc = late; }, most),
       OfEvent(
           "utime_us = 9223372036854775", [](Event& e) { e.utc = {9223372036854775000}; },
           "9223372036854775 must be at most"),
       {external + "at_utime_us = -1", at(before), least},
       {external + "at_utime_us = 4000000000000001", at(late), most},
       {"[[run]]\nnumber = 1\nbegin_utime_us = -1", run(before, {}), least},
       {"[[run]]\nnumber = 1\nend_utime_us = -1", run({}, before), least},
       {"[[run]]\nnumber = 1\nend_utime_us = 4000000000000001", run({}, late), most},
       {"[[run]]\nnumber = 1\nbegin_utime_us = 4000000000000000\nend_utime_us = 4000000000000000",
        run(last, last), "must be later than begin_utime_us"}});
}

TEST(JobLimits, NumbersOfRuns) {
  const auto runs = [](std::vector<std::int32_t> numbers) {
    return [=](Job& job) {
      for (const std::int32_t number : numbers) job.runs.emplace_back().number = number;
    };
  };
  TryBothWays({{"[[run]]\nnumber = 2147483647", runs({2'147'483'647}), ""},
               {"[[run]]\nnumber = 0", runs({0}), "0 must be at least 1"},
               {"[[run]]\nnumber = 1\n[[run]]\nnumber = 1", runs({1, 1}), "1 stands twice"}});
}

TEST(JobLimits, NamesOfChannels) {
  const auto raw = [](const std::string& name) {
    return Tried{"[channels]\nraw = '" + name + "'", [=](Job& job) { job.channels.raw = name; },
                 ""};
  };
  const auto refused = [&](const std::string& name, const std::string& why) {
    Tried tried = raw(name);
    tried.why = why;
    return tried;
  };
  TryBothWays({raw("A"), raw(std::string(63, 'A')), refused("", "has 0 bytes, 1 to 63 are allowed"),
               refused(std::string(64, 'A'), "has 64 bytes, 1 to 63 are allowed"),
               refused("WELLGYRO_STATUS", "\"WELLGYRO_STATUS\" is the channel of raw and of")});
}

TEST(JobLimits, ATieInThatIsSaidByHalf) {
  const auto tie = [](TieIn tie_in) { return [=](Job& job) { job.tie_in = tie_in; }; };
  TryBothWays({{"[tie_in]\nmd_m = 0", tie({}), ""},
               {"[tie_in]\ntvd_m = 0\nmd_m = 9", tie({.md = 9, .tvd = 0}), ""},
               {"tie_in = {md_m = 9}", tie({.md = 9}), "is missing beside md_m"},
               {"tie_in = {inclination_deg = 0}", tie({.inclination = 0}), "is missing beside"},
               {"tie_in = {azimuth_true_deg = 0}", tie({.azimuth = 0}), "is missing beside"}});
}

TEST(JobLimits, NumbersThatADoubleInSiUnitsDoesNotHold) {
  const std::string grid = "[grid]\nprojection = 'transverse_mercator'\n";
  const auto easting = [](double meters) {
    return [=](Job& job) { job.grid.emplace().false_easting = meters; };
  };
  const std::string external = "[alignment]\nmethod = 'external'\nazimuth_true_deg = 1\n";
  TryBothWays(
      {{"[noise]\nbias_instability_correlation_time_h = 1e305",
        [](Job& job) { job.noise.bias_instability_correlation_time = 1e300; },
        "must be at most 1000000"},
       {"[acceptance]\nazimuth_difference_deg = 1e-323",
        [](Job& job) { job.acceptance.azimuth_difference = 0; }, "must be at least 1e-09"},
       {external + "sigma_azimuth_deg = 1e-323",
        [](Job& job) { job.alignment.method = AlignmentSpec::Method::kExternal; },
        "must be at least 1e-06"},
       {grid + "false_easting_m = 1e8", easting(1e8), ""},
       {grid + "false_easting_m = 1e308", easting(1e308), "1e+308 must be at most 100000000"},
       {grid + "false_northing_m = -1.1e8",
        [](Job& job) { job.grid.emplace().false_northing = -1.1e8; },
        "-110000000 must be at least -100000000"}});
}

}  // namespace
}  // namespace wellgyro
