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

}  // namespace
}  // namespace wellgyro
