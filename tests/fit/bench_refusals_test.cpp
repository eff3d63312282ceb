// Readings that cannot give a calibration: the sentence says which rows, and what to do.
#include <functional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wellgyro/fit/affine_fit.h"
#include "wellgyro/fit/gyro_fit.h"
#include "wellgyro/fit/multi_station_fit.h"
#include "wellgyro/fit/position_fit.h"
#include "wellgyro/fit/scalar_fit.h"
#include "wellgyro/fit/thermometer_fit.h"

#include "fit/attitude_simulation.h"
#include "fit/bench_simulation.h"

namespace wellgyro::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

BenchTable Six() {
  Random random(1);
  return SixPositions(PulseTool::Any(random), {1e-5, 1, 2}, random);
}

BenchTable Volts() {
  Random random(2);
  return TwentyFour(VoltTool::Any(random), {0.1, 0.1, 1e-5}, random);
}

BenchTable Anywhere() {
  Random random(3);
  return AtAttitudes(VectorTool::Any(random), 24, {}, {2e-5, 20}, random);
}

BenchTable Without(BenchTable data, const std::function<bool(int)>& drop) {
  std::vector<Eigen::Index> kept;
  std::vector<int> lines;
  for (int i = 0; i < data.rows(); ++i) {
    if (drop(i)) continue;
    kept.push_back(i);
    lines.push_back(data.lines[static_cast<std::size_t>(i)]);
  }
  data.values = Eigen::MatrixXd(data.values(kept, Eigen::all));
  data.lines = lines;
  return data;
}

template <class T>
Fault FaultOf(const Result<T>& result) {
  EXPECT_FALSE(result.has_value());
  return result.has_value() ? Fault{} : result.fault();
}

const ScalarSetup kScalar{};
const AffineSetup kAffine{};

TEST(BenchRefusals, TooFewReadings) {
  const BenchTable few = Without(Anywhere(), [](int i) { return i >= 9; });
  EXPECT_THAT(FaultOf(FitScalar(few, kScalar)).text,
              AllOf(HasSubstr("9 attitudes are too few, 12 are needed"), HasSubstr("18 to 24")));
  const BenchTable five = Without(Six(), [](int i) { return i == 4 || i == 5; });
  EXPECT_THAT(FaultOf(FitSixPositions(five, {})).text, HasSubstr("measure y up"));
  const BenchTable lost = Without(Volts(), [](int i) { return i >= 12 && i < 15; });
  EXPECT_THAT(FaultOf(FitTwentyFourPositions(lost, {.settle_tolerance = 1e-3})).text,
              HasSubstr("readings are missing: x up at 90 deg, channel y; measure these"));
  const BenchTable single = Without(Volts(), [](int i) { return i % 3 == 2; });
  EXPECT_THAT(FaultOf(FitTwentyFourPositions(single, {})).text,
              HasSubstr("x up at 0 deg, channel x: 2 readings, three that repeat are needed"));
}

TEST(BenchRefusals, FacesAloneDoNotDoWithoutATurntable) {
  Random random(4);
  VectorTool tool = VectorTool::Any(random);
  TableMaker table({"ax", "ay", "az"});
  for (int at = 0; at < 24; ++at) {
    std::vector<double> row;
    const Eigen::Vector3d u = (at % 2 == 0 ? 1.0 : -1.0) * Eigen::Vector3d::Unit(at / 8);
    Append(row, tool.Ka * u + tool.ba + Noise(random, 1e-9));
    table.Add(row);
  }
  EXPECT_THAT(
      FaultOf(FitScalar(table.Finish(), kScalar)).text,
      AllOf(HasSubstr("do not determine"), HasSubstr("M["), HasSubstr("gravity between the axes")));
}

TEST(BenchRefusals, WrongSignsAndSwappedUpAndDown) {
  BenchTable six = Six();
  six.values.col(4) *= -1;  // Ny
  EXPECT_THAT(FaultOf(FitSixPositions(six, {})).text,
              HasSubstr("its sign is wrong, or up and down of y are swapped"));
  BenchTable volts = Volts();
  for (int i = 0; i < volts.rows(); ++i) {
    if (volts.values(i, 0) == 2) volts.values(i, 1) *= -1;  // z, up and down
  }
  EXPECT_THAT(FaultOf(FitTwentyFourPositions(volts, {.settle_tolerance = 1e-3})).text,
              HasSubstr("up and down of z are swapped"));
  BenchTable crossed = Anywhere();
  crossed.values.col(3).swap(crossed.values.col(4));
  EXPECT_THAT(FaultOf(FitAffine(crossed, kAffine)).text,
              AllOf(HasSubstr("channel Gx follows y"), HasSubstr("exchange the columns")));
  Random random(5);
  BenchTable gyros = GyrosAtRest(GyroTool::Any(random), 45, 0.01, random);
  gyros.values.col(6) *= -1;
  EXPECT_THAT(FaultOf(FitGyro(gyros, {}, {.reference = {.latitude = 45 * kRad}})).text,
              HasSubstr("channel m_x1 falls where the rate about x rises"));
  BenchTable forces = GyrosAtRest(GyroTool::Any(random), 45, 0.01, random);
  forces.values.middleCols(3, 3) *= -1;
  const Fault fault = FaultOf(FitGyro(forces, {}, {.reference = {.latitude = 45 * kRad}}));
  EXPECT_THAT(fault.text, HasSubstr("fx, fy, fz do not fit inc and tf"));
  EXPECT_EQ(fault.line, 2);
}

