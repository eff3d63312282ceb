#pragma once

#include <string>

#include <gtest/gtest.h>

#include "wellgyro/io/exchange/exchange.h"

namespace wellgyro {

/// A text that must be a survey.
inline SurveyTable Parsed(const std::string& text, const ReadOptions& options = {}) {
  const auto table = ParseSurvey(text, "text", options);
  EXPECT_TRUE(table) << (table ? "" : table.fault().text) << text.substr(0, 400);
  return table ? *table : SurveyTable();
}

/// Why a text is none.
inline Fault ParseFault(const std::string& text, const ReadOptions& options = {}) {
  const auto table = ParseSurvey(text, "text", options);
  EXPECT_FALSE(table) << text.substr(0, 400);
  return table ? Fault{} : table.fault();
}

}  // namespace wellgyro
