#include "wellgyro/io/sensor/series_file.h"

#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "support/scratch.h"

namespace wellgyro {
namespace {

class SeriesFile : public testing::Test {
 protected:
  std::filesystem::path Put(const std::string& name, const std::string& bytes) const {
    folder_.Write(name, bytes);
    return folder_.path() / name;
  }
  Result<SampleSeries> Csv(const std::string& text, const SeriesColumns& columns = {}) const {
    return ReadCsvSeries(Put("a.csv", text), columns);
  }

 private:
  support::Scratch folder_;
};

using Values = std::vector<double>;

TEST_F(SeriesFile, UnitsAreThoseOfTheHeading) {
  const auto unit = [&](const std::string& heading) {
    const auto series = Csv(heading + "\n1\n2\n");
    return series ? series->unit : "refused";
  };
  for (const char* heading : {"GX[deg/h]", "GX(deg/h)", "gx_deg_per_h", "gx_dph"}) {
    EXPECT_EQ(unit(heading), "deg_per_h") << heading;
  }
  EXPECT_EQ(unit("gx_dps"), "deg_per_s");
  EXPECT_EQ(unit("gx_deg_per_s"), "deg_per_s");
  EXPECT_EQ(unit("ax_milli_g"), "milli_g");
  EXPECT_EQ(unit("GX[furlong]"), "refused");
  // Names that say nothing of a unit.
  for (const char* heading : {"gx", "gyro(raw)", "axes_s", "gx_ms"}) EXPECT_EQ(unit(heading), "");
  const auto timed = Csv("t_ms,gx\n0,1\n10,2\n20,3\n", {.value = "gx", .time = "t_ms"});
  ASSERT_TRUE(timed) << timed.fault().text;
  EXPECT_NEAR(timed->period, 0.01, 1e-12);
}

TEST_F(SeriesFile, ReadsLittleEndianNumbers) {
  const auto i16 =
      ReadBinarySeries(Put("a.i16", {"\x01\x00\xff\xff\x00\x80", 6}), SeriesType::kI16);
  ASSERT_TRUE(i16);
  EXPECT_EQ(i16->values, (Values{1, -1, -32768}));
  EXPECT_EQ(*i16->highest, 32767);
  const auto i32 =
      ReadBinarySeries(Put("a.i32", {"\x00\x00\x01\x00\xfe\xff\xff\xff", 8}), SeriesType::kI32);
  ASSERT_TRUE(i32);
  EXPECT_EQ(i32->values, (Values{65536, -2}));
  const auto f64 = ReadBinarySeries(Put("a.f64", {"\0\0\0\0\0\0\xf8\x3f", 8}), SeriesType::kF64);
  ASSERT_TRUE(f64);
  EXPECT_EQ(f64->values, (Values{1.5}));
}

TEST_F(SeriesFile, RefusesBytesThatAreNoSamples) {
  EXPECT_EQ(ReadBinarySeries(Put("a.f64", ""), SeriesType::kF64).fault().code, FaultCode::kForeign);
  EXPECT_EQ(ReadBinarySeries(Put("a.f64", {"\0\0\0", 3}), SeriesType::kF64).fault().code,
            FaultCode::kSize);
  EXPECT_EQ(ReadBinarySeries(Put("a.f64", "1.5\n2.5\n3.25\n"), SeriesType::kF64).fault().code,
            FaultCode::kForeign);
  EXPECT_EQ(
      ReadBinarySeries(Put("a.f64", {"\1\2\3\4\5\6\7\x7f", 8}), SeriesType::kF64).fault().code,
      FaultCode::kForeign);
  EXPECT_EQ(ReadBinarySeries("/no/such/file", SeriesType::kF64).fault().code, FaultCode::kIo);
}

TEST_F(SeriesFile, ReadsColumnsWithAndWithoutHeader) {
  EXPECT_EQ(Csv("1\n2.5\n\n# remark\n-3e2\n")->values, (Values{1, 2.5, -300}));
  EXPECT_EQ(Csv("a,b\r\n1,2\r\n3,4\r\n", {.value = "b"})->values, (Values{2, 4}));
  EXPECT_EQ(Csv("1;2\n3;4\n", {.value = "2"})->values, (Values{2, 4}));
  EXPECT_EQ(Csv("  1   2\n 3 4 \n", {.value = "1"})->values, (Values{1, 3}));
  EXPECT_EQ(Csv("x\ty\n+1\t2", {.value = "x"})->values, (Values{1}));
  const auto t = Csv("rate,temp\n1,20.5\n2,21\n", {.temperature = "temp"});
  ASSERT_TRUE(t);
  EXPECT_EQ(t->values, (Values{1, 2}));
  EXPECT_EQ(t->temperature, (std::vector<float>{20.5f, 21.f}));
}

TEST_F(SeriesFile, KeepsAPlaceForWhatIsMissing) {
  const auto series = Csv("n,y\n7,1\n8,2\n11,3\n", {.sequence = "n"});
  ASSERT_TRUE(series);
  ASSERT_EQ(series->values.size(), 5u);
  EXPECT_EQ(series->values[4], 3);
  ASSERT_EQ(series->gaps.size(), 1u);
  EXPECT_EQ(series->gaps[0].begin, 2);
  EXPECT_EQ(series->gaps[0].end, 4);
  const auto empty = Csv("a,b\n1,\n1,nan\n1,inf\n1,2\n", {.value = "b"});
  ASSERT_TRUE(empty);
  EXPECT_TRUE(std::isnan(empty->values[0]));
  EXPECT_TRUE(std::isnan(empty->values[1]));
  EXPECT_TRUE(std::isinf(empty->values[2]));
}

TEST_F(SeriesFile, SaysWhereACsvGoesWrong) {
  const auto word = Csv("a,b\n1,2\n3,four\n", {.value = "b"});
  ASSERT_FALSE(word);
  EXPECT_EQ(word.fault().line, 3);
  EXPECT_EQ(word.fault().column, 3);
  EXPECT_EQ(Csv("a,b\n1,2\n3\n", {.value = "b"}).fault().line, 3);
  EXPECT_EQ(Csv("1,2\n").fault().code, FaultCode::kConflict);
  EXPECT_EQ(Csv("a,b\n1,2\n", {.value = "c"}).fault().code, FaultCode::kRange);
  EXPECT_EQ(Csv("n,y\n2,1\n1,1\n", {.sequence = "n"}).fault().code, FaultCode::kOrder);
  const auto nowhere = Csv("y,n\n2,1\n1,\n", {.value = "y", .sequence = "n"});
  ASSERT_FALSE(nowhere);
  EXPECT_EQ(nowhere.fault().line, 3);
  EXPECT_EQ(nowhere.fault().column, 3);
  EXPECT_EQ(Csv("n,y\n2,1\n1e300,1\n", {.sequence = "n"}).fault().code, FaultCode::kRange);
  EXPECT_EQ(Csv("").fault().code, FaultCode::kForeign);
  EXPECT_EQ(Csv("# nothing\n").fault().code, FaultCode::kForeign);
  EXPECT_EQ(Csv(std::string("1\n\0\0", 4)).fault().code, FaultCode::kForeign);
}

TEST_F(SeriesFile, TellsTheTypeByEndingOrByBytes) {
  EXPECT_EQ(*SeriesTypeOfFile("x.i16"), SeriesType::kI16);
  EXPECT_EQ(*SeriesTypeOfFile("x.txt"), SeriesType::kCsv);
  EXPECT_EQ(*SeriesTypeOfFile(Put("log.dat", "1\n2\n")), SeriesType::kCsv);
  EXPECT_FALSE(SeriesTypeOfFile(Put("log.dat", {"\1\0\2\0", 4})));
  EXPECT_FALSE(SeriesTypeOf("f32"));
}

}  // namespace
}  // namespace wellgyro
