// A rig's WITS level 0 stream, as it should be and as it comes.
#include "wellgyro/bus/wits.h"

#include <cmath>
#include <cstdint>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "wellgyro/depth/depth_track.h"
#include "wellgyro/io/toml/wits_file.h"

namespace wellgyro {
namespace {

/// A record of a drilling contractor: more items than anybody needs, of the given second of
/// 2026-03-04.
std::string Record(int second, double md) {
  return fmt::format(
      "&&\r\n0101Well 7\r\n0105260304\r\n0106{:02}{:02}{:02}\r\n0108{:.2f}\r\n0110{:.2f}\r\n"
      "0113-9999\r\n0117 12.50\r\n!!\r\n",
      second / 3600, second / 60 % 60, second % 60, md, md + 1.5);
}

struct Heard {
  std::vector<DepthMark> marks;
  std::vector<Fault> faults;
  WitsReader reader{WitsItems{}, 3, [this](const DepthMark& mark) { marks.push_back(mark); },
                    [this](const Fault& fault) { faults.push_back(fault); }};
};

// 2026-03-04T00:00:00Z; `date -u -d 2026-03-04 +%s`.
constexpr std::int64_t kMidnight = 1'772'582'400;

TEST(Wits, ARecordIsADepthMark) {
  Heard heard;
  heard.reader.Take(Record(3723, 1234.56) + Record(3724, 1234.9));
  ASSERT_EQ(heard.marks.size(), 2u);
  EXPECT_EQ(heard.marks[0].utc.ns, (kMidnight + 3723) * 1'000'000'000);
  EXPECT_EQ(heard.marks[0].md, 1234.56);
  EXPECT_EQ(heard.marks[0].session, 3);
  EXPECT_EQ(heard.marks[1].seq, heard.marks[0].seq + 1);
  EXPECT_TRUE(heard.faults.empty());
}

TEST(Wits, HoweverItIsCutIntoPieces) {
  std::string all;
  for (int i = 0; i < 50; ++i) all += Record(i, 100 + 0.5 * i);
  for (const std::size_t piece : {1, 3, 7, 64, 1000}) {
    Heard heard;
    for (std::size_t at = 0; at < all.size(); at += piece) heard.reader.Take(all.substr(at, piece));
    EXPECT_EQ(heard.marks.size(), 50u) << piece;
  }
}

TEST(Wits, WhatIsWrongCostsItsOwnRecord) {
  const std::vector<std::string> wrong = {
      "&&\r\n0105260304\r\n0106000001\r\n0108abc\r\n!!\r\n",
      "&&\r\n0105260304\r\n0106000001\r\n01081e9\r\n!!\r\n",
      "&&\r\n0105260304\r\n0106000001\r\n0108nan\r\n!!\r\n",
      "&&\r\n0105260304\r\n0106000001\r\n0108-9999\r\n!!\r\n",
      "&&\r\n0105260304\r\n0106000001\r\n0108-8888.00\r\n!!\r\n",
      "&&\r\n0105260304\r\n0106000001\r\n0108-999.25\r\n!!\r\n",  // 2026-11-24, as LAS
      "&&\r\n0105261304\r\n0106000001\r\n010812.5\r\n!!\r\n",
      "&&\r\n0105260304\r\n0106006001\r\n010812.5\r\n!!\r\n",
      "&&\r\n0106000001\r\n010812.5\r\n!!\r\n",
      "&&\r\n0105260304\r\n0106000001\r\n010812.5\r\n010812.5\r\n!!\r\n",
      "&&\r\n0105260304\r\n0106000001\r\n010812.5\r\n\x01\xff\r\n!!\r\n",
      "&&\r\n0105260304\r\n0106000001\r\n010812.5\r\n",
      "&&\r\n0105260304\r\n0106000001\r\n010812.5\r\n01" + std::string(5000, '9') + "\r\n!!\r\n",
  };
  for (std::size_t i = 0; i < wrong.size(); ++i) {
    Heard heard;
    heard.reader.Take(Record(0, 12) + wrong[i] + Record(2, 13));
    ASSERT_EQ(heard.marks.size(), 2u) << i;
    EXPECT_EQ(heard.marks[0].md, 12);
    EXPECT_EQ(heard.marks[1].md, 13);
    EXPECT_EQ(heard.reader.bad(), 1) << i;
    EXPECT_EQ(heard.faults.size(), 1u) << i;
  }
}

TEST(Wits, RecordsOfOtherKindsAreNoneOfOurs) {
  Heard heard;
  heard.reader.Take("&&\r\n0701Well 7\r\n0713 45.2\r\n!!\r\nnoise between\r\n!!\r\n");
  EXPECT_TRUE(heard.marks.empty());
  EXPECT_EQ(heard.reader.bad(), 0);
}

TEST(Wits, ItemsUnitsAndTheClockAreOfAFile) {
  const auto items = ParseWitsItems(
      "format = \"wellgyro.wits/1\"\ndepth_unit = \"ft\"\nutc_offset_h = 1\ndepth_sigma_m = 0.1\n"
      "kind = \"wireline\"\n[items]\nbit_depth = 110\n",
      "rig.toml");
  ASSERT_TRUE(items) << items.fault().text;
  std::vector<DepthMark> marks;
  WitsReader reader(
      *items, 0, [&](const DepthMark& mark) { marks.push_back(mark); }, [](const Fault&) {});
  reader.Take(Record(3600, 98.5));
  ASSERT_EQ(marks.size(), 1u);
  EXPECT_DOUBLE_EQ(marks[0].md, 100 * 0.3048);
  EXPECT_EQ(marks[0].utc.ns, kMidnight * 1'000'000'000);
  EXPECT_EQ(marks[0].sigma, 0.1);
  EXPECT_EQ(marks[0].kind, DepthKind::kWireline);
  EXPECT_FALSE(ParseWitsItems("format = \"wellgyro.wits/1\"\n[items]\nbit_dept = 110\n", "x"));
}

/// The sender's side: where the bit is at each second of a day of tripping.
double DepthAt(int second) {
  const double stand = 28.5;
  const int of_stand = second % 180;
  const double moved = of_stand < 60 ? 0 : stand * (of_stand - 60) / 120.0;
  return 500 + stand * (second / 180) + moved;
}

// A day; the line is cut three tenths of the time, for a minute or two, and one record in a hundred
// is garbled somewhere. The depths that come are the true ones, and so is the track between them.
TEST(Wits, ADayOverABadLineGivesTheDepthTrackOfAGoodOne) {
  std::mt19937 chance(17);
  Heard good, bad;
  std::int64_t garbled = 0, away = 0;
  bool up = true;
  int until = 0;
  for (int second = 0; second < 86'400; ++second) {
    const std::string record = Record(second, DepthAt(second));
    good.reader.Take(record);
    if (second >= until) {
      up = !up;
      until = second + static_cast<int>(up ? 140 + chance() % 280 : 60 + chance() % 120);
      if (!up) bad.reader.Cut();
    }
    away += up ? 0 : 1;
    if (!up) continue;
    std::string sent = record;
    if (chance() % 100 == 0) {
      ++garbled;
      for (int k = 0; k < 4; ++k) sent[chance() % sent.size()] = static_cast<char>(chance());
    }
    bad.reader.Take(sent);
  }
  EXPECT_NEAR(static_cast<double>(away) / 86'400, 0.3, 0.05);
  EXPECT_EQ(good.marks.size(), 86'400u);
  EXPECT_GT(garbled, 500);
  // A record whose end is garbled, to the last byte, takes the one behind it along.
  EXPECT_GT(static_cast<double>(bad.marks.size()),
            86'400.0 - static_cast<double>(away) - 1.1 * static_cast<double>(garbled));
  DepthTrack one, other;
  std::size_t given = 0, refused = 0;
  for (const DepthMark& mark : good.marks) ASSERT_FALSE(one.Push(mark));
  for (const DepthMark& mark : bad.marks) {
    ++given;
    refused += other.Push(mark) ? 1 : 0;
  }
  std::int64_t compared = 0, differ = 0;
  for (int second = 5; second < 86'395; ++second) {
    const UtcTime utc{(kMidnight + second) * 1'000'000'000 + 500'000'000};
    const AlongHole a = one.At(utc), b = other.At(utc);
    if (!b.known) continue;
    ++compared;
    ASSERT_TRUE(a.known);
    differ += std::abs(a.md - b.md) > 0.3 ? 1 : 0;
  }
  RecordProperty("compared_s", static_cast<int>(compared));
  fmt::print(
      "away {} s, {} records garbled, {} left out, {} marks refused; track known at {} s, "
      "{} of them off by more than 0.3 m\n",
      away, garbled, bad.reader.bad(), refused, compared, differ);
  EXPECT_GT(compared, 55'000);
  EXPECT_EQ(differ, 0);
}

}  // namespace
}  // namespace wellgyro