TEST(BenchRefusals, RepeatedRows) {
  BenchTable data = Anywhere();
  data.values.row(7) = data.values.row(2);
  const Fault fault = FaultOf(FitScalar(data, kScalar));
  EXPECT_THAT(fault.text, HasSubstr("line 9 repeats line 4"));
  EXPECT_EQ(fault.line, 9);
  BenchTable six = Six();
  six.values.row(3) = six.values.row(2);
  EXPECT_THAT(FaultOf(FitSixPositions(six, {})).text, HasSubstr("line 5 repeats line 4"));
  // Of counts with a count of noise two readings are alike by chance.
  six = Six();
  six.values = six.values.array().round();
  six.values.row(3) = six.values.row(2);
  const auto counts = FitSixPositions(six, {});
  EXPECT_TRUE(counts.has_value() || counts.fault().text.find("repeats") == std::string::npos);
}

TEST(BenchRefusals, RepeatedReadingsUnderOtherLabels) {
  BenchTable data = Anywhere();
  const auto channels = data.values.cols() - 3;
  data.values.row(7).tail(channels) = data.values.row(2).tail(channels);
  EXPECT_THAT(FaultOf(FitAffine(data, kAffine)).text,
              HasSubstr("line 9 repeats the readings of line 4"));
  Random random(8);
  BenchTable gyros = GyrosAtRest(GyroTool::Any(random), 45, 0.01, random);
  gyros.values.row(30).tail(4) = gyros.values.row(31).tail(4);
  EXPECT_THAT(FaultOf(FitGyro(gyros, {}, {.reference = {.latitude = 45 * kRad}})).text,
              HasSubstr("line 33 repeats the readings of line 32"));
  // Of two channels that fewer rows read, one copy may be chance and four are not.
  gyros = WithoutColumns(GyrosAtRest(GyroTool::Any(random), 45, 0.01, random), {"m_z2", "m_x2"});
  for (int k = 0; k < 4; ++k) gyros.values.row(30 + k).tail(2) = gyros.values.row(40 + k).tail(2);
  EXPECT_THAT(FaultOf(FitGyro(gyros, {}, {.reference = {.latitude = 45 * kRad}})).text,
              HasSubstr("line 42 repeats the readings of line 32"));
  // Rounded as coarsely as the noise, readings repeat by chance.
  gyros = GyrosAtRest(GyroTool::Any(random), 45, 0.01, random);
  gyros.values.rightCols(4) = (gyros.values.rightCols(4) * 10).array().round() / 10;
  gyros.values.row(30).tail(4) = gyros.values.row(31).tail(4);
  EXPECT_TRUE(FitGyro(gyros, {}, {.reference = {.latitude = 45 * kRad}}).has_value());
}

TEST(BenchRefusals, FrozenChannels) {
  BenchTable data = Anywhere();
  data.values.col(5).setConstant(0.25);
  EXPECT_THAT(FaultOf(FitScalar(data, kScalar)).text,
              HasSubstr("column Gz reads 0.25 in all 24 rows: the channel is frozen"));
  BenchTable volts = Volts();
  for (int i = 0; i < volts.rows(); ++i) {
    if (volts.values(i, 3) == 1) volts.values(i, 5) = 1.5;
  }
  EXPECT_THAT(FaultOf(FitTwentyFourPositions(volts, {.settle_tolerance = 1e-3})).text,
              HasSubstr("column y reads 1.5 in all 24 rows"));
}

