#include "wellgyro/io/sensor/bench_data.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace wellgyro {
namespace {

TEST(BenchData, ReadsWordsCommentsAndAnySeparator) {
  const auto table = ParseBenchTable(
      "\xEF\xBB\xBF# made by hand\r\naxis;dir; volt\r\n\r\nx;up;3.5\r\n z ; down ; -1e-3 \r\n",
      "b");
  ASSERT_TRUE(table.has_value()) << table.fault().text;
  EXPECT_THAT(table->columns, testing::ElementsAre("axis", "dir", "volt"));
  ASSERT_EQ(table->rows(), 2);
  EXPECT_EQ(table->values.row(0), Eigen::RowVector3d(0, 1, 3.5));
  EXPECT_EQ(table->values.row(1), Eigen::RowVector3d(2, -1, -1e-3));
  EXPECT_THAT(table->lines, testing::ElementsAre(4, 5));
  EXPECT_EQ(*table->Find("dir"), 1);
  EXPECT_FALSE(table->Find("dirt").has_value());
}

TEST(BenchData, ColumnNamesMayBeginAsNumbersDo) {
  const auto table = ParseBenchTable("info,2nd\r\n1,2\r\n", "b");
  ASSERT_TRUE(table.has_value()) << table.fault().text;
  EXPECT_THAT(table->columns, testing::ElementsAre("info", "2nd"));
}

TEST(BenchData, NamesLineAndColumnOfWhatIsWrong) {
  const auto fault = [](std::string_view text) {
    const auto table = ParseBenchTable(text, "b");
    EXPECT_FALSE(table.has_value()) << text;
    return table.has_value() ? Fault{} : table.fault();
  };
  EXPECT_EQ(fault("").code, FaultCode::kForeign);
  EXPECT_EQ(fault("a,b\n").code, FaultCode::kForeign);
  EXPECT_EQ(fault("1,2\n3,4\n").text, "the first line must name the columns; it holds numbers");
  const Fault cell = fault("a,b\n1,2\n3,4o\n");
  EXPECT_EQ(cell.text, "\"4o\" in column b is no number");
  EXPECT_EQ(cell.line, 3);
  EXPECT_EQ(cell.column, 3);
  const Fault empty = fault("a,b\n1,\n");
  EXPECT_EQ(empty.line, 2);
  EXPECT_EQ(empty.column, 3);
  EXPECT_EQ(fault("a,b\n1,nan\n").code, FaultCode::kSyntax);
  EXPECT_EQ(fault("a,b\n1,1e999\n").code, FaultCode::kSyntax);
  EXPECT_EQ(fault("a,b\n1\n").text, "1 cells where the header names 2 columns");
  EXPECT_EQ(fault("axis,a\nx,up\n").text, "\"up\" in column a is no number");
  EXPECT_EQ(fault("axis,dir\nx,x\n").code, FaultCode::kSyntax);
  EXPECT_EQ(fault("a,a\n1,2\n").code, FaultCode::kConflict);
  EXPECT_EQ(fault("a,b\n1,2e15\n").text, "\"2e15\" in column b is larger than any reading");
}

TEST(BenchData, TemperaturesInKelvinAreRefused) {
  EXPECT_TRUE(ParseBenchTable("a,T_C\n1,-40\n2,200\n", "b").has_value());
  const auto table = ParseBenchTable("a,T_C\n1,298.15\n", "b");
  ASSERT_FALSE(table.has_value());
  EXPECT_EQ(table.fault().text,
            "\"298.15\" in column T_C is no temperature of a bench, -150 to 260 degC: is it in "
            "kelvin or degF?");
  EXPECT_EQ(table.fault().column, 3);
}

}  // namespace
}  // namespace wellgyro
