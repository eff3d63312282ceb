#include "wellgyro/bus/reassembly.h"

#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace wellgyro {
namespace {

using Bytes = std::vector<std::byte>;

void Put(Bytes& bytes, std::uint64_t value, int size) {
  for (int i = size - 1; i >= 0; --i) bytes.push_back(static_cast<std::byte>(value >> 8 * i & 255));
}

void Put(Bytes& bytes, const std::string& text) {
  for (const char c : text) bytes.push_back(static_cast<std::byte>(c));
}

Bytes Data(std::size_t size) {
  Bytes data(size);
  for (std::size_t i = 0; i < size; ++i) data[i] = static_cast<std::byte>(i * 7);
  return data;
}

/// LCM's framing of a small message, written here from its documentation.
Bytes Small(const std::string& channel, const Bytes& data) {
  Bytes bytes;
  Put(bytes, 0x4c433032, 4);
  Put(bytes, 5, 4);
  Put(bytes, channel);
  Put(bytes, 0, 1);
  bytes.insert(bytes.end(), data.begin(), data.end());
  return bytes;
}

struct Part {
  std::uint32_t message = 9, size = 0, offset = 0;
  std::uint16_t number = 0, count = 1;
  std::string channel = {};
  Bytes data = {};
};

Bytes Datagram(const Part& part) {
  Bytes bytes;
  Put(bytes, 0x4c433033, 4);
  Put(bytes, part.message, 4);
  Put(bytes, part.size, 4);
  Put(bytes, part.offset, 4);
  Put(bytes, part.number, 2);
  Put(bytes, part.count, 2);
  if (!part.channel.empty()) {
    Put(bytes, part.channel);
    Put(bytes, 0, 1);
  }
  bytes.insert(bytes.end(), part.data.begin(), part.data.end());
  return bytes;
}

std::vector<Bytes> Fragments(const std::string& channel, const Bytes& data, std::size_t each,
                             std::uint32_t message = 9) {
  std::vector<Bytes> all;
  const std::size_t count = (data.size() + each - 1) / each;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = i * each, end = std::min(data.size(), at + each);
    all.push_back(Datagram({.message = message,
                            .size = static_cast<std::uint32_t>(data.size()),
                            .offset = static_cast<std::uint32_t>(at),
                            .number = static_cast<std::uint16_t>(i),
                            .count = static_cast<std::uint16_t>(count),
                            .channel = i == 0 ? channel : "",
                            .data = Bytes(data.begin() + static_cast<std::ptrdiff_t>(at),
                                          data.begin() + static_cast<std::ptrdiff_t>(end))}));
  }
  return all;
}

TEST(Reassembly, AWholeMessageIsHandedOn) {
  Reassembly r;
  const Bytes datagram = Small("DEPTH", Data(56));
  const auto whole = r.Take(1, datagram);
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->channel, "DEPTH");
  EXPECT_EQ(Bytes(whole->data.begin(), whole->data.end()), Data(56));
  const Bytes nothing = Small("E", {});
  EXPECT_TRUE(r.Take(1, nothing)->data.empty());
  EXPECT_EQ(r.refused(), 0);
}

TEST(Reassembly, FragmentsInAnyOrderTwiceAndAmongOthersMakeTheMessage) {
  const Bytes data = Data(10'000);
  std::vector<Bytes> parts = Fragments("BIG", data, 1200);
  const std::vector<Bytes> others = Fragments("OTHER", Data(5000), 1200);
  std::mt19937 chance(3);
  for (int round = 0; round < 20; ++round) {
    Reassembly r;
    std::shuffle(parts.begin(), parts.end(), chance);
    int made = 0;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      // Another sender under the same number is another message.
      if (i < others.size()) r.Take(2, others[i]);
      for (int again = 0; again < 2; ++again) {
        const auto whole = r.Take(1, parts[i]);
        if (!whole) continue;
        ++made;
        EXPECT_EQ(whole->channel, "BIG");
        EXPECT_EQ(Bytes(whole->data.begin(), whole->data.end()), data);
      }
    }
    EXPECT_EQ(made, 1);
    EXPECT_EQ(r.refused(), 0);
  }
}

// The two datagrams that ended liblcm's receiver: an offset that wraps 32 bits with the size.
TEST(Reassembly, OffsetsThatWrapAreRefused) {
  Reassembly r;
  EXPECT_FALSE(r.Take(1, Datagram({.size = 4000, .count = 2, .channel = "A", .data = Data(100)})));
  EXPECT_FALSE(r.Take(
      1,
      Datagram({.size = 4000, .offset = 0xffffffce, .number = 1, .count = 2, .data = Data(100)})));
  EXPECT_EQ(r.refused(), 1);
}

