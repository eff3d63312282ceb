// A run in stretches of some twenty seconds, as its charts along time show it.
#include "wellgyro/survey/run/run_stretches.h"

#include <memory>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/io/result/stretches_csv.h"
#include "wellgyro/record/run_fit.h"
#include "wellgyro/simulate/tool_errors.h"

#include "support/simulated_survey.h"

namespace wellgyro {
namespace {

constexpr double kRest = 300, kSpeed = 0.8, kRunEnd = 720, kRamp = 10, kTemperature = 47;
constexpr double kRollRate = -kTwoPi / 60;

/// Rests five minutes, goes down for a quarter of an hour, rests again; `noise` times the noise
/// that the job states.
Simulation RunWithNoise(const Job& job, double noise) {
  Simulation s;
  s.well.end_md = kRunEnd;
  s.well.inclination.start = FromDegrees(40);
  s.well.azimuth.start = FromDegrees(70);
  s.earth.latitude = job.well.latitude;
  s.run.roll_reference = RollReference::kHighSide;
  s.run.steps.push_back(RunStop{.seconds = kRest});
  RunMove down;
  down.to_md = kRunEnd;
  down.speed = kSpeed;
  down.ramp = kRamp;
  down.roll.rate = kRollRate;
  s.run.steps.push_back(down);
  s.run.steps.push_back(RunStop{.seconds = kRest});
  s.streams.imu_hz = 10;
  s.streams.depth_hz = 2;
  NoiseCoefficients noisier = job.noise;
  noisier.angle_random_walk *= noise;
  s.tool.errors = DrawToolErrors(job.errors, noisier, 5);
  s.tool.temperature = kTemperature;
  s.seed = 5;
  return s;
}

Job JobOfRun() {
  Job job;
  job.well.latitude = FromDegrees(60);
  job.noise.angle_random_walk = 0.01 * units::kDegPerSqrtHour;
  job.errors.accel_noise = 2e-4;
  return job;
}

std::vector<RunStretch> StretchesFor(double noise, const testing::Arrives& arrives = {}) {
  const Job job = JobOfRun();
  testing::CollectingSink sink;
  const Survey survey = SurveyOf(RunWithNoise(job, noise), job, sink, arrives);
  EXPECT_EQ(survey.runs.size(), 1u);
  const auto& fit = survey.runs.at(0).fit;
  EXPECT_NE(fit, nullptr);
  return fit ? fit->stretches : std::vector<RunStretch>();
}

double MeanSquare(const std::vector<RunStretch>& stretches,
                  std::optional<double> RunStretch::*residual) {
  double sum = 0, count = 0;
  for (const RunStretch& s : stretches) {
    const double rms = (s.*residual).value_or(0);
    sum += rms * rms;
    count += s.*residual ? 1 : 0;
  }
  return sum / count;
}

TEST(RunStretches, TellWhatTheToolDid) {
  const std::vector<RunStretch> stretches = StretchesFor(1);
  ASSERT_GT(stretches.size(), 50u);
  EXPECT_NEAR((stretches.back().end - stretches.front().begin).seconds(),
              2 * kRest + kRunEnd / kSpeed + kRamp, 1);
  int moving = 0, resting = 0;
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    const RunStretch& s = stretches[i];
    if (i > 0) {
      EXPECT_NEAR((s.begin - stretches[i - 1].end).seconds(), 0, 1e-3);
    }
    EXPECT_NEAR(s.temperature, kTemperature, 1e-3);
    EXPECT_EQ(s.samples_lost, 0);
    ASSERT_TRUE(s.md && s.speed);
    if (*s.md > 40 && *s.md < kRunEnd - 40) {
      EXPECT_NEAR(*s.speed, kSpeed, 0.01);
      EXPECT_NEAR(s.roll_rate, kRollRate, 0.02 * -kRollRate);
      ++moving;
    } else if (*s.md == 0) {
      EXPECT_NEAR(*s.speed, 0, 1e-3);
      EXPECT_NEAR(s.roll_rate, 0, 1e-3 * -kRollRate);
      ++resting;
    }
  }
  EXPECT_GT(moving, 30);
  EXPECT_GT(resting, 10);
}

// On the way the hole takes up what the gyros say: they have residuals in 600 s at rest, some 1100
// of them, whose mean square scatters by 4 %, and the accelerometers three times as many.
TEST(RunStretches, ResidualsAreOneWhereTheNoiseIsAsStated) {
  const std::vector<RunStretch> stated = StretchesFor(1), noisier = StretchesFor(2);
  EXPECT_NEAR(MeanSquare(stated, &RunStretch::residual_gyro), 1, 0.1);
  EXPECT_NEAR(MeanSquare(stated, &RunStretch::residual_accel), 1, 0.1);
  EXPECT_GT(MeanSquare(noisier, &RunStretch::residual_gyro), 1.0);
}

TEST(RunStretches, CountWhatWasLostOnce) {
  int dropped = 0, taken = 0;
  const auto arrives = [&](SimulatedStep& step) {
    // Three in a row now and then, which fall into one knot, on two, and on where one ends.
    if (!std::holds_alternative<ImuSample>(step) || (++taken) % 317 >= 3 || taken < 3) return true;
    ++dropped;
    return false;
  };
  double lost = 0;
  for (const RunStretch& s : StretchesFor(1, arrives)) lost += s.samples_lost;
  EXPECT_GT(dropped, 100);
  EXPECT_EQ(lost, dropped);
}

TEST(RunStretches, AreWrittenAlongTime) {
  Survey survey;
  RunSummary& run = survey.runs.emplace_back();
  run.run = 3;
  RunStretch s;
  s.begin = {.ns = 1'000'000'000};
  s.end = {.ns = 21'500'000'000};
  s.roll_rate = -kTwoPi / 60;
  s.temperature = 47.125;
  s.samples_lost = 4;
  const auto fit = std::make_shared<RunFit>();
  run.fit = fit;
  fit->stretches = {s};
  s.begin = s.end;
  s.end = {.ns = 41'000'000'000};
  s.md = 12.5;
  s.speed = -0.25;
  s.residual_gyro = 1.5;
  fit->stretches.push_back(s);
  EXPECT_EQ(StretchesCsv(survey),
            "RUN,END_UTC,T[s],MD[m],SPEED[m/s],ROTATION[rpm],TEMPERATURE[degC],SAMPLES_LOST,"
            "RES_GYRO,RES_ACCEL\n"
            "3,1970-01-01T00:00:21.500Z,20.500,,,-1.0000,47.12,4,,\n"
            "3,1970-01-01T00:00:41.000Z,40.000,12.5000,-0.2500,-1.0000,47.12,4,1.5000,\n");
}

}  // namespace
}  // namespace wellgyro
