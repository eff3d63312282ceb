#include "wellgyro/bus/log_reader.h"

#include <algorithm>
#include <random>
#include <set>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lcm/lcm-cpp.hpp>
#include <unistd.h>

#include "bus/log_file.h"

namespace wellgyro::test {
namespace {

using testing::HasSubstr;

Bytes BytesOfText(std::string_view text) {
  const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
  return {bytes, bytes + text.size()};
}

std::vector<Kept> SomeEvents(int count, std::uint32_t seed, std::size_t longest = 60) {
  std::mt19937 random(seed);
  std::vector<Kept> events;
  for (int i = 0; i < count; ++i) {
    Kept event{
        i, 1'760'000'000'000'000 + std::int64_t{1000} * i, i % 3 == 0 ? "WELLGYRO_DEPTH" : "X", {}};
    event.data.resize(random() % (longest + 1));
    for (std::byte& b : event.data) b = static_cast<std::byte>(random());
    events.push_back(event);
  }
  return events;
}

void Append(Bytes& log, const Kept& event) {
  const auto big_endian = [&log](std::uint64_t value, int size) {
    for (int i = size - 1; i >= 0; --i) log.push_back(static_cast<std::byte>(value >> (8 * i)));
  };
  big_endian(0xEDA1DA01, 4);
  big_endian(static_cast<std::uint64_t>(event.number), 8);
  big_endian(static_cast<std::uint64_t>(event.received_us), 8);
  big_endian(event.channel.size(), 4);
  big_endian(event.data.size(), 4);
  const Bytes channel = BytesOfText(event.channel);
  log.insert(log.end(), channel.begin(), channel.end());
  log.insert(log.end(), event.data.begin(), event.data.end());
}

struct Log {
  std::vector<Kept> events;
  Bytes bytes;
  std::vector<std::size_t> begins;  // and the end
};

Log LogOf(std::vector<Kept> events) {
  Log log{std::move(events), {}, {}};
  for (const Kept& event : log.events) {
    log.begins.push_back(log.bytes.size());
    Append(log.bytes, event);
  }
  log.begins.push_back(log.bytes.size());
  return log;
}

Result<Read> FromFile(const Bytes& bytes) {
  const TestFile file;
  Result<LogReader> reader = LogReader::Open(file.Fill(bytes));
  if (!reader) return reader.fault();
  return ReadAll(*reader);
}

/// Through a pipe that is fed in pieces of `piece` bytes.
Result<Read> FromPipe(const Bytes& bytes, std::size_t piece) {
  int ends[2];
  if (::pipe(ends) != 0) return Fault{FaultCode::kIo, "pipe", {}};
  std::thread writer([&bytes, piece, end = ends[1]] {
    for (std::size_t at = 0; at < bytes.size();) {
      const ssize_t put = ::write(end, bytes.data() + at, std::min(piece, bytes.size() - at));
      if (put <= 0) break;
      at += static_cast<std::size_t>(put);
    }
    ::close(end);
  });
  Result<LogReader> reader = LogReader::Open("/dev/fd/" + std::to_string(ends[0]));
  Result<Read> read = reader ? Result<Read>(ReadAll(*reader)) : Result<Read>(reader.fault());
  Bytes rest(4096);
  while (::read(ends[0], rest.data(), rest.size()) > 0) continue;
  writer.join();
  ::close(ends[0]);
  return read;
}

std::int64_t SizeOf(const std::vector<Kept>& events) {
  std::size_t size = 0;
  for (const Kept& event : events) size += 28 + event.channel.size() + event.data.size();
  return static_cast<std::int64_t>(size);
}

/// Every byte of the log is in an event, in a gap or in the cut end, and in one of them only.
void ExpectEveryByteAccounted(const Read& read, std::size_t size) {
  const std::int64_t cut = read.health.cut ? read.health.cut->length : 0;
  EXPECT_EQ(SizeOf(read.events) + read.health.lost_bytes + cut, static_cast<std::int64_t>(size));
  EXPECT_EQ(read.health.bytes, static_cast<std::int64_t>(size));
  EXPECT_EQ(read.health.events, static_cast<std::int64_t>(read.events.size()));
  std::int64_t gaps = 0;
  for (const LogGap& gap : read.health.gaps) gaps += gap.length;
  EXPECT_EQ(gaps, read.health.lost_bytes);
}

TEST(LogReader, ReadsWhatLiblcmWrites) {
  const TestFile file;
  const std::vector<Kept> events = SomeEvents(500, 1, 6000);
  {
    lcm::LogFile log(file.path(), "w");
    ASSERT_TRUE(log.good());
    for (const Kept& kept : events) {
      lcm::LogEvent event{};
      event.timestamp = kept.received_us;
      event.channel = kept.channel;
      event.datalen = static_cast<std::int32_t>(kept.data.size());
      event.data = const_cast<std::byte*>(kept.data.data());
      ASSERT_EQ(log.writeEvent(&event), 0);
    }
  }
  auto reader = LogReader::Open(file.path());
  ASSERT_TRUE(reader);
  const Read read = ReadAll(*reader);
  EXPECT_EQ(read.events, events);
  EXPECT_TRUE(read.faults.empty());
  const auto piped = FromPipe(file.Contents(), 1000);
  ASSERT_TRUE(piped);
  EXPECT_EQ(piped->events, events);
  EXPECT_TRUE(piped->faults.empty());
}

TEST(LogReader, GivesThePlaceOfTheData) {
  const Log log = LogOf(SomeEvents(3, 2));
  const TestFile file;
  auto reader = LogReader::Open(file.Fill(log.bytes));
  ASSERT_TRUE(reader);
  LogEvent event;
  for (std::size_t i = 0; i < 3; ++i) {
    ASSERT_TRUE(reader->Next(event));
    EXPECT_EQ(event.data_offset, static_cast<std::int64_t>(log.begins[i + 1]) -
                                     static_cast<std::int64_t>(log.events[i].data.size()));
  }
  EXPECT_FALSE(reader->Next(event));
  EXPECT_FALSE(reader->Next(event)) << "and again";
}

TEST(LogReader, EveryPrefixGivesItsWholeEvents) {
  const Log log = LogOf(SomeEvents(6, 3));
  for (std::size_t size = 1; size < log.bytes.size(); ++size) {
    SCOPED_TRACE(size);
    const Bytes prefix(log.bytes.begin(), log.bytes.begin() + static_cast<std::ptrdiff_t>(size));
    const auto whole = static_cast<std::size_t>(
        std::upper_bound(log.begins.begin(), log.begins.end(), size) - log.begins.begin() - 1);
    const bool inside = log.begins[whole] != size;
    const auto read = FromFile(prefix);
    if (!read) {
      EXPECT_EQ(whole, 0U);
      EXPECT_EQ(read.fault().code, FaultCode::kDamaged);
      EXPECT_THAT(read.fault().text, HasSubstr("inside its first event"));
      continue;
    }
    EXPECT_TRUE(std::equal(read->events.begin(), read->events.end(), log.events.begin(),
                           log.events.begin() + static_cast<std::ptrdiff_t>(whole)));
    EXPECT_EQ(read->health.gap_count, 0);
    ASSERT_EQ(read->health.cut.has_value(), inside);
    EXPECT_EQ(read->faults.size(), inside ? 1U : 0U);
    if (inside) {
      EXPECT_EQ(read->health.cut->offset, static_cast<std::int64_t>(log.begins[whole]));
    }
    ExpectEveryByteAccounted(*read, size);
  }
}

// One flipped bit costs at most the event it is in; the others come out as they went in.
TEST(LogReader, EveryFlippedBitCostsAtMostItsOwnEvent) {
  const Log log = LogOf(SomeEvents(7, 4));
  int refused = 0;
  for (std::size_t bit = 0; bit < 8 * log.bytes.size(); ++bit) {
    SCOPED_TRACE(bit);
    const std::size_t at = bit / 8;
    Bytes bytes = log.bytes;
    bytes[at] ^= std::byte{1} << (bit % 8);
    const auto read = FromFile(bytes);
    ASSERT_TRUE(read);
    const auto hit = static_cast<std::size_t>(
        std::upper_bound(log.begins.begin(), log.begins.end(), at) - log.begins.begin() - 1);
    std::vector<Kept> others = log.events;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(hit));
    std::vector<Kept> found;
    std::copy_if(read->events.begin(), read->events.end(), std::back_inserter(found),
                 [&](const Kept& event) {
                   return std::find(others.begin(), others.end(), event) != others.end();
                 });
    EXPECT_EQ(found, others);
    EXPECT_LE(read->events.size(), log.events.size());
    refused += read->events.size() < log.events.size() ? 1 : 0;
    if (!read->health.cut) {
      EXPECT_EQ(read->events.size() < log.events.size(),
                read->health.gap_count > 0 && read->events.size() == others.size());
    }
    ExpectEveryByteAccounted(*read, bytes.size());
  }
  EXPECT_GE(refused, 7 * 4 * 8) << "at least the sync words";
}

// imu_batch_t of 100 samples on WELLGYRO_IMU makes events of exactly 4096 bytes: one flipped bit of
// the length then leads to the end of the next event, which must not be swallowed.
TEST(LogReader, ALengthThatLeadsToALaterEventSwallowsNone) {
  std::vector<Kept> events;
  events.reserve(6);
  for (int i = 0; i < 6; ++i) events.push_back({i, i, "WELLGYRO_IMU", Bytes(4056)});
  const Log log = LogOf(events);
  ASSERT_EQ(log.begins[1], 4096U);
  for (std::size_t hit = 0; hit < 6; ++hit) {
    Bytes bytes = log.bytes;
    bytes[log.begins[hit] + 26] ^= std::byte{0x10};  // 4056 + 4096
    const auto read = FromFile(bytes);
    ASSERT_TRUE(read);
    std::set<std::int64_t> numbers;
    for (const Kept& event : read->events) numbers.insert(event.number);
    for (std::int64_t i = 0; i < 6; ++i) {
      if (i != static_cast<std::int64_t>(hit)) {
        EXPECT_TRUE(numbers.contains(i)) << hit << " " << i;
      }
    }
  }
}

TEST(LogReader, ALogInsideTheDataOfAnEventStaysThere) {
  const Log inner = LogOf(SomeEvents(4, 5));
  std::vector<Kept> events = SomeEvents(3, 6);
  for (Kept& event : events) event.number += 1000;
  events[1].data = inner.bytes;
  events[2].data = inner.bytes;
  const Log log = LogOf(events);
  const auto read = FromFile(log.bytes);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->events, events);
  EXPECT_EQ(read->health.gap_count, 0);
}

TEST(LogReader, NumbersMayRestartOrHaveGaps) {
  std::vector<Kept> events = SomeEvents(9, 7);
  const std::int64_t numbers[] = {0, 1, 7, 8, 0, 1, 1, -5, 100};
  for (std::size_t i = 0; i < 9; ++i) events[i].number = numbers[i];
  const Log log = LogOf(events);
  const auto read = FromFile(log.bytes);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->events, events);
  EXPECT_TRUE(read->faults.empty());
}

