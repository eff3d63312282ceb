#pragma once

#include <span>
#include <string_view>

#include "wellgyro/io/exchange/column_units_internal.h"
#include "wellgyro/record/survey_table.h"

namespace wellgyro {

/// A column as table formats know it.
struct ColumnInfo {
  Column column;
  Quantity quantity;
  std::string_view csv;   ///< name in CSV headers
  std::string_view las;   ///< curve mnemonic
  std::string_view text;  ///< in words
};
std::span<const ColumnInfo> AllColumns();
const ColumnInfo& InfoOf(Column column);

struct TextColumnInfo {
  TextColumn column;
  std::string_view csv;
};
std::span<const TextColumnInfo> AllTextColumns();

/// A column by the name that one of the formats has for it.
struct NamedColumn {
  std::string_view name;
  Column column;
};

}  // namespace wellgyro
