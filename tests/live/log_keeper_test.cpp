// A recording whose disk fills and is freed again, and that only one program writes.
#include "wellgyro/live/log_keeper.h"

#include <chrono>
#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "wellgyro/bus/log_reader.h"

#include "support/scratch.h"

namespace wellgyro {
namespace {

struct Heard : LiveObserver {
  void OnNotice(std::string_view sentence) override { said.emplace_back(sentence); }
  std::vector<std::string> said;
};

/// A limit to what this process may write to a file, as a disk that is full.
class SmallDisk {
 public:
  explicit SmallDisk(rlim_t bytes) {
    ::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~SmallDisk() { ::setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  rlimit before_{};
};

std::vector<int> NumbersIn(const std::string& path) {
  std::vector<int> numbers;
  Result<LogReader> reader = LogReader::Open(path);
  LogEvent event;
  while (reader && reader->Next(event)) {
    numbers.push_back(std::to_integer<int>(event.data[0]) * 256 +
                      std::to_integer<int>(event.data[1]));
  }
  return numbers;
}

class Keeping : public ::testing::Test {
 protected:
  void Write(LogKeeper& log, int number) {
    std::vector<std::byte> data(1000);
    data[0] = static_cast<std::byte>(number / 256);
    data[1] = static_cast<std::byte>(number % 256);
    log.Write("CHANNEL", data, number);
  }

  std::int64_t now_ = 1;
  LiveClock clock_{[this] { return now_; }, [this] { return now_; }};
  Heard heard_;
  Notices notices_{heard_, clock_};
  support::Scratch scratch_;
};

TEST_F(Keeping, ADiskThatWasFullIsWrittenAgainAndNothingIsMissing) {
  const std::string path = (scratch_.path() / "heard.lcm").string();
  auto log = LogKeeper::Open(path, IfExists::kRefuse, clock_, notices_);
  ASSERT_TRUE(log) << log.fault().text;
  {
    const SmallDisk full(20'500);
    for (int i = 0; i < 100; ++i) Write(**log, i);
    EXPECT_TRUE((*log)->failing());
    now_ += 2'000'000;
    (*log)->Attend();
    EXPECT_TRUE((*log)->failing());
    EXPECT_EQ(NumbersIn(path).size(), 19u) << "whole events only";
  }
  now_ += 2'000'000;
  (*log)->Attend();
  EXPECT_FALSE((*log)->failing());
  for (int i = 100; i < 110; ++i) Write(**log, i);
  (*log)->Close();
  const std::vector<int> numbers = NumbersIn(path);
  ASSERT_EQ(numbers.size(), 110u);
  for (int i = 0; i < 110; ++i) EXPECT_EQ(numbers[static_cast<std::size_t>(i)], i);
  ASSERT_EQ(heard_.said.size(), 3u);
  EXPECT_NE(heard_.said[1].find("tried again"), std::string::npos);
  EXPECT_NE(heard_.said[2].find("is whole"), std::string::npos);
}

TEST_F(Keeping, WhatFindsNoRoomInMemoryIsCountedAndNamed) {
  const std::string path = (scratch_.path() / "heard.lcm").string();
  auto log = LogKeeper::Open(path, IfExists::kRefuse, clock_, notices_);
  ASSERT_TRUE(log);
  constexpr int kMessages = 40'000;  // of 1035 bytes
  {
    const SmallDisk full(10'000);
    for (int i = 0; i < kMessages; ++i) Write(**log, i);
  }
  EXPECT_GT((*log)->lost(), 5000);
  now_ += 2'000'000;
  (*log)->Attend();
  EXPECT_EQ(static_cast<std::int64_t>(NumbersIn(path).size()) + (*log)->lost(), kMessages);
  EXPECT_NE(heard_.said.back().find(std::to_string((*log)->lost()) + " messages are missing"),
            std::string::npos);
}

TEST_F(Keeping, ALogHasOneWriter) {
  const std::string path = (scratch_.path() / "heard.lcm").string();
  auto log = LogKeeper::Open(path, IfExists::kRefuse, clock_, notices_);
  ASSERT_TRUE(log);
  Write(**log, 1);
  const auto second = LogKeeper::Open(path, IfExists::kAppend, clock_, notices_);
  ASSERT_FALSE(second);
  EXPECT_NE(second.fault().text.find("another wellgyro"), std::string::npos);
  (*log)->Close();
  log->reset();
  EXPECT_TRUE(LogKeeper::Open(path, IfExists::kAppend, clock_, notices_));
}

}  // namespace
}  // namespace wellgyro
