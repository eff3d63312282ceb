#include "wellgyro/io/result/result_folder.h"

#include <vector>

#include <gmock/gmock.h>

#include "support/scratch.h"

namespace wellgyro {
namespace {

using testing::HasSubstr;

TEST(WriteResult, NeverGoesOverAnAcceptedOne) {
  const support::Scratch scratch;
  const std::vector<OutputFile> accepted{
      {"run.toml", "format = \"wellgyro.run/1\"\naccepted = true\n"}};
  const std::vector<OutputFile> open{
      {"run.toml", "format = \"wellgyro.run/1\"\naccepted = false\n"}};
  EXPECT_FALSE(WriteResult(scratch.path(), open));
  EXPECT_FALSE(WriteResult(scratch.path(), accepted));
  const auto fault = WriteResult(scratch.path(), open);
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->code, FaultCode::kConflict);
  EXPECT_THAT(fault->text, HasSubstr("choose a new --out"));
  EXPECT_EQ(scratch.Read("run.toml"), accepted[0].bytes);
}

TEST(WriteResult, ADefinitiveStationIsEnough) {
  const support::Scratch scratch;
  scratch.Write("passes.csv", "RUN,PASS,STATUS,REVISION\n1,in,field,1,\n");
  EXPECT_FALSE(*HoldsAcceptedResult(scratch.path()));
  scratch.Write("passes.csv", "RUN,PASS,STATUS,REVISION\n1,in,definitive,1,\n");
  EXPECT_TRUE(*HoldsAcceptedResult(scratch.path()));
  EXPECT_TRUE(WriteResult(scratch.path(), std::vector<OutputFile>{{"passes.csv", ""}}));
}

TEST(WriteResult, WhatCannotBeReadIsNotWrittenOver) {
  const support::Scratch scratch;
  scratch.Write("run.toml", "accepted = tru");
  const auto fault = WriteResult(scratch.path(), std::vector<OutputFile>{{"run.toml", "x = 1"}});
  ASSERT_TRUE(fault);
  EXPECT_THAT(fault->text, HasSubstr("choose a new --out"));
  EXPECT_EQ(scratch.Read("run.toml"), "accepted = tru");
}

TEST(WriteResult, AnEmptyOrAbsentFolderIsFree) {
  const support::Scratch scratch;
  EXPECT_FALSE(*HoldsAcceptedResult(scratch.path() / "absent"));
  EXPECT_FALSE(*HoldsAcceptedResult(scratch.path()));
}

}  // namespace
}  // namespace wellgyro
