// What a Job made in a program may not hold: every number from outside is refused by its field.
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "wellgyro/survey/intake/plausible.h"
#include "wellgyro/survey/intake/sample_counts.h"
#include "wellgyro/survey/job.h"

#include "support/small_hole.h"

namespace wellgyro {
namespace {

using ::testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

/// Why the job is refused once it is changed so; empty: it is taken.
std::string WhyNot(const std::function<void(Job&)>& change) {
  Job job = testing::SlantJob();
  change(job);
  try {
    CheckJob(job);
  } catch (const std::invalid_argument& refused) {
    return refused.what();
  }
  return "";
}

std::string WhyNotCovariance(int row, int column, double value) {
  return WhyNot([&](Job& job) { job.tie_in.cov_p_WT_W(row, column) = value; });
}

TEST(JobCheck, ATieInsCovarianceIsOne) {
  const auto names_it = HasSubstr("tie_in.cov_p_WT_W");
  for (const double odd : {kNan, kInf, -kInf, 1e300}) {
    EXPECT_THAT(WhyNotCovariance(0, 1, odd), names_it) << odd;
    EXPECT_THAT(WhyNotCovariance(2, 2, odd), names_it) << odd;
  }
  EXPECT_THAT(WhyNotCovariance(1, 1, -1), HasSubstr("negative variance"));
  EXPECT_THAT(WhyNotCovariance(1, 0, 1), HasSubstr("symmetric"));
  Eigen::Matrix3d cov = Eigen::Matrix3d::Identity();
  cov(0, 1) = cov(1, 0) = 2;  // a correlation of 2
  EXPECT_THAT(WhyNot([&](Job& job) { job.tie_in.cov_p_WT_W = cov; }),
              HasSubstr("negative variance, -1 m^2"));
  cov(0, 1) = cov(1, 0) = 1;  // of 1: along one line
  EXPECT_EQ(WhyNot([&](Job& job) { job.tie_in.cov_p_WT_W = cov; }), "");
  cov(0, 1) += 1e-9;  // as rounded
  EXPECT_EQ(WhyNot([&](Job& job) { job.tie_in.cov_p_WT_W = cov; }), "");
}

TEST(JobCheck, SizesThatNoGyroHasAreRefusedWithTheValue) {
  const auto refused = [](double NoiseCoefficients::*member, double value) {
    return WhyNot([&](Job& job) { job.noise.*member = value; });
  };
  EXPECT_THAT(refused(&NoiseCoefficients::quantization, 1e300),
              HasSubstr("noise.quantization_arcsec"));
  EXPECT_THAT(refused(&NoiseCoefficients::angle_random_walk, 1e300),
              HasSubstr("noise.angle_random_walk"));
  // No double holds it in deg/h^2, and the message says what was given.
  EXPECT_THAT(refused(&NoiseCoefficients::rate_ramp, 1e300),
              AllOf(HasSubstr("noise.rate_ramp"), HasSubstr("1e+300")));
  EXPECT_THAT(WhyNot([](Job& job) { job.errors.gyro_bias_sigma = 1e300; }),
              HasSubstr("errors.gyro_bias_sigma"));
  EXPECT_THAT(WhyNot([](Job& job) { job.errors.mass_unbalance_sigma = 1e300; }),
              HasSubstr("errors.mass_unbalance_sigma"));
  for (const double odd : {kNan, kInf, 1e300}) {
    EXPECT_THAT(WhyNot([&](Job& job) { job.errors.gyro_misalignment_x = odd; }),
                HasSubstr("errors.gyro_misalignment_x"));
    EXPECT_THAT(WhyNot([&](Job& job) { job.errors.gyro_misalignment_y = -odd; }),
                HasSubstr("errors.gyro_misalignment_y"));
  }
}

TEST(JobCheck, EventsAreHeldToWhatPushedOnesAre) {
  const auto refused = [](double Event::*member, double value) {
    return WhyNot([&](Job& job) {
      job.events.resize(2);
      job.events[1].*member = value;
    });
  };
  EXPECT_EQ(refused(&Event::value_m, 1000), "");
  for (const double odd : {kNan, kInf, -1e300}) {
    EXPECT_THAT(refused(&Event::value_m, odd), HasSubstr("events[1].value_m"));
    EXPECT_THAT(refused(&Event::sigma_m, odd), HasSubstr("events[1].sigma_m"));
    EXPECT_THAT(refused(&Event::value_rad, odd), HasSubstr("events[1].value_rad"));
    EXPECT_THAT(refused(&Event::sigma_rad, odd), HasSubstr("events[1].sigma_rad"));
  }
  EXPECT_THAT(WhyNot([](Job& job) {
                job.depth.corrections = {{kInf, 1}};
              }),
              HasSubstr("depth.corrections"));
}

TEST(JobCheck, APushedEventsSigmaIsNoneBelowZero) {
  EXPECT_EQ(WhyImplausible(Event{.sigma_m = 5, .sigma_rad = 5}), "");
  EXPECT_EQ(WhyImplausible(Event{.sigma_m = -5}),
            "an event was left out: sigma_m: -5 must be at least 0");
  EXPECT_THAT(WhyImplausible(Event{.sigma_rad = -5}), HasSubstr("sigma_rad: -5"));
}

TEST(JobCheck, AnEventOfADepthOrADirectionHasOne) {
  struct Needed {
    Event::Kind kind;
    std::string key;
  };
  for (const Needed& needed :
       {Needed{Event::Kind::kDepthRezero, "value_m"}, Needed{Event::Kind::kDepthTie, "value_m"},
        Needed{Event::Kind::kForesight, "value_rad"}}) {
    const auto& [kind, key] = needed;
    EXPECT_THAT(WhyImplausible(Event{.kind = kind}), HasSubstr(key + ": is missing"));
    EXPECT_EQ(WhyImplausible(Event{.kind = kind, .has_value = true}), "");
    EXPECT_THAT(WhyNot([&](Job& job) { job.events.emplace_back().kind = needed.kind; }),
                HasSubstr("events[0]." + key));
  }
  for (const auto kind : {Event::Kind::kDepthZero, Event::Kind::kReturnToZero}) {
    EXPECT_EQ(WhyImplausible(Event{.kind = kind}), "") << "0 m is meant";
  }
}

TEST(JobCheck, AnEnumerationHoldsOneOfItsValues) {
  const auto names = [](const char* key) { return HasSubstr(std::string(key) + ": 99 is none"); };
  EXPECT_THAT(WhyNot([](Job& job) { job.events.emplace_back().kind = Event::Kind{99}; }),
              names("events[0].event"));
  EXPECT_THAT(WhyNot([](Job& job) { job.events.emplace_back().kind = Event::Kind{0}; }),
              HasSubstr("event: 0 is none"));
  EXPECT_THAT(WhyNot([](Job& job) { job.depth.kind = DepthKind{99}; }), names("depth.kind"));
  EXPECT_THAT(WhyNot([](Job& job) { job.depth.kind = DepthKind{-1}; }), HasSubstr("depth.kind"));
  EXPECT_THAT(WhyNot([](Job& job) { job.alignment.method = AlignmentSpec::Method{99}; }),
              names("alignment.method"));
  EXPECT_THAT(WhyNot([](Job& job) { job.alignment.of = AlignmentSpec::Of{99}; }),
              names("alignment.of"));
  EXPECT_THAT(WhyNot([](Job& job) { job.attitude.order = AttitudeSpec::Order{99}; }),
              names("attitude.order"));
  EXPECT_THAT(WhyNot([](Job& job) { job.grid.emplace().projection = GridSpec::Projection{99}; }),
              names("grid.projection"));
}

TEST(JobCheck, TheWellHeadLiesOnItsGrid) {
  EXPECT_EQ(WhyNot([](Job& job) { job.grid.emplace(); }), "");
  EXPECT_THAT(WhyNot([](Job& job) { job.grid.emplace().longitude_origin = 2; }),
              HasSubstr("grid: the well head has no place on it"));
}

TEST(JobCheck, AToolWithoutAccelerometersIsRefused) {
  EXPECT_THAT(WhyNot([](Job& job) {
                SensorGroup& gyro = job.tool.emplace().gyro;
                gyro.n_channels = 2;
                for (int i = 0; i < 2; ++i) {
                  gyro.channel[static_cast<std::size_t>(i)] = i;
                  gyro.sensitivity[0](i, i) = 1;
                }
              }),
              HasSubstr("tool.accel.n_channels"));
}

TEST(SampleCounts, ATemperatureThatIsNoNumberLeavesTheRange) {
  RunSummary run;
  for (const double T : {kNan, 40.0, kNan, 60.0, 50.0, kNan}) {
    SampleStamp stamp;
    stamp.temperature = static_cast<float>(T);
    CountSamples(stamp, 1, run);
  }
  EXPECT_EQ(run.temperature_min, 40);
  EXPECT_EQ(run.temperature_max, 60);
}

}  // namespace
}  // namespace wellgyro
