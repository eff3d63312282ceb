#include "wellgyro/base/result.h"

#include <gtest/gtest.h>

namespace wellgyro {
namespace {

TEST(SentenceOf, NamesThePlaceAsFarAsItIsKnown) {
  EXPECT_EQ(SentenceOf({.text = "is no job"}), "is no job");
  EXPECT_EQ(SentenceOf({.text = "is no job", .source = "a.toml"}), "a.toml: is no job");
  EXPECT_EQ(SentenceOf({.text = "is 95", .source = "a.toml", .line = 3}), "a.toml:3: is 95");
  EXPECT_EQ(SentenceOf({.text = "is 95", .source = "a.toml", .line = 3, .column = 16}),
            "a.toml:3:16: is 95");
  EXPECT_EQ(SentenceOf({.text = "was cut", .source = "run.lcm", .offset = 70}),
            "run.lcm, byte 70: was cut");
  EXPECT_EQ(SentenceOf({.text = "was cut", .offset = 0}), "byte 0: was cut");
  EXPECT_EQ(SentenceOf({.text = "a.toml is empty", .source = "a.toml"}), "a.toml is empty");
}

}  // namespace
}  // namespace wellgyro
