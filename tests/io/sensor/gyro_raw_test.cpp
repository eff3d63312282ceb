#include "wellgyro/io/sensor/gyro_raw.h"

#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/io/sensor/sensor_files.h"

#include "support/scratch.h"
#include "support/simulated_survey.h"

namespace wellgyro {
namespace {

const std::string kHead =
    "IOGP,TEST,7,1.0,1,2026:01:15,08:00:00,t.p717,me\r\n"
    "HC,1,3,0,CRS Number/EPSG Code/Name/Source,2,23031,ED50 / UTM zone 31N,,,EPSG,\r\n"
    "HC,1,6,1,Coordinate System Axis 1,2,1,,Northing,north,N,1,m\r\n"
    "H7,1,4,0,Rig/Workover ZDP Definition,1,Rig A,ZDP,3,1,Rotary Table,1,1\r\n"
    "H7,1,5,0,Survey Definition,1,1,1,GYRO,Gyro,,,,,0,30,m,2026:01:15,,ST=N,,,\r\n"
    "H7,1,5,1,Survey Details,1,1,2,MD-Wireline,3,Corrected Depth,1,7,AZIM_TRUE,1,Surveyed,0,,0,,"
    ",,\r\n";

constexpr double kLatitude = FromDegrees(59.7553);
constexpr double kRate = 15.0410672;  // of the Earth [deg/h]

/// A record of a tool that stands still, gravity as it pulls or as specific force.
std::string Record(int number, double md, double inclination_deg, double azimuth_deg,
                   double toolface_deg, double sign) {
  const double i = FromDegrees(inclination_deg), a = FromDegrees(azimuth_deg);
  const double t = FromDegrees(toolface_deg);
  const double north = kRate * std::cos(kLatitude), down = -kRate * std::sin(kLatitude);
  const double high = north * std::cos(a) * std::cos(i) - down * std::sin(i);
  const double right = -north * std::sin(a);
  const double g = 9.8188 * sign;
  return fmt::format(
      "G7,0,1,{},2026:01:15:06:{:02}:00.5,1,{},{},{},,,,1,{},{},{},{},{},{},9.8188,59.75,15.04,,,"
      "9.8188,59.7553,15.041,,\r\n",
      number, number, md, inclination_deg, azimuth_deg, g * std::sin(i) * std::cos(t),
      -g * std::sin(i) * std::sin(t), -g * std::cos(i), high * std::cos(t) + right * std::sin(t),
      -high * std::sin(t) + right * std::cos(t),
      north * std::cos(a) * std::sin(i) + down * std::cos(i));
}

Job PointJob() {
  Job job;
  job.well.latitude = kLatitude;
  job.tie_in.md = 0;
  job.tie_in.inclination = FromDegrees(20);
  job.tie_in.azimuth = FromDegrees(50);
  job.stations.every = 0;
  job.stations.at_stops = true;
  return job;
}

TEST(GyroRaw, AnotherVendorsRecordsAreSurveyedAfresh) {
  for (const double sign : {1.0, -1.0}) {
    const support::Scratch scratch;
    std::string text = kHead;
    for (int k = 1; k <= 4; ++k) text += Record(k, 30.0 * k, 20 + 5 * k, 50 + 10 * k, 77 * k, sign);
    scratch.Write("a.p717", text);
    testing::CollectingSink sink;
    const Job job = PointJob();
    Surveyor surveyor(job, sink);
    const std::vector<std::filesystem::path> files = {scratch.path() / "a.p717"};
    EXPECT_TRUE(IsSensorTable(files[0]));
    const Result<SensorReport> report = PushSensorFiles(files, job, surveyor, sink);
    ASSERT_TRUE(report) << report.fault().text;
    EXPECT_EQ(report->windows, 4);
    surveyor.Finish();
    const Survey survey = surveyor.Current(0);
    ASSERT_EQ(survey.unusable, "");
    ASSERT_EQ(survey.chosen.size(), 5u);
    for (int k = 1; k <= 4; ++k) {
      const Station& s = survey.chosen[static_cast<std::size_t>(k)];
      EXPECT_EQ(s.kind, StationKind::kStill);
      EXPECT_DOUBLE_EQ(s.md, 30.0 * k);
      EXPECT_NEAR(ToDegrees(s.inclination), 20 + 5 * k, 1e-4);
      EXPECT_NEAR(ToDegrees(s.azimuth), 50 + 10 * k, 1e-3);
    }
  }
}

TEST(GyroRaw, AxesThatAreNotOursAreRefused) {
  SurveyTable table;
  EXPECT_EQ(WindowsOfGyroRaw(table, PointJob()).fault().code, FaultCode::kLost);
  GyroRawRecord g;
  g.inclination = FromDegrees(30);
  g.f = {9.81 * std::cos(g.inclination), 0, 9.81 * std::sin(g.inclination)};  // x along the hole
  table.head.gyro_raw.push_back(g);
  EXPECT_EQ(WindowsOfGyroRaw(table, PointJob()).fault().code, FaultCode::kConflict);
}

/// Tools at rest, horizontal to half a degree, as the equations of a tool's frame have it.
SurveyTable Horizontal(double latitude, double sign) {
  SurveyTable table;
  for (int k = 0; k < 4; ++k) {
    const double i = FromDegrees(89.5 + 0.3 * k), a = FromDegrees(20 + 100 * k), t = k;
    const Eigen::Vector3d up(std::sin(i) * std::cos(t), -std::sin(i) * std::sin(t), -std::cos(i));
    const Eigen::Vector3d north(
        std::cos(a) * std::cos(i) * std::cos(t) - std::sin(a) * std::sin(t),
        -std::cos(a) * std::cos(i) * std::sin(t) - std::sin(a) * std::cos(t),
        std::cos(a) * std::sin(i));
    GyroRawRecord g;
    g.number = k + 1;
    g.md = 30.0 * (k + 1);
    g.inclination = i;
    g.azimuth = a;
    g.f = sign * 9.81 * up;
    g.w = units::kDegPerHour * kRate * (std::cos(latitude) * north + std::sin(latitude) * up);
    g.w.z() = 0;  // no third axis
    table.head.gyro_raw.push_back(g);
  }
  return table;
}

// Both signs agree with inclinations within 2 deg of horizontal. The wrong one exchanges the high
// side with the low side, and so east with west: sin A is the rate across the vertical.
TEST(GyroRaw, HorizontalRecordsHaveTheirSignFromTheEarthsRate) {
  Job job = PointJob();
  for (const double latitude_deg : {59.75, 10.0, -25.0}) {
    for (const double sign : {1.0, -1.0}) {
      job.well.latitude = FromDegrees(latitude_deg);
      const SurveyTable table = Horizontal(job.well.latitude, sign);
      const Result<std::vector<StillWindow>> windows = WindowsOfGyroRaw(table, job);
      ASSERT_TRUE(windows) << windows.fault().text;
      const Eigen::Vector3d specific = sign * table.head.gyro_raw[0].f;
      EXPECT_LT((windows->front().f_T - specific).norm(), 1e-12) << latitude_deg << " " << sign;
    }
  }
}

TEST(GyroRaw, HorizontalRecordsWhoseSignNothingTellsAreRefused) {
  Job job = PointJob();
  job.well.latitude = FromDegrees(3);
  const SurveyTable near_equator = Horizontal(job.well.latitude, 1);
  const auto windows = WindowsOfGyroRaw(near_equator, job);
  ASSERT_FALSE(windows);
  EXPECT_EQ(windows.fault().code, FaultCode::kConflict);
  EXPECT_NE(windows.fault().text.find("horizontal"), std::string::npos);
  // Gyros that turn by something other than the Earth.
  job.well.latitude = FromDegrees(60);
  SurveyTable other = Horizontal(job.well.latitude, 1);
  for (GyroRawRecord& g : other.head.gyro_raw) g.w *= 0.2;
  EXPECT_FALSE(WindowsOfGyroRaw(other, job));
  // One record elsewhere tells it.
  SurveyTable one = near_equator;
  GyroRawRecord steep;
  steep.number = 5;
  steep.inclination = FromDegrees(60);
  steep.f = 9.81 * Eigen::Vector3d(std::sin(steep.inclination), 0, -std::cos(steep.inclination));
  one.head.gyro_raw.push_back(steep);
  job.well.latitude = FromDegrees(3);
  EXPECT_TRUE(WindowsOfGyroRaw(one, job));
}

}  // namespace
}  // namespace wellgyro