TEST(LogReader, DamageOfManyKindsIsTheSameFromFileAndPipe) {
  for (std::uint32_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const Log log = LogOf(SomeEvents(40, seed, 300));
    Bytes bytes = log.bytes;
    // Cut out, put in, overwrite: from the back, so that the places before keep their meaning.
    std::vector<std::size_t> hits(4);
    for (std::size_t& hit : hits) hit = random() % (bytes.size() - 200);
    std::sort(hits.rbegin(), hits.rend());
    std::set<std::int64_t> damaged;
    for (const std::size_t at : hits) {
      const std::size_t size = 1 + random() % 150;
      const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(at);
      for (std::size_t i = 0; i < log.events.size(); ++i) {
        if (at < log.begins[i + 1] && at + size > log.begins[i]) {
          damaged.insert(static_cast<std::int64_t>(i));
        }
      }
      switch (random() % 3) {
        case 0:
          bytes.erase(first, first + static_cast<std::ptrdiff_t>(size));
          break;
        case 1:
          for (std::size_t i = 0; i < size; ++i) bytes[at + i] = static_cast<std::byte>(random());
          break;
        default: {
          Bytes garbage(size);
          for (std::byte& b : garbage) b = static_cast<std::byte>(random());
          bytes.insert(first, garbage.begin(), garbage.end());
        }
      }
    }
    const auto read = FromFile(bytes);
    ASSERT_TRUE(read);
    ExpectEveryByteAccounted(*read, bytes.size());
    for (const Kept& event : log.events) {
      if (damaged.contains(event.number)) continue;
      EXPECT_EQ(std::count(read->events.begin(), read->events.end(), event), 1)
          << "undamaged event " << event.number;
    }
    for (const std::size_t piece : {std::size_t{7}, std::size_t{4096}}) {
      const auto piped = FromPipe(bytes, piece);
      ASSERT_TRUE(piped);
      EXPECT_EQ(piped->events, read->events);
      EXPECT_EQ(piped->health.lost_bytes, read->health.lost_bytes);
      EXPECT_EQ(piped->health.gap_count, read->health.gap_count);
      EXPECT_EQ(piped->health.bytes, read->health.bytes);
      EXPECT_EQ(piped->health.cut.has_value(), read->health.cut.has_value());
    }
  }
}

