#include "wellgyro/io/toml/toml_internal.h"

#include <algorithm>
#include <sstream>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "wellgyro/base/alike.h"

namespace wellgyro {
namespace {

[[noreturn]] void Throw(FaultCode code, std::string text, const std::string& source,
                        const toml::source_position& at) {
  throw TomlError{Fault{.code = code,
                        .text = std::move(text),
                        .source = source,
                        .line = static_cast<int>(at.line),
                        .column = static_cast<int>(at.column)}};
}

toml::table Parse(std::string_view text, const std::string& source) {
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& error) {
    Throw(FaultCode::kSyntax, std::string(error.description()), source, error.source().begin);
  }
}

}  // namespace

TomlDocument::TomlDocument(std::string_view text, std::string source, std::string_view format)
    : source_(std::move(source)), root_(Parse(text, source_)) {
  const toml::node* const found = root_.get("format");
  const std::string* const value =
      found && found->is_string() ? &found->as_string()->get() : nullptr;
  if (!value) {
    Throw(FaultCode::kForeign, fmt::format("no line format = \"{}\" at its head", format), source_,
          {.line = 1, .column = 1});
  }
  if (*value != format) {
    Throw(FaultCode::kForeign, fmt::format("format is \"{}\", wanted is \"{}\"", *value, format),
          source_, found->source().begin);
  }
  read_.insert(found);
}

const toml::table* TomlDocument::FirstUnread(const toml::table& table,
                                             const toml::key** key) const {
  const toml::table* owner = nullptr;
  const auto offer = [&](const toml::table* where, const toml::key* candidate) {
    const auto place = [](const toml::key* k) {
      return std::pair(k->source().begin.line, k->source().begin.column);
    };
    if (candidate && (!owner || place(candidate) < place(*key))) owner = where, *key = candidate;
  };
  const auto descend = [&](const toml::table& inner) {
    const toml::key* inner_key = nullptr;
    const toml::table* const where = FirstUnread(inner, &inner_key);
    offer(where, inner_key);
  };
  for (const auto& [name, node] : table) {
    if (!read_.contains(&node)) {
      offer(&table, &name);
    } else if (node.is_table()) {
      descend(*node.as_table());
    } else if (node.is_array_of_tables()) {
      for (const toml::node& element : *node.as_array()) descend(*element.as_table());
    }
  }
  return owner;
}

void TomlDocument::RefuseUnread() const {
  const toml::key* key = nullptr;
  const toml::table* const owner = FirstUnread(root_, &key);
  if (!owner) return;
  std::string text = fmt::format("'{}' is not a key that belongs here", key->str());
  const auto asked = asked_.find(owner);
  if (asked != asked_.end()) {
    for (const std::string& like : asked->second) {
      if (!owner->contains(like) && Alike(like, key->str())) {
        text += fmt::format("; is '{}' meant?", like);
        break;
      }
    }
  }
  Throw(FaultCode::kSyntax, std::move(text), source_, key->source().begin);
}

std::string TomlTable::PathOf(std::string_view key) const {
  return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
}

std::string TomlTable::Named(std::string_view key) const {
  if (path_.empty()) return std::string(key);
  const std::string name = fmt::format(fmt::runtime(of_list_ ? "[[{}]]" : "[{}]"), path_);
  return key.empty() ? name : fmt::format("{} {}", name, key);
}

void TomlTable::Refuse(std::string_view key, std::string_view why, FaultCode code) const {
  const toml::node* const node = table_->get(key);
  Throw(code, fmt::format("{}: {}", Named(key), why), document_->source_,
        (node ? node : table_)->source().begin);
}

void TomlTable::RefuseAbsent(std::string_view key, std::string_view why) const {
  for (const auto& [name, node] : *table_) {
    if (!document_->read_.contains(&node) && Alike(name.str(), key)) {
      Throw(FaultCode::kSyntax,
            fmt::format("'{}' is not a key that belongs here; is '{}' meant?", name.str(), key),
            document_->source_, name.source().begin);
    }
  }
  Refuse(key, why);
}

std::optional<std::size_t> TomlTable::FindPlace(std::string_view key,
                                                std::span<const std::string_view> words) {
  const std::optional<std::string> word = FindString(key);
  if (!word) return std::nullopt;
  const auto found = std::find(words.begin(), words.end(), *word);
  if (found != words.end() && !word->empty()) {
    return static_cast<std::size_t>(found - words.begin());
  }
  std::vector<std::string_view> known(words.begin(), words.end());
  std::erase(known, std::string_view());
  Refuse(key, fmt::format("\"{}\" is none of {}", *word, fmt::join(known, ", ")));
}

const toml::node* TomlTable::Ask(std::string_view key) {
  document_->asked_[table_].emplace_back(key);
  document_->asked_names_.insert(PathOf(key));
  const toml::node* const node = table_->get(key);
  if (node) document_->read_.insert(node);
  return node;
}

double TomlTable::NumberOf(const toml::node& node, std::string_view key, TomlRange range) const {
  const std::optional<double> number = node.is_number() ? node.value<double>() : std::nullopt;
  if (!number) Refuse(key, "must be a number", FaultCode::kSyntax);
  if (const auto complaint = ComplaintOf(*number, range)) Refuse(key, *complaint);
  return *number;
}

std::optional<double> TomlTable::FindNumber(std::string_view key, TomlRange range) {
  const toml::node* const node = Ask(key);
  if (!node) return std::nullopt;
  return NumberOf(*node, key, range);
}

