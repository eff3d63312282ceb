// Where a run begins and ends, and what is said when nothing is left of it. Cases from reports of
// 2026-11-21.
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/simulate/truth.h"

#include "support/simulated_survey.h"
#include "support/small_hole.h"

namespace wellgyro {
namespace {

using testing::CollectingSink;

TEST(RunLimits, ATieInBelowTheRunIsNoSurvey) {
  Job job = testing::SlantJob();
  job.tie_in.md = 350;
  job.tie_in.tvd = 0;
  job.tie_in.inclination = FromDegrees(30);
  job.tie_in.azimuth = FromDegrees(45);
  Sink sink;
  const Survey survey = testing::SurveyOf(testing::Slant(), job, sink);
  EXPECT_NE(survey.unusable.find("no deeper than the tie-in at 350.00 m"), std::string::npos)
      << survey.unusable;
  EXPECT_TRUE(survey.chosen.empty());
}

TEST(RunLimits, ARunAboveATieInWithoutAttitudeIsSaidToBeginAboveIt) {
  Job job = testing::SlantJob();
  job.tie_in.md = 5000;
  job.tie_in.tvd = 4000;
  Sink sink;
  const Survey survey = testing::SurveyOf(testing::Slant(), job, sink);
  EXPECT_NE(survey.unusable.find("above the tie-in at 5000.00 m"), std::string::npos)
      << survey.unusable;
  EXPECT_EQ(survey.unusable.find("below"), std::string::npos) << survey.unusable;
}

TEST(RunLimits, DepthsOutsideTheRunAreNoSurvey) {
  Job job = testing::SlantJob();
  job.stations.every = 0;
  job.stations.at = {1000, 2000};
  Sink sink;
  EXPECT_NE(testing::SurveyOf(testing::Slant(), job, sink).unusable.find("none of the depths"),
            std::string::npos);
  job.stations.at = {100, 1000};
  const Survey part = testing::SurveyOf(testing::Slant(), job, sink);
  EXPECT_EQ(part.unusable, "");
  EXPECT_EQ(part.chosen.size(), 2u);
  const Check* asked = testing::Find(part, "stations_asked");
  ASSERT_NE(asked, nullptr);
  EXPECT_EQ(asked->verdict, Verdict::kWarn);
  EXPECT_EQ(asked->md.value_or(0), 1000);
}

TEST(RunLimits, RejectingEverythingLeavesNoSurvey) {
  Job job = testing::SlantJob();
  Event reject;
  reject.utc = testing::Slant().streams.begin_utc;
  reject.kind = Event::Kind::kReject;
  job.events.push_back(reject);
  Sink sink;
  EXPECT_EQ(testing::SurveyOf(testing::Slant(), job, sink).unusable, "every station was rejected");
}

TEST(RunLimits, SamplesAfterTheJobsEndOfARunAreLeftOut) {
  const Simulation simulation = testing::Slant();
  const Truth truth(simulation);
  double at_200 = 0;
  while (truth.At(at_200).md < 200) at_200 += 0.5;
  Job job = testing::SlantJob();
  RunSpec run;
  run.number = simulation.streams.run > 0 ? simulation.streams.run : 1;
  run.end = simulation.streams.begin_utc + Duration::Seconds(at_200);
  job.runs = {run};
  Sink sink;
  const Survey survey = testing::SurveyOf(simulation, job, sink);
  ASSERT_EQ(survey.unusable, "");
  ASSERT_EQ(survey.runs.size(), 1u);
  EXPECT_LE(survey.chosen.back().md, 200.5);
  EXPECT_GE(survey.chosen.back().md, 199.0);
  const double all = truth.seconds() * simulation.streams.imu_hz;
  EXPECT_NEAR(static_cast<double>(survey.runs[0].samples), at_200 * simulation.streams.imu_hz, 2);
  EXPECT_NEAR(static_cast<double>(survey.runs[0].samples + survey.runs[0].samples_after_end), all,
              2);
}

TEST(RunLimits, ReturnToZeroAndForesightCountAfterTheLastSample) {
  Simulation simulation = testing::Slant();
  simulation.run.steps.push_back(RunMove{.to_md = 1});
  simulation.run.steps.push_back(RunStop{.seconds = 30});
  const Truth truth(simulation);
  const TruthState end = truth.At(truth.seconds() - 1);
  Job job = testing::SlantJob();
  Event back;
  back.utc = simulation.streams.begin_utc + Duration::Seconds(truth.seconds() + 120);
  back.kind = Event::Kind::kReturnToZero;
  back.has_value = true;
  back.value_m = 0.8;
  back.sigma_m = 0.05;
  Event foresight = back;
  foresight.kind = Event::Kind::kForesight;
  foresight.value_rad = std::atan2(end.R_LT(1, 0), end.R_LT(0, 0)) + FromDegrees(2);
  foresight.sigma_rad = FromDegrees(0.05);
  job.events = {back, foresight};
  Sink sink;
  const Survey survey = testing::SurveyOf(simulation, job, sink);
  const Check* closure = testing::Find(survey, "depth_closure");
  ASSERT_NE(closure, nullptr);
  ASSERT_TRUE(closure->value);
  EXPECT_NEAR(*closure->value, 0.2, 0.02);
  const Check* seen = testing::Find(survey, "foresight");
  ASSERT_NE(seen, nullptr);
  ASSERT_TRUE(seen->value);
  ASSERT_TRUE(seen->sigma);
  EXPECT_LT(*seen->sigma, 0.3);
  EXPECT_NEAR(*seen->value, -2, 4 * *seen->sigma);
  EXPECT_EQ(seen->verdict, Verdict::kFail);
}

TEST(RunLimits, AnEventWithoutItsValueIsAFaultAndNoCheck) {
  const Simulation simulation = testing::Slant();
  CollectingSink sink;
  Surveyor surveyor(testing::SlantJob(), sink);
  for (const auto kind :
       {Event::Kind::kForesight, Event::Kind::kDepthTie, Event::Kind::kDepthRezero}) {
    Event event;
    event.kind = kind;
    event.utc = simulation.streams.begin_utc + Duration::Seconds(60);
    surveyor.Push(event);
  }
  testing::Play(simulation, surveyor);
  surveyor.Finish();
  const Survey survey = surveyor.Current(0);
  ASSERT_EQ(sink.faults.size(), 3u);
  EXPECT_NE(sink.faults[0].text.find("value_rad: is missing"), std::string::npos);
  const Check* foresight = testing::Find(survey, "foresight");
  ASSERT_NE(foresight, nullptr);
  EXPECT_EQ(foresight->verdict, Verdict::kNotDone);
  EXPECT_NE(survey.verdict.verdict, Verdict::kFail);
}

TEST(RunLimits, AnExternalAzimuthThatTheStopsContradictIsToldAtEveryStation) {
  const Simulation simulation = testing::Slant();
  for (const double wrong : {0.0, 8.0}) {
    Job job = testing::SlantJob();
    job.alignment.method = AlignmentSpec::Method::kExternal;
    job.alignment.azimuth = simulation.well.azimuth.start + FromDegrees(wrong);
    job.alignment.sigma_azimuth = FromDegrees(0.5);
    CollectingSink sink;
    const Survey survey = testing::SurveyOf(simulation, job, sink);
    ASSERT_EQ(survey.unusable, "");
    EXPECT_EQ(sink.faults.empty(), wrong == 0) << wrong;
    for (const Station& s : survey.chosen) {
      EXPECT_EQ(Has(s.quality, Quality::kEarthRate), wrong != 0) << s.md;
    }
  }
}

TEST(RunLimits, AveragesThatCannotBeAreLeftOutAndTold) {
  StillWindow good;
  good.utc_begin = UtcTime{1'700'000'000'000'000'000};
  good.utc_end = good.utc_begin + Duration::Seconds(60);
  good.f_T = {4.9, 0, -8.5};
  good.w_IT_T = {4e-5, 3e-5, 0};
  good.sigma_w_IT_T.setConstant(1e-7);
  good.md = 100;
  const auto spoil = [&](auto change) {
    StillWindow window = good;
    change(window);
    CollectingSink sink;
    Surveyor surveyor(testing::SlantJob(), sink);
    surveyor.Push(window);
    surveyor.Finish();
    return sink.faults.size();
  };
  const double none = std::nan("");
  EXPECT_EQ(spoil([](StillWindow&) {}), 0u);
  EXPECT_EQ(spoil([](StillWindow& w) { w.f_T.setZero(); }), 1u);
  EXPECT_EQ(spoil([&](StillWindow& w) { w.f_T.y() = none; }), 1u);
  EXPECT_EQ(spoil([&](StillWindow& w) { w.w_IT_T.x() = none; }), 1u);
  EXPECT_EQ(spoil([](StillWindow& w) { w.w_IT_T.x() = 1e300; }), 1u);
  EXPECT_EQ(spoil([](StillWindow& w) { w.sigma_w_IT_T.x() = -1; }), 1u);
  EXPECT_EQ(spoil([&](StillWindow& w) { w.roll_rate = none; }), 1u);
  EXPECT_EQ(spoil([&](StillWindow& w) { w.sigma_roll_rate = none; }), 1u);
  EXPECT_EQ(spoil([](StillWindow& w) { w.roll_rate = 1e-6; }), 0u);
  EXPECT_EQ(spoil([&](StillWindow& w) { w.b_T.x() = none; }), 0u) << "not said to be there";
  EXPECT_EQ(spoil([&](StillWindow& w) {
              w.has_mag = true;
              w.b_T.x() = none;
            }),
            1u);
  EXPECT_EQ(spoil([](StillWindow& w) { w.md = 1e300; }), 1u);
  EXPECT_EQ(spoil([](StillWindow& w) { w.utc_end = w.utc_begin; }), 1u);
}

/// 60 s at rest, from 0, 150 and 300 s on.
std::vector<StillWindow> ThreeRests() {
  std::vector<StillWindow> windows(3);
  const Site site = SiteAt(FromDegrees(60), 0);
  for (std::size_t i = 0; i < windows.size(); ++i) {
    StillWindow& w = windows[i];
    w.utc_begin =
        UtcTime{1'700'000'000'000'000'000 + static_cast<std::int64_t>(i) * 150'000'000'000};
    w.utc_end = w.utc_begin + Duration::Seconds(60);
    const Eigen::Matrix3d to_tool =
        AttitudeMatrix(FromDegrees(40), FromDegrees(20), 0.3 + static_cast<double>(i)).transpose();
    w.f_T = to_tool * Eigen::Vector3d(0, 0, -site.gravity);
    w.w_IT_T = to_tool * kEarthRate *
               Eigen::Vector3d(std::cos(FromDegrees(60)), 0, -std::sin(FromDegrees(60)));
    w.w_IT_T.z() = 0;
    w.sigma_w_IT_T.setConstant(1e-8);
    w.sigma_f_T.setConstant(1e-5);
  }
  return windows;
}

DepthMark NumberedMark(UtcTime utc, double md, std::int64_t seq) {
  DepthMark mark;
  mark.utc = utc;
  mark.md = md;
  mark.seq = seq;
  return mark;
}

// Until 2026-11-21: "no north was found: no stop of 60 s ...".
TEST(RunLimits, MarksAtBothEndsOfAveragesAtRestGiveTheirDepth) {
  Job job = testing::SlantJob();
  job.well.latitude = FromDegrees(60);
  job.stations.every = 0;
  job.stations.at_stops = true;
  const std::vector<StillWindow> windows = ThreeRests();
  // How far the second mark of the second rest is off the first, and stations.
  for (const auto& [off, stations] : {std::pair{0.0, 3u}, std::pair{0.5, 2u}}) {
    CollectingSink sink;
    Surveyor surveyor(job, sink);
    for (std::size_t i = 0; i < windows.size(); ++i) {
      const double md = 100.0 * static_cast<double>(i);
      const auto seq = static_cast<std::int64_t>(2 * i);
      surveyor.Push(NumberedMark(windows[i].utc_begin, md, seq));
      surveyor.Push(NumberedMark(windows[i].utc_end, md + (i == 1 ? off : 0), seq + 1));
    }
    for (const StillWindow& window : windows) surveyor.Push(window);
    surveyor.Finish();
    const Survey survey = surveyor.Current(0);
    ASSERT_EQ(survey.unusable, "");
    ASSERT_EQ(survey.chosen.size(), stations);
    EXPECT_NEAR(survey.chosen.back().md, 200, 1e-6);
    EXPECT_NEAR(survey.runs[0].seconds_without_depth, off > 0 ? 60 : 0, 1e-6);
    const Check* unknown = testing::Find(survey, "depth_unknown");
    ASSERT_EQ(unknown != nullptr, off > 0);
    if (unknown == nullptr) continue;
    EXPECT_EQ(unknown->verdict, Verdict::kWarn);
    ASSERT_EQ(sink.faults.size(), 1u);
    EXPECT_NE(sink.faults[0].text.find("averages at rest of 1700000150"), std::string::npos);
    EXPECT_NE(sink.faults[0].text.find("max_gap_s = 5"), std::string::npos);
  }
}

TEST(RunLimits, AveragesAtRestWithoutAnyDepthAreToldAsSuch) {
  Sink sink;
  Surveyor surveyor(testing::SlantJob(), sink);
  for (const StillWindow& window : ThreeRests()) surveyor.Push(window);
  surveyor.Finish();
  const std::string why = surveyor.Current(0).unusable;
  EXPECT_NE(why.find("averages at rest came but no depth"), std::string::npos) << why;
  EXPECT_NE(why.find("max_gap_s"), std::string::npos) << why;
}

// Cut off by the user. Until 2026-11-21 the stations before the first north were said to have none,
// and those of a run that has not come to its first stop to have failed.
TEST(RunLimits, AStationOfARunCutOffLacksAnAzimuthOnlyWhereNoneIsKnown) {
  const auto azimuths = [](const Surveyor& surveyor) {
    const Survey survey = surveyor.Current(0);
    const Check* check = testing::Find(survey, "stations_without_azimuth");
    return check == nullptr ? Check{} : *check;
  };
  const Simulation first = testing::Slant();
  const double length = Truth(first).seconds();
  const auto before = [](UtcTime end) {
    return [end](const SimulatedStep& step) {
      const auto* sample = std::get_if<ImuSample>(&step);
      const auto* mark = std::get_if<DepthMark>(&step);
      return sample != nullptr ? sample->stamp.utc < end : mark == nullptr || mark->utc < end;
    };
  };
  for (const double part : {0.5, 0.7}) {
    Sink sink;
    Surveyor surveyor(testing::SlantJob(), sink);
    testing::Play(first, surveyor,
                  before(first.streams.begin_utc + Duration::Seconds(part * length)));
    const Survey survey = surveyor.Current(0);
    ASSERT_EQ(survey.unusable, "");
    EXPECT_EQ(survey.chosen.front().md, 0);
    EXPECT_EQ(azimuths(surveyor).verdict, Verdict::kPass) << azimuths(surveyor).limit_source;
  }
  // Another run, without a stop at its begin.
  Simulation second = testing::Slant();
  second.run.steps = {RunMove{.to_md = 200}, RunStop{.seconds = 90}};
  second.streams.session = 2;
  second.streams.run = 2;
  second.streams.begin_utc = first.streams.begin_utc + Duration::Seconds(length + 600);
  Event begin;
  begin.kind = Event::Kind::kRunBegin;
  begin.utc = second.streams.begin_utc - Duration::Seconds(1);
  Sink sink;
  Surveyor surveyor(testing::SlantJob(), sink);
  testing::Play(first, surveyor);
  surveyor.Push(begin);
  const double moving = Truth(second).seconds() - 90;
  testing::Play(second, surveyor, before(second.streams.begin_utc + Duration::Seconds(moving)));
  EXPECT_EQ(azimuths(surveyor).verdict, Verdict::kNotDone);
  EXPECT_NE(azimuths(surveyor).limit_source.find("wait for the next north"), std::string::npos);
  // Its stop shows north in the end. What came before it comes again, and is skipped.
  testing::Play(second, surveyor);
  surveyor.Finish();
  EXPECT_EQ(azimuths(surveyor).verdict, Verdict::kPass);
  EXPECT_EQ(azimuths(surveyor).value, 0);
}

TEST(RunLimits, AStationAfterLostSamplesSaysSo) {
  const Simulation simulation = testing::Slant();
  const Truth truth(simulation);
  double lost_md = 0;
  int lost = 0;
  Sink sink;
  const Survey survey =
      testing::SurveyOf(simulation, testing::SlantJob(), sink, [&](SimulatedStep& step) {
        const auto* sample = std::get_if<ImuSample>(&step);
        if (sample == nullptr || lost == 10) return true;
        const double md = truth.At(static_cast<double>(sample->stamp.seq) / 20.0).md;
        // Half a second, five metres before the station at 120 m.
        if (md <= 115) return true;
        ++lost;
        lost_md = md;
        return false;
      });
  ASSERT_EQ(survey.unusable, "");
  EXPECT_EQ(survey.runs[0].samples_lost, 10);
  EXPECT_NEAR(lost_md, 115, 2);
  for (const Station& s : survey.chosen) {
    EXPECT_EQ(Has(s.quality, Quality::kGap), std::abs(s.md - 120) < 1) << s.md;
  }
}

TEST(RunLimits, ADepthErrorCountsOnceInAPassThatBeginsBelowTheTieIn) {
  // An hour of stops makes the depth error the largest by far.
  Simulation simulation = testing::Slant();
  simulation.run.steps.push_back(RunMove{.to_md = 150});
  simulation.run.steps.push_back(RunMove{.to_md = 250});
  Job job = testing::SlantJob();
  job.errors.depth_sigma = 2;
  Sink sink;
  const Survey survey = testing::SurveyOf(simulation, job, sink);
  ASSERT_EQ(survey.unusable, "");
  int seen = 0;
  for (const Station& s : survey.passes) {
    const Eigen::Vector3d t = Tangent(s.inclination, s.azimuth);
    const double along = std::sqrt(t.dot(s.cov_p_WT_W * t));
    seen += s.pass != Pass::kIn;
    EXPECT_NEAR(along, 2, 0.02) << s.md << " of pass " << static_cast<int>(s.pass);
  }
  EXPECT_GE(seen, 10);
}

// The encoder reads 0.5 m too much all the way: below a build from 10 to 88 deg that is in the TVD.
TEST(RunLimits, ADepthErrorFromTheStartIsInTheTvdBelowABuild) {
  Simulation simulation = testing::Slant();
  simulation.well.inclination.start = FromDegrees(10);
  simulation.well.inclination.terms.push_back({.rate = FromDegrees(78) / 300});
  simulation.tool.errors.depth_offset = 0.5;
  Job job = testing::SlantJob();
  job.errors.depth_sigma = 0.5;
  Sink sink;
  const Survey survey = testing::SurveyOf(simulation, job, sink);
  ASSERT_EQ(survey.unusable, "");
  ASSERT_FALSE(survey.chosen.empty());
  const Station& last = survey.chosen.back();
  const double error = last.p_WT_W.z() - Truth(simulation).well().PlaceAt(last.md).p_WT_W.z();
  const double sigma = std::sqrt(last.cov_p_WT_W(2, 2));
  EXPECT_NEAR(error, 0.5 * (std::cos(FromDegrees(10)) - std::cos(last.inclination)), 0.05);
  // Of where the tool was the TVD is off by 0.5 cos 10 deg, which the sigma holds beside it.
  EXPECT_NEAR(sigma, 0.5 * std::hypot(std::cos(FromDegrees(10)), error / 0.5), 0.05);
}

}  // namespace
}  // namespace wellgyro