TEST(Reassembly, WhatCannotBeIsRefused) {
  Reassembly r;
  Bytes without_nul = Small("NO-NUL", {});
  without_nul.pop_back();
  const std::vector<Bytes> impossible = {
      {},
      Data(7),
      Data(40),
      Small("", Data(3)),
      Small(std::string(64, 'A'), Data(3)),
      without_nul,
      Datagram({.size = 100, .number = 2, .count = 2, .data = Data(50)}),
      Datagram({.size = 100, .number = 0, .count = 0, .channel = "A", .data = Data(50)}),
      Datagram({.size = 100, .offset = 10, .count = 2, .channel = "A", .data = Data(50)}),
      Datagram({.size = 100, .offset = 60, .number = 1, .count = 2, .data = Data(50)}),
      Datagram({.size = 0xffffffff, .count = 2, .channel = "A", .data = Data(50)}),
      Datagram({.size = 100, .count = 2, .channel = std::string(70, 'A'), .data = Data(5)}),
      Datagram({.size = 3, .count = 60'000, .channel = "A", .data = Data(3)}),
  };
  for (std::size_t i = 0; i < impossible.size(); ++i) {
    EXPECT_FALSE(r.Take(1, impossible[i])) << i;
    EXPECT_EQ(r.refused(), static_cast<std::int64_t>(i) + 1);
    EXPECT_EQ(r.waiting(), 0u);
  }
}

TEST(Reassembly, FragmentsThatCoverLessThanTheMessageMakeNone) {
  Reassembly r;
  r.Take(1, Datagram({.size = 100, .count = 2, .channel = "A", .data = Data(40)}));
  EXPECT_FALSE(
      r.Take(1, Datagram({.size = 100, .offset = 0, .number = 1, .count = 2, .data = Data(40)})));
  EXPECT_EQ(r.refused(), 1);
  EXPECT_EQ(r.waiting_bytes(), 0u);
}

TEST(Reassembly, UnfinishedMessagesAreBoundedAndTheirSenderPaysForThem) {
  Reassembly r;
  const Bytes data = Data(5000);
  const std::vector<Bytes> parts = Fragments("TRUE", data, 3000);
  ASSERT_FALSE(r.Take(7, parts[0]));
  for (std::uint32_t i = 0; i < 10'000; ++i) {
    r.Take(1, Datagram(
                  {.message = i, .size = 1 << 20, .count = 20, .channel = "A", .data = Data(10)}));
  }
  EXPECT_LE(r.waiting(), 1u + Reassembly::kWaitingOfSender);
  // What was announced but never came takes no memory.
  EXPECT_LT(r.waiting_bytes(), 10'000u);
  EXPECT_TRUE(r.Take(7, parts[1]));
  for (std::uint32_t i = 0; i < 10'000; ++i) {
    r.Take(
        1000 + i,
        Datagram({.message = i, .size = 8 << 20, .count = 20, .channel = "A", .data = Data(10)}));
    ASSERT_LE(r.waiting_bytes(), Reassembly::kWaitingMax);
  }
  EXPECT_LE(r.waiting(), Reassembly::kWaiting);
  EXPECT_GT(r.abandoned(), 10'000);
}

TEST(Reassembly, WhatHasComeIsBoundedInBytesAndTheOldestGivesWay) {
  Reassembly r;
  const Bytes big = Data(60'000);
  for (std::uint16_t i = 0; i < 100; ++i) {
    for (std::uint64_t sender = 0; sender < 40; ++sender) {
      r.Take(sender, Datagram({.size = 8 << 20,
                               .offset = i * 60'000u,
                               .number = i,
                               .count = 140,
                               .channel = i == 0 ? "A" : "",
                               .data = big}));
      ASSERT_LE(r.waiting_bytes(), Reassembly::kWaitingMax);
    }
  }
  EXPECT_GT(r.waiting_bytes(), Reassembly::kWaitingMax / 2);
  EXPECT_GT(r.abandoned(), 0);
}

// Fragments that each say again what others said would hold more than the message has.
TEST(Reassembly, FragmentsOfMoreThanTheMessageAreRefused) {
  Reassembly r;
  for (std::uint16_t i = 0; i < 1000; ++i) {
    r.Take(1, Datagram({.size = 10'000,
                        .number = i,
                        .count = 2000,
                        .channel = i == 0 ? "A" : "",
                        .data = Data(9000)}));
  }
  EXPECT_LT(r.waiting_bytes(), 20'000u);
  EXPECT_EQ(r.refused(), 999);
}

TEST(Reassembly, RandomDatagramsEndNothing) {
  Reassembly r;
  std::mt19937 chance(11);
  const std::vector<Bytes> good = Fragments("GOOD", Data(9000), 1300);
  for (int i = 0; i < 200'000; ++i) {
    Bytes one = chance() % 3 == 0 ? Bytes(chance() % 100) : good[chance() % good.size()];
    for (int k = 0; k < 3 && !one.empty(); ++k) {
      one[chance() % std::min<std::size_t>(one.size(), 30)] = static_cast<std::byte>(chance());
    }
    if (const auto whole = r.Take(chance() % 5, one)) {
      ASSERT_GE(whole->channel.size(), 1u);
      ASSERT_LE(whole->channel.size(), Reassembly::kChannelMax);
    }
    ASSERT_LE(r.waiting_bytes(), Reassembly::kWaitingMax);
  }
}

}  // namespace
}  // namespace wellgyro