TEST(BenchRefusals, MixedUnits) {
  BenchTable data = Anywhere();
  data.values.block(4, 3, 3, 3) *= 9.80665;
  const Fault fault = FaultOf(FitScalar(data, kScalar));
  EXPECT_THAT(fault.text, AllOf(HasSubstr("lines 6, 7, 8"), HasSubstr("units are mixed")));
  BenchTable six = Six();
  six.values.block(0, 3, 4, 3) /= 1000;
  EXPECT_THAT(FaultOf(FitSixPositions(six, {})).text, HasSubstr("units are mixed"));
  BenchTable radians = Anywhere();
  radians.values.leftCols(3) *= kRad;
  EXPECT_THAT(FaultOf(FitAffine(radians, kAffine)).text, HasSubstr("look like radians"));
  Random random(6);
  BenchTable gyros = GyrosAtRest(GyroTool::Any(random), 45, 0.01, random);
  gyros.values.rightCols(4) /= 3600;
  EXPECT_THAT(FaultOf(FitGyro(gyros, {}, {.reference = {.latitude = 45 * kRad}})).text,
              HasSubstr("deg/h"));
}

TEST(BenchRefusals, ReadingsThatHaveNotSettled) {
  Random random(7);
  const BenchTable drifting = TwentyFour(
      VoltTool::Any(random),
      {.sigma = 1e-5, .readings = 20, .transient = 5e-3, .transient_readings = 15}, random);
  EXPECT_THAT(FaultOf(FitTwentyFourPositions(drifting, {})).text,
              HasSubstr("x up at 0 deg, channel x: the readings have not settled"));
}

TEST(BenchRefusals, SwappedInSomePositionsOnly) {
  BenchTable volts = Volts();
  std::vector<int> swapped;
  for (int i = 0; i < volts.rows(); ++i) {
    if (volts.values(i, 0) == 0 && volts.values(i, 2) == 90) {
      volts.values(i, 1) *= -1;
      if (volts.values(i, 3) == 0 && volts.values(i, 4) == 0)
        swapped.push_back(volts.lines[static_cast<std::size_t>(i)]);
    }
  }
  const Fault fault = FaultOf(FitTwentyFourPositions(volts, {.settle_tolerance = 1e-3}));
  EXPECT_THAT(fault.text, AllOf(HasSubstr("up and down are swapped in these positions"),
                                HasSubstr(std::to_string(swapped.at(1)))));
  EXPECT_EQ(fault.line, swapped.at(0));
}

TEST(BenchRefusals, HalfOfTheGyrosRowsInAnotherUnit) {
  Random random(8);
  BenchTable gyros = GyrosAtRest(GyroTool::Any(random), 45, 0.01, random);
  gyros.values.bottomRightCorner(60, 4) /= 3600;
  EXPECT_THAT(FaultOf(FitGyro(gyros, {}, {.reference = {.latitude = 45 * kRad}})).text,
              AllOf(HasSubstr("the readings do not fit"), HasSubstr("mixed units")));
}

TEST(BenchRefusals, SignsAndColumnsOfTwoSensorsThatMustAgree) {
  BenchTable both = Anywhere();
  const ScalarSetup setup{.reference = {.field = 50'000, .dip = 60 * kRad}};
  ASSERT_TRUE(FitScalarDip(both, setup).has_value());
  both.values.middleCols(3, 3) *= -1;
  EXPECT_THAT(FaultOf(FitScalarDip(both, setup)).text, HasSubstr("sign"));
  both = Anywhere();
  both.values.col(6).swap(both.values.col(7));
  EXPECT_THAT(FaultOf(FitScalarDip(both, setup)).text, HasSubstr("exchange the columns"));
  Random random(9);
  BenchTable run = Stations({20, 30, 40}, {0, 0, 0}, {50'500, 71}, 5, 1e-4, random);
  const MultiStationSetup stations{.reference = {.field = 50'500, .dip = 71 * kRad}};
  ASSERT_TRUE(FitMultiStation(run, stations).has_value());
  run.values.leftCols(3) *= -1;
  EXPECT_THAT(FaultOf(FitMultiStation(run, stations)).text,
              HasSubstr("the sign of the accelerometers is wrong"));
}

TEST(BenchRefusals, ThermometersInAnotherUnit) {
  TableMaker table({"t_m", "ref1"});
  for (int i = 0; i < 10; ++i) table.Add({20.0 + 15 * i, 68.0 + 27 * i + 0.1 * (i % 3)});
  EXPECT_THAT(FaultOf(FitThermometer(table.Finish(), {})).text, HasSubstr("degC"));
}

TEST(BenchRefusals, MissingColumns) {
  BenchTable data = Six();
  data.columns[2] = "T";
  EXPECT_THAT(FaultOf(FitSixPositions(data, {})).text, HasSubstr("no column T_s; it has axis"));
  EXPECT_THAT(FaultOf(FitThermometer(data, {})).text, HasSubstr("no column t_m"));
}

}  // namespace
}  // namespace wellgyro::test
