#include "wellgyro/io/words.h"

#include <gtest/gtest.h>

namespace wellgyro {
namespace {

TEST(Words, StandForTheNumbersOfTheMessages) {
  EXPECT_EQ(WordOf(static_cast<StationKind>(0)), "tie_in");
  EXPECT_EQ(WordOf(static_cast<StationKind>(3)), "still");
  EXPECT_EQ(WordOf(static_cast<StationStatus>(2)), "definitive");
  EXPECT_EQ(WordOf(static_cast<Pass>(3)), "repeat");
  EXPECT_EQ(WordOf(Verdict::kNotDone), "not_done");
  EXPECT_EQ(WordOf(static_cast<Event::Kind>(2)), "depth_rezero");
  EXPECT_EQ(WordOf(static_cast<Event::Kind>(10)), "remark");
  EXPECT_EQ(WordOf(static_cast<DepthKind>(2)), "drill_pipe");
}

TEST(Words, AreReadBack) {
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(StationKindOf(WordOf(static_cast<StationKind>(i))), static_cast<StationKind>(i));
  }
  for (int i = 1; i <= 10; ++i) {
    EXPECT_EQ(EventKindOf(WordOf(static_cast<Event::Kind>(i))), static_cast<Event::Kind>(i));
  }
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(DepthKindOf(WordOf(static_cast<DepthKind>(i))), static_cast<DepthKind>(i));
  }
  EXPECT_FALSE(EventKindOf(""));
  EXPECT_FALSE(EventKindOf("Remark"));
  EXPECT_FALSE(StationKindOf("tie-in"));
}

TEST(Quality, TextNamesTheSetFlags) {
  EXPECT_EQ(QualityText(Quality::kGood), "good");
  EXPECT_EQ(QualityText(Quality::kGap | Quality::kMoved), "moved+gap");
  EXPECT_EQ(QualityText(Quality::kClock), "clock");
  for (unsigned bits = 0; bits < 1u << 12; ++bits) {
    const auto quality = static_cast<Quality>(bits);
    EXPECT_EQ(QualityOf(QualityText(quality)), quality) << bits;
  }
  for (const char* odd : {"", "+", "moved+", "+gap", "good+gap", "Gap", "moved gap"}) {
    EXPECT_FALSE(QualityOf(odd)) << odd;
  }
}

TEST(Words, ACountIsInTheNumberOfItsNoun) {
  EXPECT_EQ(Counted(0, "stop"), "0 stops");
  EXPECT_EQ(Counted(1, "stop"), "1 stop");
  EXPECT_EQ(Counted(12, "stop"), "12 stops");
}

}  // namespace
}  // namespace wellgyro
