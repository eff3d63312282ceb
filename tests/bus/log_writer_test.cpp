#include "wellgyro/bus/log_writer.h"

#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lcm/lcm-cpp.hpp>

#include "bus/log_file.h"

namespace wellgyro::test {
namespace {

Bytes Data(std::size_t size, int first) {
  Bytes data(size);
  for (std::size_t i = 0; i < size; ++i) {
    data[i] = static_cast<std::byte>(static_cast<std::size_t>(first) + i);
  }
  return data;
}

TEST(LogWriter, LiblcmReadsWhatItWrites) {
  const TestFile file;
  auto writer = LogWriter::Open(file.path());
  ASSERT_TRUE(writer);
  for (int i = 0; i < 300; ++i) {
    const std::string channel(static_cast<std::size_t>(1 + i % 63), 'C');
    ASSERT_FALSE(writer->Write(channel, Data(static_cast<std::size_t>(i * 37), i), 1000 + i));
  }
  EXPECT_EQ(writer->events(), 300);
  ASSERT_FALSE(writer->Close());
  EXPECT_EQ(static_cast<std::uintmax_t>(writer->bytes()), std::filesystem::file_size(file.path()));

  lcm::LogFile log(file.path(), "r");
  ASSERT_TRUE(log.good());
  for (int i = 0; i < 300; ++i) {
    const lcm::LogEvent* event = log.readNextEvent();
    ASSERT_NE(event, nullptr) << i;
    EXPECT_EQ(event->eventnum, i);
    EXPECT_EQ(event->timestamp, 1000 + i);
    EXPECT_EQ(event->channel, std::string(static_cast<std::size_t>(1 + i % 63), 'C'));
    const auto* data = static_cast<const std::byte*>(event->data);
    EXPECT_EQ(Bytes(data, data + event->datalen), Data(static_cast<std::size_t>(i * 37), i));
  }
  EXPECT_EQ(log.readNextEvent(), nullptr);
}

TEST(LogWriter, FlushAndOnlyWholeEvents) {
  const TestFile file;
  auto writer = LogWriter::Open(file.path());
  ASSERT_TRUE(writer);
  ASSERT_FALSE(writer->Write("A", Data(10, 0), 1));
  EXPECT_EQ(std::filesystem::file_size(file.path()), 0U);
  ASSERT_FALSE(writer->Flush());
  EXPECT_EQ(std::filesystem::file_size(file.path()), 39U);
  const std::size_t event = 28 + 1 + 300'000;
  for (int i = 0; i < 4; ++i) {
    ASSERT_FALSE(writer->Write("A", Data(300'000, 0), 1));
    EXPECT_EQ((std::filesystem::file_size(file.path()) - 39) % event, 0U);
  }
  EXPECT_EQ(std::filesystem::file_size(file.path()), 39 + 4 * event) << "a block has gathered";
}

TEST(LogWriter, ExistingFilesStayUnlessAsked) {
  const TestFile file;
  file.Fill(Data(5, 0));
  const auto refused = LogWriter::Open(file.path());
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.fault().text, testing::HasSubstr("exists; choose another name"));
  EXPECT_EQ(file.Contents(), Data(5, 0));
  { ASSERT_TRUE(LogWriter::Open(file.path(), IfExists::kReplace)); }
  EXPECT_EQ(std::filesystem::file_size(file.path()), 0U);
}

TEST(LogWriter, AppendsBehindTheLastWholeEventWhereverTheLogWasCut) {
  const TestFile file;
  {
    auto writer = LogWriter::Open(file.path(), IfExists::kAppend);
    ASSERT_TRUE(writer);
    for (int i = 0; i < 3; ++i) ASSERT_FALSE(writer->Write("A", Data(11, i), i));
  }
  const Bytes whole = file.Contents();
  ASSERT_EQ(whole.size(), 120u);
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    file.Fill(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)));
    auto writer = LogWriter::Open(file.path(), IfExists::kAppend);
    ASSERT_TRUE(writer) << size << ": " << writer.fault().text;
    ASSERT_FALSE(writer->Write("A", Data(11, 7), 7));
    ASSERT_FALSE(writer->Close());
    auto reader = LogReader::Open(file.path());
    ASSERT_TRUE(reader) << size;
    const Read read = ReadAll(*reader);
    ASSERT_EQ(read.events.size(), size / 40 + 1) << size;
    EXPECT_TRUE(read.faults.empty()) << size;
    EXPECT_EQ(read.events.back().data, Data(11, 7));
    EXPECT_EQ(read.events.back().number, static_cast<std::int64_t>(size / 40));
  }
}

TEST(LogWriter, NothingIsAppendedToWhatIsNoLog) {
  const TestFile file;
  file.Fill(Data(500, 1));
  EXPECT_FALSE(LogWriter::Open(file.path(), IfExists::kAppend));
  EXPECT_EQ(file.Contents(), Data(500, 1));
}

TEST(LogWriter, AFullDiskIsSaidOnceAndForAll) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  auto writer = LogWriter::Open("/dev/full", IfExists::kReplace);
  ASSERT_TRUE(writer);
  ASSERT_FALSE(writer->Write("A", Data(10, 0), 1));
  const auto fault = writer->Flush();
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->code, FaultCode::kIo);
  EXPECT_THAT(fault->text, testing::HasSubstr("No space left"));
  EXPECT_TRUE(writer->Write("A", Data(10, 0), 1));
  EXPECT_TRUE(writer->Close());
}

TEST(LogWriter, KnowsWhenItsFileIsNoLongerUnderItsName) {
  const TestFile file;
  const std::string moved = file.path() + ".moved";
  auto writer = LogWriter::Open(file.path());
  ASSERT_TRUE(writer);
  EXPECT_TRUE(writer->InPlace());
  std::filesystem::rename(file.path(), moved);
  EXPECT_FALSE(writer->InPlace());
  ASSERT_FALSE(writer->Write("A", Data(10, 0), 1));
  EXPECT_FALSE(writer->Close());
  auto reader = LogReader::Open(moved);
  ASSERT_TRUE(reader);
  EXPECT_EQ(ReadAll(*reader).events.size(), 1u) << "what was moved is whole";
  std::filesystem::remove(moved);
}

TEST(LogWriter, ChannelsThatLcmWouldNotTake) {
  const TestFile file;
  auto writer = LogWriter::Open(file.path());
  ASSERT_TRUE(writer);
  EXPECT_THROW(static_cast<void>(writer->Write("", {}, 0)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(writer->Write(std::string(64, 'C'), {}, 0)),
               std::invalid_argument);
  EXPECT_FALSE(writer->Write(std::string(63, 'C'), {}, 0));
}

}  // namespace
}  // namespace wellgyro::test
