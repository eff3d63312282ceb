#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>
#include <toml++/toml.h>

#include "wellgyro/base/result.h"

namespace wellgyro {

/// JSON whose members keep the order in which they were written, so that the same input gives the
/// same bytes.
using Json = nlohmann::ordered_json;

/// A comma separated table with one header line as {"columns": [...], "rows": [[...]]}: numbers
/// where a cell is one and its column is no column of words, null where it is empty, else text.
/// Quotes as in RFC 4180, line breaks within them too. Faults with the line.
Result<Json> JsonTable(std::string_view text, const std::string& source);

/// A parsed TOML file: tables as objects, dates as text.
Json JsonOfToml(const toml::node& node);

/// The same of text. Fault kSyntax with the place.
Result<Json> JsonOfToml(std::string_view text, const std::string& source);

}  // namespace wellgyro
