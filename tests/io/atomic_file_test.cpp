#include "wellgyro/io/atomic_file.h"

#include <csignal>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "wellgyro/io/text_file.h"

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

TEST(WriteFiles, WhatCannotBeWrittenIsToldBefore) {
  const support::Scratch scratch;
  scratch.Write("held.txt", "as it was");
  EXPECT_FALSE(CannotWrite(scratch.path() / "held.txt"));
  EXPECT_FALSE(CannotWrite(scratch.path() / "new.txt"));
  EXPECT_FALSE(CannotWrite("/dev/null"));
  EXPECT_EQ(scratch.Read("held.txt"), "as it was");
  EXPECT_EQ(FilesIn(scratch.path()), 1u);
  const auto below_a_file = CannotWrite(scratch.path() / "held.txt" / "x.csv");
  ASSERT_TRUE(below_a_file);
  EXPECT_EQ(below_a_file->code, FaultCode::kIo);
  EXPECT_TRUE(CannotWrite(scratch.path()));
}

TEST(WriteFiles, LinksAreFollowedAndModesKept) {
  const support::Scratch scratch;
  scratch.Write("real/x.csv", "old");
  const auto real = scratch.path() / "real" / "x.csv";
  std::filesystem::permissions(real, std::filesystem::perms(0640));
  std::filesystem::create_symlink(real, scratch.path() / "link.csv");
  const std::vector<OutputFile> files{{"link.csv", "new"}};
  EXPECT_FALSE(WriteFiles(scratch.path(), files));
  EXPECT_TRUE(std::filesystem::is_symlink(scratch.path() / "link.csv"));
  EXPECT_EQ(scratch.Read("real/x.csv"), "new");
  EXPECT_EQ(std::filesystem::status(real).permissions(), std::filesystem::perms(0640));
  EXPECT_EQ(FilesIn(scratch.path() / "real"), 1u);
  // Dated 2026-11-23: a link that led to nothing yet was replaced by the file.
  std::filesystem::create_symlink("real/next.csv", scratch.path() / "link.csv.2");
  std::filesystem::create_symlink("link.csv.2", scratch.path() / "link.csv.1");
  EXPECT_FALSE(WriteFiles(scratch.path(), std::vector<OutputFile>{{"link.csv.1", "first"}}));
  EXPECT_EQ(scratch.Read("real/next.csv"), "first");
  EXPECT_TRUE(std::filesystem::is_symlink(scratch.path() / "link.csv.1"));
  EXPECT_TRUE(std::filesystem::is_symlink(scratch.path() / "link.csv.2"));
}

TEST(WriteFiles, PipesAreWrittenTo) {
  const support::Scratch scratch;
  const std::string pipe = (scratch.path() / "pipe").string();
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  const std::vector<OutputFile> files{{"pipe", "bytes"}};
  EXPECT_FALSE(WriteFiles(scratch.path(), files));
  char heard[8] = {};
  EXPECT_EQ(::read(reader, heard, sizeof heard), 5);
  EXPECT_STREQ(heard, "bytes");
  ::close(reader);
  EXPECT_EQ(FilesIn(scratch.path()), 1u);
}

TEST(WriteFiles, AFullDiskChangesNothing) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  const support::Scratch scratch;
  std::filesystem::create_symlink("/dev/full", scratch.path() / "x.csv");
  const std::vector<OutputFile> files{{"x.csv", "bytes"}};
  const auto fault = WriteFiles(scratch.path(), files);
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->code, FaultCode::kIo);
}

// Killed 200 times, in five parts, while it writes: the file holds one of the two texts, whole, and
// the next run leaves nothing beside it.
class Killed : public testing::TestWithParam<int> {};

TEST_P(Killed, WhileWritingLeavesWholeFiles) {
  const support::Scratch scratch;
  const std::vector<OutputFile> one{{"x.csv", std::string(300'000, '1')}};
  const std::vector<OutputFile> two{{"x.csv", std::string(200'000, '2')}};
  ASSERT_FALSE(WriteFiles(scratch.path(), one));
  int leftovers = 0;
  for (int k = GetParam(); k < 200; k += 5) {
    const pid_t child = ::fork();
    if (child == 0) {
      for (;;) {
        WriteFiles(scratch.path(), two);
        WriteFiles(scratch.path(), one);
      }
    }
    ::usleep(static_cast<useconds_t>(300 + 37 * k));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    const std::string text = scratch.Read("x.csv");
    ASSERT_TRUE(text == one[0].bytes || text == two[0].bytes) << text.size();
    leftovers += FilesIn(scratch.path()) > 1 ? 1 : 0;
  }
  std::printf("40 kills, %d of them left a temporary file\n", leftovers);
  ASSERT_FALSE(WriteFiles(scratch.path(), one));
  EXPECT_EQ(FilesIn(scratch.path()), 1u);
}

INSTANTIATE_TEST_SUITE_P(WriteFiles, Killed, testing::Range(0, 5));

TEST(ReadTextHead, OfFewerThanNoBytesIsAFault) {
  const auto head = ReadTextHead("/dev/null", -5);
  ASSERT_FALSE(head);
  EXPECT_EQ(head.fault().code, FaultCode::kRange);
}

}  // namespace
}  // namespace wellgyro
