#include "wellgyro/bus/splice.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace wellgyro {
namespace {

MessageKey Key(const std::string& text, bool once = true) {
  return KeyOf("A", std::as_bytes(std::span(text)), once);
}

std::vector<MessageKey> Keys(const std::vector<std::string>& texts) {
  std::vector<MessageKey> keys;
  // Capitals are sent again and again, as commands are.
  for (const std::string& text : texts) keys.push_back(Key(text, text[0] >= 'a'));
  return keys;
}

/// What of `second` is still to be used after `first`.
std::vector<std::string> Rest(const std::vector<std::string>& first,
                              const std::vector<std::string>& second) {
  Splice splice;
  for (const MessageKey& key : Keys(first)) splice.Used(key);
  splice.Turn();
  const std::vector<MessageKey> keys = Keys(second);
  const auto joint = splice.Find(keys);
  std::vector<std::string> rest;
  for (std::size_t i = joint ? *joint + 1 : 0; i < keys.size(); ++i) {
    if (splice.WasUsed(keys[i])) continue;
    splice.Used(keys[i]);
    rest.push_back(second[i]);
  }
  return rest;
}

using Texts = std::vector<std::string>;

TEST(Splice, NothingTwiceAndNothingLeftOut) {
  EXPECT_EQ(Rest({"a", "b", "c"}, {"a", "b", "c", "d"}), Texts{"d"});
  EXPECT_EQ(Rest({"a", "b", "c"}, {"c", "d"}), Texts{"d"});
  EXPECT_EQ(Rest({"a", "b"}, {"b"}), Texts{});
  EXPECT_EQ(Rest({"a", "b"}, {"c", "d"}), (Texts{"c", "d"})) << "the second began later";
  EXPECT_EQ(Rest({}, {"a"}), Texts{"a"});
}

TEST(Splice, MessagesSentAgainCountAsOftenAsTheyCame) {
  EXPECT_EQ(Rest({"a", "X"}, {"a", "X", "X", "X", "b"}), (Texts{"X", "X", "b"}));
  EXPECT_EQ(Rest({"a", "X", "X"}, {"a", "X", "X", "X", "b", "X"}), (Texts{"X", "b", "X"}));
  EXPECT_EQ(Rest({"X", "a"}, {"X", "X", "a", "X"}), Texts{"X"});
}

TEST(Splice, TheSameBytesOnAnotherChannelAreAnotherMessage) {
  const std::string text = "a";
  const auto bytes = std::as_bytes(std::span(text));
  EXPECT_NE(KeyOf("A", bytes, true).hash, KeyOf("B", bytes, true).hash);
}

}  // namespace
}  // namespace wellgyro