TEST(LogReader, ADamagedPlaceIsNamedWithItsLength) {
  const Log log = LogOf(SomeEvents(5, 9));
  Bytes bytes = log.bytes;
  bytes[log.begins[2]] = std::byte{0};
  const auto read = FromFile(bytes);
  ASSERT_TRUE(read);
  ASSERT_EQ(read->health.gaps.size(), 1U);
  EXPECT_EQ(read->health.gaps[0].offset, static_cast<std::int64_t>(log.begins[2]));
  EXPECT_EQ(read->health.gaps[0].length, static_cast<std::int64_t>(log.begins[3] - log.begins[2]));
  ASSERT_EQ(read->faults.size(), 1U);
  EXPECT_EQ(read->faults[0].code, FaultCode::kDamaged);
  EXPECT_EQ(read->faults[0].offset, static_cast<std::int64_t>(log.begins[2]));
}

TEST(LogReader, ForeignFilesAreNamedForWhatTheyAre) {
  const auto said = [](std::string_view contents) {
    const auto file = FromFile(BytesOfText(contents));
    const auto pipe = FromPipe(BytesOfText(contents), 5);
    if (file || pipe) return std::string("a log");
    EXPECT_EQ(file.fault().code, FaultCode::kForeign);
    EXPECT_EQ(pipe.fault().code, FaultCode::kForeign);
    return file.fault().text;
  };
  EXPECT_THAT(said(""), HasSubstr("is empty"));
  EXPECT_THAT(said("MD[m],INC[deg]\n1,2\n"), HasSubstr("text that begins with \"MD[m],INC[deg]\""));
  EXPECT_THAT(said("\x1F\x8B\x08 and so on"), HasSubstr("gzip"));
  EXPECT_THAT(said("PK\x03\x04 and so on"), HasSubstr("ZIP"));
  EXPECT_THAT(said(std::string(5000, '\0')), HasSubstr("begin with 00 00 00 00"));
  EXPECT_THAT(said(std::string(100, '\xED')), HasSubstr("ed ed"));
}

