#include "wellgyro/uncertainty/expression.h"

#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"

namespace wellgyro {
namespace {

constexpr std::string_view kVariables[] = {"inc", "azm", "md"};

double Value(const std::string& text, double inc = 0.5, double azm = 1.2, double md = 900) {
  const auto made = Expression::Compile(text, kVariables);
  EXPECT_TRUE(made) << text << ": " << (made ? "" : made.fault().text);
  const double values[] = {inc, azm, md};
  return made ? made->At(values) : NAN;
}

TEST(Expression, Arithmetic) {
  EXPECT_EQ(Value("1 + 2 * 3"), 7);
  EXPECT_EQ(Value("(1 + 2) * 3"), 9);
  EXPECT_EQ(Value("10 - 4 - 3"), 3);
  EXPECT_EQ(Value("16 / 4 / 2"), 2);
  EXPECT_EQ(Value("2 ^ 3 ^ 2"), 512);
  EXPECT_EQ(Value("-2 ^ 2"), -4);
  EXPECT_EQ(Value("2 ^ -1"), 0.5);
  EXPECT_EQ(Value("- - 3"), 3);
  EXPECT_EQ(Value("1.5e2"), 150);
  EXPECT_EQ(Value("MAX(1, Sqr(16))"), 4);
  EXPECT_EQ(Value("min(3, -2) + Abs(-5)"), 3);
  EXPECT_EQ(Value("if(-1, 10, 20)"), 20);
  EXPECT_EQ(Value("if(0, 10, 20) * 2"), 20);
}

TEST(Expression, PublishedFormula) {
  const double i = 0.5, a = 1.2;
  EXPECT_DOUBLE_EQ(Value("-Sin(Inc) * Sin(AzM) / (1 - Sin(Inc) * Sin(Inc) * Sin(AzM) * Sin(AzM))"),
                   -std::sin(i) * std::sin(a) / (1 - std::pow(std::sin(i) * std::sin(a), 2)));
  EXPECT_DOUBLE_EQ(Value("(Sin(Inc))^0.25"), std::pow(std::sin(i), 0.25));
  EXPECT_DOUBLE_EQ(Value("Tan((pi / 2) - Inc)"), std::tan(kPi / 2 - i));
  EXPECT_TRUE(std::isinf(Value("1 / Sin(Inc)", 0)));
}

TEST(Expression, UsesAndConstants) {
  const auto made = Expression::Compile("md * 2", kVariables);
  ASSERT_TRUE(made);
  EXPECT_TRUE(made->Uses(2));
  EXPECT_FALSE(made->Uses(0));
  EXPECT_FALSE(made->Constant());
  EXPECT_EQ(Expression::Compile("3 * 4", kVariables)->Constant(), 12);
}

TEST(Expression, HostileTextIsRefused) {
  std::string nested = std::string(3000, '(');
  const std::string hostile[] = {"",
                                 " ",
                                 "1 +",
                                 "(1",
                                 "1)",
                                 "import os",
                                 "__import__('os').system('id')",
                                 "system(1)",
                                 "sin",
                                 "sin()",
                                 "sin(1, 2)",
                                 "max(1)",
                                 "1 2",
                                 "inc.real",
                                 "inc[0]",
                                 "lambda: 1",
                                 "1e999",
                                 "1e",
                                 "0x10",
                                 "$(id)",
                                 "`id`",
                                 "a = 1",
                                 "inc;md",
                                 "1 // 2",
                                 "2 ** 3",
                                 "unknown * 2",
                                 "\x80\xff",
                                 nested,
                                 std::string(80, '(') + "1" + std::string(80, ')'),
                                 std::string(2001, '1'),
                                 std::string(400, '-') + "1" + std::string(1500, '+')};
  for (const std::string& text : hostile) {
    const auto made = Expression::Compile(text, kVariables);
    EXPECT_FALSE(made) << text.substr(0, 40);
  }
  // Power chains nest too.
  std::string power = "2";
  for (int i = 0; i < 300; ++i) power += "^2";
  EXPECT_FALSE(Expression::Compile(power, kVariables));
  std::string many = "1";
  for (int i = 0; i < 400; ++i) many += "+1";
  EXPECT_FALSE(Expression::Compile(many, kVariables));  // more than 512 operations
}

TEST(Expression, RandomTextNeverBreaksIt) {
  std::mt19937 engine(7);
  const std::string letters = "0123456789.()+-*/^, incazmdsqrtxbf\t\x01\xfe";
  int good = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string text;
    const int length = static_cast<int>(engine() % 24);
    for (int k = 0; k < length; ++k) text += letters[engine() % letters.size()];
    const auto made = Expression::Compile(text, kVariables);
    if (!made) continue;
    ++good;
    const double values[] = {0.1, 0.2, 0.3};
    static_cast<void>(made->At(values));
  }
  EXPECT_GT(good, 10);
}

}  // namespace
}  // namespace wellgyro
