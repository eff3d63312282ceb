#include "wellgyro/io/atomic_file.h"

#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "support/scratch.h"

namespace wellgyro {
namespace {

using testing::HasSubstr;

std::size_t FilesIn(const std::filesystem::path& folder) {
  const std::filesystem::directory_iterator files(folder);
  return static_cast<std::size_t>(std::distance(begin(files), end(files)));
}

TEST(WriteFiles, WritesAndReplacesWhole) {
  const support::Scratch scratch;
  const auto out = scratch.path() / "a" / "b";
  const std::vector<OutputFile> first{{"x.csv", std::string(100'000, 'x')}, {"tool-1/y.csv", "y"}};
  EXPECT_FALSE(WriteFiles(out, first));
  EXPECT_EQ(scratch.Read("a/b/x.csv"), first[0].bytes);
  EXPECT_EQ(scratch.Read("a/b/tool-1/y.csv"), "y");
  const std::vector<OutputFile> second{{"x.csv", "short"}};
  EXPECT_FALSE(WriteFiles(out, second));
  EXPECT_EQ(scratch.Read("a/b/x.csv"), "short");
  EXPECT_EQ(FilesIn(out), 2u);
}

TEST(WriteFiles, WhenOneCannotBeWrittenNoneIsChanged) {
  const support::Scratch scratch;
  scratch.Write("out/x.csv", "old");
  scratch.Write("out/blocked", "a file where a folder is wanted");
  const std::vector<OutputFile> files{{"x.csv", "new"}, {"blocked/y.csv", "y"}};
  const auto fault = WriteFiles(scratch.path() / "out", files);
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->code, FaultCode::kIo);
  EXPECT_THAT(fault->source, HasSubstr("blocked"));
  EXPECT_EQ(scratch.Read("out/x.csv"), "old");
  EXPECT_EQ(FilesIn(scratch.path() / "out"), 2u);
}

TEST(WriteFiles, ATargetThatIsAFolderIsAFault) {
  const support::Scratch scratch;
  scratch.Write("x.csv/inside", "");
  const std::vector<OutputFile> files{{"x.csv", "new"}};
  EXPECT_TRUE(WriteFiles(scratch.path(), files));
  EXPECT_EQ(FilesIn(scratch.path()), 1u);
}

}  // namespace
}  // namespace wellgyro
