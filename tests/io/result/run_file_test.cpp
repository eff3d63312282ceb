#include "wellgyro/io/result/run_file.h"

#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <toml++/toml.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/io/sha256.h"
#include "wellgyro/record/run_fit.h"

namespace wellgyro {
namespace {

RunRecord Record() {
  RunRecord record;
  record.program = "wellgyro 0.1.0";
  record.inputs.push_back({.role = "job",
                           .name = "job.toml",
                           .path = "/somewhere/job.toml",
                           .sha256 = "00ff",
                           .text = "a = '''x'''\r\n\"\\ \x01 \xC3\xA9 \xF0\x9F\x9B\xA2\n"});
  record.channels.push_back({"WELLGYRO_IMU", "imu_batch_t", 12, "aa"});
  record.tools.push_back(ToolInfo{});
  record.tools.back().asset_serial = "T\xFF-1";
  record.faults.push_back(
      {.code = FaultCode::kLost, .text = "3 samples", .source = "WELLGYRO_IMU", .offset = 77});
  record.faults.push_back({.code = FaultCode::kLost, .text = "again"});
  return record;
}

Survey SmallSurvey() {
  Survey survey;
  survey.chosen.resize(2);
  survey.passes.resize(3);
  survey.checks.resize(2);
  survey.checks[0].verdict = Verdict::kFail;
  RunSummary run;
  run.run = 1;
  run.misrun = true;
  run.verdict = {Verdict::kWarn, {"3 samples are missing"}};
  survey.verdict = {Verdict::kFail, {"a gyro is dead", "depth is missing"}};
  run.remark = "he said \"stop\"";
  run.samples = 360'000;
  run.samples_lost = 3;
  run.begin.ns = 1'767'225'600'000'000'000;
  NorthFix fix;
  fix.azimuth = -90 * units::kDeg;
  fix.cov_attitude(1, 1) = 0.25 * units::kDeg * units::kDeg;
  fix.earth_rate = 15.04 * units::kDegPerHour;
  fix.md = 1200;
  fix.quality = Quality::kMirror;
  run.fixes.push_back(fix);
  survey.runs.push_back(run);
  return survey;
}

Job SmallJob() {
  Job job;
  job.well.name = "A-1";
  job.well.latitude = 60 * units::kDeg;
  job.identity = {{"uwi", "NO 30/9"}, {"odd key", "\\"}};
  return job;
}

TEST(RunToml, SaysWhatMadeTheBytesAndWhatCameOfIt) {
  const std::vector<OutputFile> outputs{{"survey.csv", "abc"}};
  const toml::table run = toml::parse(RunToml(Record(), SmallJob(), SmallSurvey(), outputs));
  EXPECT_EQ(run["format"].value<std::string>(), "wellgyro.run/1");
  EXPECT_EQ(run["program"].value<std::string>(), "wellgyro 0.1.0");
  EXPECT_EQ(run["accepted"].value<bool>(), false);
  EXPECT_EQ(run["stations"].value<int>(), 2);
  EXPECT_FALSE(run.contains("attitude_order")) << "said only where it is not the usual one";
  EXPECT_EQ(run["identity"]["uwi"].value<std::string>(), "NO 30/9");
  EXPECT_EQ(run["identity"]["odd key"].value<std::string>(), "\\");
  EXPECT_EQ(run["input"][0]["sha256"].value<std::string>(), "00ff");
  EXPECT_EQ(run["input"][0]["text"].value<std::string>(), Record().inputs[0].text);
  EXPECT_EQ(run["channel"][0]["messages"].value<int>(), 12);
  EXPECT_EQ(run["channel"][0]["sha256"].value<std::string>(), "aa");
  EXPECT_EQ(run["tool"][0]["asset_serial"].value<std::string>(), "T\xEF\xBF\xBD-1");
  EXPECT_EQ(run["output"][0]["sha256"].value<std::string>(), Sha256Hex("abc"));
  EXPECT_EQ(run["checks"]["fail"].value<int>(), 1);
  EXPECT_EQ(run["checks"]["not_done"].value<int>(), 1);
  EXPECT_EQ(run["faults"]["lost"].value<int>(), 2);
  EXPECT_EQ(run["fault"][0]["text"].value<std::string>(), "3 samples");
  const auto first = run["run"][0];
  EXPECT_EQ(first["misrun"].value<bool>(), true);
  EXPECT_EQ(first["verdict"].value<std::string>(), "warn");
  EXPECT_EQ(first["causes"][0].value<std::string>(), "3 samples are missing");
  EXPECT_EQ(run["verdict"]["verdict"].value<std::string>(), "fail");
  EXPECT_EQ(run["verdict"]["causes"].as_array()->size(), 2u);
  EXPECT_EQ(run["verdict"]["false_alarm_rate"].value<double>(), 0.01);
  EXPECT_EQ(first["remark"].value<std::string>(), "he said \"stop\"");
  EXPECT_EQ(first["samples"].value<int>(), 360'000);
  EXPECT_EQ(first["begin_utime_us"].value<std::int64_t>(), 1'767'225'600'000'000);
  const auto fix = first["north_fix"][0];
  EXPECT_DOUBLE_EQ(fix["azimuth_true_deg"].value<double>().value(), 270);
  EXPECT_DOUBLE_EQ(fix["sigma_azimuth_deg"].value<double>().value(), 0.5);
  EXPECT_DOUBLE_EQ(fix["earth_rate_deg_per_h"].value<double>().value(), 15.04);
  EXPECT_EQ(fix["quality"].value<std::string>(), "mirror");
}

TEST(RunToml, SaysHowTheRunFits) {
  Survey survey = SmallSurvey();
  RunSummary& summary = survey.runs[0];
  summary.samples_accel_saturated = 4;
  summary.temperature_max = 61.5F;
  const auto fit = std::make_shared<RunFit>();
  summary.fit = fit;
  fit->chi_square = 812.5;
  fit->degrees_of_freedom = 800;
  fit->parts[RunFit::kInclination] = {300.25, 310.5};
  fit->errors[kToolfaceOffset] = 0.25 * units::kDeg;
  fit->sigma_errors[kToolfaceOffset] = 0.03 * units::kDeg;
  summary.fixes[0].roll_rate = 0.5 * units::kDegPerHour;
  const toml::table run = toml::parse(RunToml(Record(), SmallJob(), survey, {}));
  const auto first = run["run"][0];
  EXPECT_EQ(first["accel_saturated"].value<int>(), 4);
  EXPECT_EQ(first["temperature_max_degc"].value<double>(), 61.5);
  EXPECT_EQ(first["fit"]["chi_square"].value<double>(), 812.5);
  EXPECT_EQ(first["fit"]["inclination_degrees_of_freedom"].value<double>(), 310.5);
  EXPECT_NEAR(first["fit"]["toolface_offset_deg"].value<double>().value_or(0), 0.25, 1e-12);
  EXPECT_NEAR(first["fit"]["toolface_offset_sigma_deg"].value<double>().value_or(0), 0.03, 1e-12);
  EXPECT_FALSE(first["fit"]["time_skew_s"]) << "it has no prior";
  EXPECT_NEAR(first["north_fix"][0]["roll_rate_deg_per_h"].value<double>().value_or(0), 0.5, 1e-12);
}

TEST(RunToml, SaysAnglesAsTheJobDid) {
  Job job = SmallJob();
  for (const double said :
       {60.0, 0.1, -33.3, 71.2345678901234, 1e-7, 89.9999999999999, 9.99, 7.7}) {
    job.well.latitude = FromDegrees(said);
    job.well.longitude = FromDegrees(-said);
    const toml::table run = toml::parse(RunToml(Record(), job, SmallSurvey(), {}));
    EXPECT_EQ(run["well"]["latitude_deg"].value<double>(), said);
    EXPECT_EQ(run["well"]["longitude_deg"].value<double>(), -said);
  }
}

TEST(RunToml, NamesWhatAdjustedTheRunsThatWere) {
  const auto adjuster = [](const Survey& survey) {
    return toml::parse(RunToml(Record(), SmallJob(), survey, {}))["adjuster"].value<std::string>();
  };
  Survey survey = SmallSurvey();
  EXPECT_EQ(adjuster(survey), "none");
  survey.runs[0].fit = std::make_shared<const RunFit>(RunFit{.adjuster = "least squares"});
  EXPECT_EQ(adjuster(survey), "least squares");
}

TEST(RunToml, NamesTheCheaperForm) {
  Job job = SmallJob();
  job.attitude.order = AttitudeSpec::Order::kSecond;
  const toml::table run = toml::parse(RunToml(Record(), job, SmallSurvey(), {}));
  EXPECT_EQ(run["attitude_order"].value<std::string>(), "second");
}

TEST(RunToml, HoldsNothingOfTheSource) {
  const std::string text = RunToml(Record(), SmallJob(), SmallSurvey(), {});
  EXPECT_THAT(text, testing::Not(testing::HasSubstr("/somewhere")));
  EXPECT_THAT(text, testing::Not(testing::HasSubstr("offset")));
  EXPECT_THAT(text, testing::Not(testing::HasSubstr("77")));
}

TEST(RunToml, CountsEveryFaultAndListsAHundred) {
  RunRecord record;
  record.faults.assign(250, {.code = FaultCode::kLate, .text = "late"});
  const toml::table run = toml::parse(RunToml(record, {}, {}, {}));
  EXPECT_EQ(run["faults"]["late"].value<int>(), 250);
  EXPECT_EQ(run["fault"].as_array()->size(), 100u);
}

TEST(SourceToml, HoldsThePlaces) {
  SourceRecord record;
  record.name = "run\t1.log";
  record.counts["bytes_lost"] = 40;
  record.faults.push_back({.code = FaultCode::kDamaged, .text = "40 bytes", .offset = 1234});
  const toml::table source = toml::parse(SourceToml(record));
  EXPECT_EQ(source["format"].value<std::string>(), "wellgyro.source/1");
  EXPECT_EQ(source["name"].value<std::string>(), "run\t1.log");
  EXPECT_EQ(source["counts"]["bytes_lost"].value<int>(), 40);
  EXPECT_EQ(source["fault"][0]["code"].value<std::string>(), "damaged");
  EXPECT_EQ(source["fault"][0]["offset"].value<int>(), 1234);
}

TEST(ResultFiles, RunTomlComesLastAndNamesTheOthersButTheSource) {
  const auto files = ResultFiles(Record(), {}, SmallJob(), SmallSurvey());
  std::vector<std::string> names;
  for (const OutputFile& file : files) names.push_back(file.name);
  EXPECT_THAT(names,
              testing::ElementsAre("survey.csv", "passes.csv", "checks.csv", "diagnosis.csv",
                                   "reliability.csv", "stretches.csv", "source.toml", "run.toml"));
  const toml::table run = toml::parse(files.back().bytes);
  EXPECT_EQ(run["output"].as_array()->size(), 6u);
  EXPECT_EQ(run["output"][0]["sha256"].value<std::string>(), Sha256Hex(files[0].bytes));
}

TEST(ResultFiles, AGridBringsItsColumns) {
  Job job = SmallJob();
  job.well.longitude = 3 * units::kDeg;
  job.grid = UtmGrid("31N");
  const auto files = ResultFiles(Record(), {}, job, SmallSurvey());
  EXPECT_THAT(files[0].bytes, testing::HasSubstr(",NORTHING[m],EASTING[m]\n"));
  EXPECT_THAT(files[1].bytes, testing::HasSubstr(",500000.0000\n"));
}

}  // namespace
}  // namespace wellgyro
