#include "wellgyro/io/text_internal.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>

namespace wellgyro {
namespace {

// Bytes of the UTF-8 sequence at the begin of `text`, 0 when there is none. Surrogates and
// overlong forms are let through: they do no harm here.
std::size_t SequenceLength(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xF5   ? 0
                             : first >= 0xF0 ? 4
                             : first >= 0xE0 ? 3
                             : first >= 0xC2 ? 2
                                             : 0;
  if (length == 0 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
  }
  return length;
}

// `text` without those characters at its ends; where nothing is left, the place where it began.
std::string_view Stripped(std::string_view text, std::string_view characters) {
  const std::size_t begin = text.find_first_not_of(characters);
  if (begin == std::string_view::npos) return text.substr(0, 0);
  return text.substr(begin, text.find_last_not_of(characters) + 1 - begin);
}

}  // namespace

std::string_view Trim(std::string_view text) { return Stripped(text, " \t"); }
std::string_view TrimCell(std::string_view text) { return Stripped(text, " \t\""); }

std::string LettersAndDigits(std::string_view text) {
  std::string kept;
  for (const char c : Lower(text)) {
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) kept += c;
  }
  return kept;
}

std::string Lower(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
  return lower;
}

std::string Capital(std::string_view word) {
  std::string capital(word);
  char& first = capital[0];
  if (first >= 'a' && first <= 'z') first = static_cast<char>(first - 32);
  return capital;
}

bool EqualNoCase(std::string_view a, std::string_view b) {
  return a.size() == b.size() && Lower(a) == Lower(b);
}

std::string ToUtf8(std::string_view text) {
  bool ascii = true;
  for (const char c : text) ascii = ascii && static_cast<unsigned char>(c) < 0x80;
  if (ascii) return std::string(text);
  bool valid = true;
  for (std::size_t i = 0; i < text.size() && valid;) {
    const std::size_t length = SequenceLength(text.substr(i));
    valid = length > 0;
    i += length;
  }
  if (valid) return std::string(text);
  std::string utf8;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80) {
      utf8 += c;
    } else {
      utf8 += static_cast<char>(0xC0 | (byte >> 6));
      utf8 += static_cast<char>(0x80 | (byte & 0x3F));
    }
  }
  return utf8;
}

void Split(std::string_view line, char delimiter, std::vector<std::string_view>& fields) {
  fields.clear();
  if (delimiter != ' ') {
    for (;;) {
      const std::size_t end = line.find(delimiter);
      fields.push_back(Trim(line.substr(0, end)));
      if (end == std::string_view::npos) return;
      line.remove_prefix(end + 1);
    }
  }
  for (;;) {
    const std::size_t begin = line.find_first_not_of(" \t");
    if (begin == std::string_view::npos) return;
    line.remove_prefix(begin);
    const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
    fields.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
}

void SplitCells(std::string_view line, char delimiter, std::vector<std::string_view>& cells) {
  Split(line, delimiter, cells);
  for (std::string_view& cell : cells) cell = TrimCell(cell);
}

char DelimiterOf(std::string_view line, char otherwise) {
  for (const char delimiter : {',', ';', '\t'}) {
    if (line.find(delimiter) != std::string_view::npos) return delimiter;
  }
  return otherwise;
}

void AddName(std::string_view name, std::string& names) {
  constexpr std::size_t kLongest = 1000;
  if (names.size() < kLongest) names.append(names.empty() ? "" : ", ").append(name);
}

std::string CsvQuoted(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += c;
    quoted += c;
  }
  return quoted + '"';
}

std::optional<std::vector<std::string>> SplitQuoted(std::string_view line, char delimiter) {
  std::vector<std::string> fields;
  if (delimiter == ' ' || line.find('"') == std::string_view::npos) {
    std::vector<std::string_view> plain;
    Split(line, delimiter, plain);
    fields.assign(plain.begin(), plain.end());
    return fields;
  }
  std::string field;
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quoted && c == '"' && i + 1 < line.size() && line[i + 1] == '"') {
      field += '"';
      ++i;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == delimiter && !quoted) {
      fields.emplace_back(Trim(field));
      field.clear();
    } else {
      field += c;
    }
  }
  if (quoted) return std::nullopt;
  fields.emplace_back(Trim(field));
  return fields;
}

std::optional<double> AnyNumberOf(std::string_view text) {
  text = Trim(text);
  if (text.size() > 1 && text.front() == '+' && text[1] != '-') text.remove_prefix(1);
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (rest != end || error == std::errc::invalid_argument) return std::nullopt;
  return error == std::errc() ? value : std::numeric_limits<double>::infinity();
}

std::optional<double> NumberOf(std::string_view text) {
  const std::optional<double> value = AnyNumberOf(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<int> IntegerOf(std::string_view text) {
  text = Trim(text);
  int value = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || rest != end) return std::nullopt;
  return value;
}

}  // namespace wellgyro
