#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <toml++/toml.h>

#include "wellgyro/base/number_range.h"
#include "wellgyro/base/result.h"

namespace wellgyro {

/// Carries a Fault from any depth of a reader to its door, ReadTomlText. Never leaves io/.
struct TomlError {
  Fault fault;
};

using TomlRange = NumberRange;
inline constexpr TomlRange kAnyNumber{};
inline constexpr TomlRange kNotNegative{.min = 0};
inline constexpr TomlRange kPositive{.min = 0, .above_min = true};
inline constexpr TomlRange kLatitudeDeg{.min = -90, .max = 90};
inline constexpr TomlRange kLongitudeDeg{.min = -180, .max = 360};
inline constexpr TomlRange kAzimuthDeg{.min = -360, .max = 360};
inline constexpr TomlRange kInclinationDeg{.min = 0, .max = 180};

inline constexpr std::int64_t kInt32Most = std::numeric_limits<std::int32_t>::max();

/// A word of a file and what it stands for.
template <class T>
using TomlWords = std::initializer_list<std::pair<std::string_view, T>>;

/// A parsed file that remembers which of its keys were asked for.
class TomlDocument {
 public:
  /// Throws TomlError when `text` is not TOML or its format line is not `format`.
  TomlDocument(std::string_view text, std::string source, std::string_view format);

  const toml::table& root() const { return root_; }
  const std::string& source() const { return source_; }

  /// Every key that was asked for, there or not, after its table: "depth.cable.mark_spacing_m".
  const std::set<std::string>& asked() const { return asked_names_; }

  /// Throws TomlError that names the first key nobody asked for, and its like among those asked.
  void RefuseUnread() const;

 private:
  friend class TomlTable;
  const toml::table* FirstUnread(const toml::table& table, const toml::key** key) const;

  std::string source_;
  toml::table root_;
  std::set<const toml::node*> read_;
  std::map<const toml::table*, std::vector<std::string>> asked_;
  std::set<std::string> asked_names_;
};

/// One table of a document, read key by key. Find... give nothing where the key is absent; every
/// complaint is a TomlError with line and column.
class TomlTable {
 public:
  explicit TomlTable(TomlDocument& document)
      : TomlTable(document, document.root(), std::string()) {}

  bool Has(std::string_view key) const { return table_->contains(key); }
  bool empty() const { return table_->empty(); }

  std::optional<double> FindNumber(std::string_view key, TomlRange range);
  std::optional<std::int64_t> FindInteger(std::string_view key, std::int64_t min, std::int64_t max);
  std::optional<bool> FindBool(std::string_view key);
  std::optional<std::string> FindString(std::string_view key);
  std::optional<std::vector<double>> FindNumbers(std::string_view key, TomlRange range);
  std::optional<std::vector<std::string>> FindStrings(std::string_view key);
  /// Rows of equal length, as a matrix or a list of pairs.
  std::optional<std::vector<std::vector<double>>> FindRows(std::string_view key, std::size_t width);
  std::optional<TomlTable> FindTable(std::string_view key);
  std::vector<TomlTable> FindTables(std::string_view key);  ///< [[key]]; empty where absent
  template <class T>
  std::optional<T> FindWord(std::string_view key, TomlWords<T> words);
  /// Which of `words` it is; one that is empty is none.
  std::optional<std::size_t> FindPlace(std::string_view key,
                                       std::span<const std::string_view> words);

  /// The value of `found`, which must be there: Need("latitude_deg", FindNumber(...)).
  template <class T>
  T Need(std::string_view key, std::optional<T> found);

  /// value = number * unit where the key is there; as it was where not.
  template <class T>
  void Read(std::string_view key, T& value, double unit = 1, TomlRange range = kAnyNumber);

  /// Every key, in the file's order; none counts as read by it.
  std::vector<std::string> Keys() const;
  /// How deep the value of `key` is nested in lists: 0 for a number or text.
  int Depth(std::string_view key) const;
  /// Length of the first list in the list `key`; 0 where it is none.
  std::size_t Width(std::string_view key) const;
  /// Every key and its value as text, in the file's order.
  std::vector<std::pair<std::string, std::string>> Verbatim();

  /// Complains about `key`, which may be absent, or about the whole table where it is empty.
  [[noreturn]] void Refuse(std::string_view key, std::string_view why,
                           FaultCode code = FaultCode::kRange) const;
  /// Complains that `key` is absent, or about the unknown key that seems to be meant for it.
  [[noreturn]] void RefuseAbsent(std::string_view key, std::string_view why) const;

 private:
  TomlTable(TomlDocument& document, const toml::table& table, std::string path,
            bool of_list = false)
      : document_(&document), table_(&table), path_(std::move(path)), of_list_(of_list) {}

  const toml::node* Ask(std::string_view key);
  double NumberOf(const toml::node& node, std::string_view key, TomlRange range) const;
  std::string PathOf(std::string_view key) const;
  std::string Named(std::string_view key) const;

  TomlDocument* document_;
  const toml::table* table_;
  std::string path_;  ///< "depth.cable"; empty for the top
  bool of_list_;      ///< one of [[run]]
};

/// `read` over the text of one file; every key it leaves is an error.
template <class T>
Result<T> ReadTomlText(std::string_view text, const std::string& source, std::string_view format,
                       const std::function<T(TomlTable&)>& read) {
  try {
    TomlDocument document(text, source, format);
    TomlTable root(document);
    T value = read(root);
    document.RefuseUnread();
    return value;
  } catch (const TomlError& error) {
    return error.fault;
  }
}

template <class T>
std::optional<T> TomlTable::FindWord(std::string_view key, TomlWords<T> words) {
  std::vector<std::string_view> names;
  for (const auto& [name, value] : words) names.push_back(name);
  const auto place = FindPlace(key, names);
  if (!place) return std::nullopt;
  return std::next(words.begin(), static_cast<std::ptrdiff_t>(*place))->second;
}

template <class T>
T TomlTable::Need(std::string_view key, std::optional<T> found) {
  if (!found) RefuseAbsent(key, "is missing");
  return *std::move(found);
}

template <class T>
void TomlTable::Read(std::string_view key, T& value, double unit, TomlRange range) {
  if constexpr (std::is_same_v<T, bool>) {
    value = FindBool(key).value_or(value);
  } else if constexpr (std::is_same_v<T, std::string>) {
    if (auto found = FindString(key)) value = *std::move(found);
  } else {
    if (const auto found = FindNumber(key, range)) value = *found * unit;
  }
}

}  // namespace wellgyro