TEST(LogReader, NoFileAndADirectory) {
  const auto missing = LogReader::Open("/nowhere/at/all.lcm");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.fault().code, FaultCode::kIo);
  EXPECT_THAT(missing.fault().text, HasSubstr("/nowhere/at/all.lcm"));
  const auto directory = LogReader::Open("/");
  ASSERT_FALSE(directory);
  EXPECT_THAT(directory.fault().text, HasSubstr("directory"));
}

TEST(LogReader, NoByteIsBeforeTheFirst) {
  const auto reader = LogReader::OpenAt("/dev/null", -1);
  ASSERT_FALSE(reader);
  EXPECT_EQ(reader.fault().code, FaultCode::kRange);
}

TEST(LogReader, ALengthBeyondEveryLimitDoesNotGrowTheBuffer) {
  Log log = LogOf(SomeEvents(4, 10));
  log.bytes[log.begins[1] + 24] = std::byte{0x0F};  // 250 MB of data, it says
  const auto read = FromPipe(log.bytes, 4096);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->events.size(), 3U);
  log.bytes[log.begins[1] + 24] = std::byte{0xFF};
  const auto more = FromFile(log.bytes);
  ASSERT_TRUE(more);
  EXPECT_EQ(more->events.size(), 3U);
}

}  // namespace
}  // namespace wellgyro::test
