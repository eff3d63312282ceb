#include "wellgyro/io/sensor/sensor_csv.h"

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/io/sensor/sensor_files.h"

#include "support/scratch.h"

namespace wellgyro {
namespace {

using support::Scratch;

TEST(SensorCsv, NamesTheLineAndColumnOfWhatItCannotUse) {
  struct Case {
    const char *text, *says;
    int line, column;
  };
  const std::string header = "TOOL[s],GX[deg/h],GY[deg/h],AX[g],AY[g],AZ[g]\n";
  for (const Case& c : std::initializer_list<Case>{
           {"0,1,2,0,0,-1\n0.1,1,x,0,0,-1\n", "\"x\" is no number", 3, 7},
           {"0,1,2,0,0,-1\n0.1,1,2,0,0,-1\n0.1,1,3,0,0,-1\n", "time does not go on", 4, 1},
           {"0,1,2,0,0,-1\nzero,1,2,0,0,-1\n", "is no number", 3, 1},
           {"0,1,2,0,0,-1\n1e300,1,2,0,0,-1\n", "is no time", 3, 1},
           {"0,1,2,0,0,-1\n9,1,2,0,0,-1\n", "two seconds apart", 0, 0},
           {"0,1,2,0,0,-1\n", "fewer than two samples", 0, 0}}) {
    const Scratch scratch;
    scratch.Write("a.csv", header + c.text);
    Result<SensorCsv> table = SensorCsv::Open(scratch.path() / "a.csv");
    std::optional<Fault> fault;
    if (table) {
      SensorCsv::Row row;
      while (table->Next(row)) {
      }
      fault = table->fault();
    } else {
      fault = table.fault();
    }
    ASSERT_TRUE(fault) << c.text;
    EXPECT_NE(fault->text.find(c.says), std::string::npos) << fault->text;
    if (c.line > 0) {
      EXPECT_EQ(fault->line, c.line);
      EXPECT_EQ(fault->column, c.column);
    }
  }
}

TEST(SensorCsv, SaysWhichColumnIsMissingOrUnknown) {
  EXPECT_FALSE(SensorTableOf("md,inc,azi"));
  EXPECT_EQ(SensorTableOf("UTC[us],MD[ft]"), SensorTable::kDepth);
  const Scratch scratch;
  scratch.Write("a.csv", "UTC[us],MD[fathom]\n1,2\n");
  EXPECT_NE(SensorCsv::Open(scratch.path() / "a.csv").fault().text.find("[fathom]"),
            std::string::npos);
  scratch.Write("a.csv", "UTC[us],MD[m],WHAT\n1,2,3\n");
  EXPECT_NE(SensorCsv::Open(scratch.path() / "a.csv").fault().text.find("WHAT"), std::string::npos);
  for (const auto& [text, says] : std::vector<std::pair<std::string, std::string>>{
           {"UTC[us],GX[deg/h],GY[deg/h],AX[g],AZ[g]\n1,2,3,4,5\n", "samples lacks AY"},
           {"GX[deg/h],GY[deg/h],AX[g],AY[g],AZ[g]\n1,2,3,4,5\n", "samples lacks UTC or TOOL"},
           {"TOOL[s],DURATION[s],GY[deg/h],AX[g],AY[g],AZ[g]\n1,2,3,4,5,6\n",
            "averages lacks GX, UTC"},
           {"MD[m]\n1\n", "depths lacks UTC"},
           {"UTC[us],TEMP[degC]\n1,2\n", "depths lacks MD or LENGTH"},
           {"a,b,c\n1,2,3\n", "text of an unknown kind, no table"},
           {"MD[m],WHAT\n1,2\n", "WHAT"},
           {"UTC,MD\n1,2\n", "UTC has no unit that is known: []; known are ns, us,"},
           {"TOOL[s],RUN[m]\n1,2\n", "RUN takes no unit, not [m]"},
           {"UTC[us],MD[fathom]\n1,2\n", "MD has no unit that is known: [fathom]; known are m, ft"},
           {"TOOL[s],AX[m/s]\n1,2\n", "[m/s]; known are m/s2, g, mg"},
           {"TOOL[s],AX[mgs]\n1,2\n", "[mgs]; known are mg, m/s2, g"},
           {"TOOL[s],TEMP[K]\n1,2\n", "TEMP takes degC or no unit, not [K]"},
           {"TOOL[s],GYY[deg/h]\n1,2\n",
            "is not known; is GY meant? Known are UTC, END_UTC, TOOL,"},
           {"TOOL[s],gz[deg/h]\n1,2\n", "is not known; is GZ meant?"},
           {"TOOL[s],GX[deg/h],FX[m/s2]\n1,2,3\n", "is not known; is AX meant?"},
           {"TOOL[s],GX[deg/h],QX[g]\n1,2,3\n", "is not known; is AX meant?"},
           {"UTC[s],DEPTH[m]\n1,2\n", "is not known; is MD meant?"},
           {"TOOL[s],WHAT\n1,2\n", "column \"WHAT\" is not known; known are UTC, END_UTC, TOOL,"},
           {"\xED\xA1\xDA\x01\x01\x02,\xFF", "an LCM log, no table"}}) {
    scratch.Write("a.csv", text);
    const Result<SensorCsv> table = SensorCsv::Open(scratch.path() / "a.csv");
    ASSERT_FALSE(table) << text;
    EXPECT_NE(table.fault().text.find(says), std::string::npos) << table.fault().text;
    EXPECT_EQ(IsSensorTable(scratch.path() / "a.csv"), says.find("no table") == std::string::npos);
  }
  EXPECT_FALSE(SensorCsv::Open(scratch.path() / "absent.csv"));
  EXPECT_FALSE(SensorCsv::Open(scratch.path()));
}

TEST(SensorCsv, AnEmptyFieldHasAPlaceToo) {
  const Scratch scratch;
  scratch.Write("a.csv", "UTC[s],MD[m],RUN\n100,10,1\n101, ,1\n");
  Result<SensorCsv> table = SensorCsv::Open(scratch.path() / "a.csv");
  ASSERT_TRUE(table) << table.fault().text;
  SensorCsv::Row row;
  EXPECT_TRUE(table->Next(row));
  EXPECT_FALSE(table->Next(row));
  ASSERT_TRUE(table->fault());
  EXPECT_EQ(table->fault()->text, "a depth is missing");
  EXPECT_EQ(table->fault()->line, 3);
  EXPECT_EQ(table->fault()->column, 5);
}

/// Of all samples, without a fault.
std::vector<std::int64_t> SeqsOf(SensorCsv& table) {
  std::vector<std::int64_t> seqs;
  SensorCsv::Row row;
  while (table.Next(row)) seqs.push_back(std::get<ImuSample>(row).stamp.seq);
  EXPECT_FALSE(table.fault());
  return seqs;
}

TEST(SensorCsv, GapsAndMissingValuesAreLostSamples) {
  const Scratch scratch;
  scratch.Write("a.csv",
                "\xEF\xBB\xBFTOOL[ms],GX[deg/h],GY[deg/h],AX[g],AY[g],AZ[g]\r\n0,1,2,0,0,-1\r\n"
                "100,1,2,0,0,-1\r\n200,,2,0,0,-1\r\n300,1,2,0,0,-1\r\n700,1,2,0,0,-1\r\n");
  Result<SensorCsv> table = SensorCsv::Open(scratch.path() / "a.csv");
  ASSERT_TRUE(table) << table.fault().text;
  EXPECT_EQ(SeqsOf(*table), (std::vector<std::int64_t>{0, 1, 3, 7}));
}

TEST(SensorCsv, ARowThatIsThereTwiceCountsOnce) {
  const Scratch scratch;
  scratch.Write("a.csv",
                "TOOL[ms],GX[deg/h],GY[deg/h],AX[g],AY[g],AZ[g]\n0,1,2,0,0,-1\n100,1,2,0,0,-1\n"
                "100,1,2,0,0,-1\n# a remark\n100,1,2,0,0,-1\n200,1,2,0,0,-1\n");
  Result<SensorCsv> table = SensorCsv::Open(scratch.path() / "a.csv");
  ASSERT_TRUE(table) << table.fault().text;
  EXPECT_EQ(SeqsOf(*table), (std::vector<std::int64_t>{0, 1, 2}));
  EXPECT_EQ(table->repeated().count, 2);
  EXPECT_EQ(table->repeated().first_line, 4);
}

TEST(SensorCsv, ARowAtRestIsMarksAllTheWhile) {
  const Scratch scratch;
  scratch.Write("a.csv", "UTC[s],END_UTC[s],LENGTH[ft]\n100,110,30\n200,200,100\n");
  Result<SensorCsv> table = SensorCsv::Open(scratch.path() / "a.csv");
  ASSERT_TRUE(table);
  std::vector<DepthMark> marks;
  SensorCsv::Row row;
  while (table->Next(row)) marks.push_back(std::get<DepthMark>(row));
  ASSERT_EQ(marks.size(), 5u);
  EXPECT_EQ(marks[1].utc.ns, 104'000'000'000);
  EXPECT_EQ(marks[3].utc.ns, 110'000'000'000);
  EXPECT_TRUE(marks[3].stopped);
  EXPECT_NEAR(marks[3].md, 9.144, 1e-12);
  EXPECT_NEAR(marks[4].md, 39.624, 1e-12);
  EXPECT_EQ(marks[4].kind, DepthKind::kDrillPipe);
}

}  // namespace
}  // namespace wellgyro