std::optional<std::int64_t> TomlTable::FindInteger(std::string_view key, std::int64_t min,
                                                   std::int64_t max) {
  const toml::node* const node = Ask(key);
  if (!node) return std::nullopt;
  if (!node->is_integer()) Refuse(key, "must be a whole number", FaultCode::kSyntax);
  const std::int64_t v = node->as_integer()->get();
  if (v < min || v > max) Refuse(key, fmt::format("{} must be from {} to {}", v, min, max));
  return v;
}

std::optional<bool> TomlTable::FindBool(std::string_view key) {
  const toml::node* const node = Ask(key);
  if (!node) return std::nullopt;
  if (!node->is_boolean()) Refuse(key, "must be true or false", FaultCode::kSyntax);
  return node->as_boolean()->get();
}

std::optional<std::string> TomlTable::FindString(std::string_view key) {
  const toml::node* const node = Ask(key);
  if (!node) return std::nullopt;
  if (!node->is_string()) Refuse(key, "must be text in quotes", FaultCode::kSyntax);
  return node->as_string()->get();
}

std::optional<std::vector<double>> TomlTable::FindNumbers(std::string_view key, TomlRange range) {
  const toml::node* const node = Ask(key);
  if (!node) return std::nullopt;
  const toml::array* const array = node->as_array();
  if (!array) Refuse(key, "must be a list of numbers, as [1.0, 2.0]", FaultCode::kSyntax);
  std::vector<double> numbers;
  for (const toml::node& element : *array) numbers.push_back(NumberOf(element, key, range));
  return numbers;
}

std::optional<std::vector<std::string>> TomlTable::FindStrings(std::string_view key) {
  const toml::node* const node = Ask(key);
  if (!node) return std::nullopt;
  const auto refuse = [&] {
    Refuse(key, "must be a list of texts, as [\"a\", \"b\"]", FaultCode::kSyntax);
  };
  if (!node->is_array()) refuse();
  std::vector<std::string> texts;
  for (const toml::node& element : *node->as_array()) {
    if (!element.is_string()) refuse();
    texts.push_back(element.as_string()->get());
  }
  return texts;
}

std::optional<std::vector<std::vector<double>>> TomlTable::FindRows(std::string_view key,
                                                                    std::size_t width) {
  const toml::node* const node = Ask(key);
  if (!node) return std::nullopt;
  const auto refuse = [&] {
    Refuse(key, fmt::format("must be a list of rows of {} numbers", width), FaultCode::kSyntax);
  };
  if (!node->is_array()) refuse();
  std::vector<std::vector<double>> rows;
  for (const toml::node& row : *node->as_array()) {
    if (!row.is_array() || row.as_array()->size() != width) refuse();
    std::vector<double>& numbers = rows.emplace_back();
    for (const toml::node& v : *row.as_array()) numbers.push_back(NumberOf(v, key, kAnyNumber));
  }
  return rows;
}

std::vector<std::string> TomlTable::Keys() const {
  std::vector<std::pair<toml::source_position, std::string>> found;
  for (const auto& [key, value] : *table_) {
    found.emplace_back(key.source().begin, std::string(key.str()));
  }
  std::sort(found.begin(), found.end());
  std::vector<std::string> keys;
  keys.reserve(found.size());
  for (auto& [at, key] : found) keys.push_back(std::move(key));
  return keys;
}

int TomlTable::Depth(std::string_view key) const {
  int depth = 0;
  for (const toml::node* node = table_->get(key); node != nullptr && node->is_array(); ++depth) {
    node = node->as_array()->get(0);
  }
  return depth;
}

std::size_t TomlTable::Width(std::string_view key) const {
  if (Depth(key) < 2) return 0;
  const toml::array& rows = *table_->get(key)->as_array();
  return rows.get(0)->as_array()->size();
}

std::optional<TomlTable> TomlTable::FindTable(std::string_view key) {
  const toml::node* const node = Ask(key);
  if (!node) return std::nullopt;
  if (!node->is_table()) Refuse(key, fmt::format("must be a table, [{}]", key), FaultCode::kSyntax);
  return TomlTable(*document_, *node->as_table(), PathOf(key));
}

std::vector<TomlTable> TomlTable::FindTables(std::string_view key) {
  const toml::node* const node = Ask(key);
  if (!node) return {};
  const toml::array* const array = node->as_array();
  if (!array || (!array->empty() && !array->is_array_of_tables())) {
    Refuse(key, fmt::format("must be a list of tables, [[{}]]", key), FaultCode::kSyntax);
  }
  std::vector<TomlTable> tables;
  for (const toml::node& element : *array) {
    tables.push_back(TomlTable(*document_, *element.as_table(), PathOf(key), true));
  }
  return tables;
}

std::vector<std::pair<std::string, std::string>> TomlTable::Verbatim() {
  struct Entry {
    toml::source_position at;
    std::string key, value;
  };
  std::vector<Entry> entries;
  for (const auto& [name, node] : *table_) {
    document_->read_.insert(&node);
    Entry& entry = entries.emplace_back(Entry{name.source().begin, std::string(name.str()), {}});
    if (node.is_string()) {
      entry.value = node.as_string()->get();
      continue;
    }
    if (node.is_table() || node.is_array()) {
      Refuse(name.str(), "must be one value, not a list or table");
    }
    std::ostringstream text;
    node.visit([&](const auto& value) { text << value; });
    entry.value = text.str();
  }
  std::sort(entries.begin(), entries.end(),
            [](const Entry& a, const Entry& b) { return a.at < b.at; });
  std::vector<std::pair<std::string, std::string>> verbatim;
  verbatim.reserve(entries.size());
  for (Entry& e : entries) verbatim.emplace_back(std::move(e.key), std::move(e.value));
  return verbatim;
}

}  // namespace wellgyro
