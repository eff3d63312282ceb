#include "wellgyro/io/toml/toml_writer_internal.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

#include <fmt/core.h>
#include <fmt/ranges.h>

namespace wellgyro {
namespace {

// Length of the UTF-8 character at the head of `text`; 0 when there is none (RFC 3629).
std::size_t CharacterLength(std::string_view text) {
  const auto at = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned lead = at(0);
  if (lead < 0x80) return 1;
  const std::size_t length = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((at(i) & 0xC0) != 0x80) return 0;
  }
  // Overlong forms, surrogates, beyond U+10FFFF.
  const unsigned second = at(1);
  const bool odd = (lead == 0xE0 && second < 0xA0) || (lead == 0xED && second > 0x9F) ||
                   (lead == 0xF0 && second < 0x90) || (lead == 0xF4 && second > 0x8F);
  return odd ? 0 : length;
}

// What came from a wire need not be UTF-8; a TOML file must be.
std::string Escaped(std::string_view text, bool keep_newlines) {
  std::string escaped;
  while (!text.empty()) {
    const std::size_t length = CharacterLength(text);
    const char c = text.front();
    if (length == 0) {
      escaped += "\\uFFFD";
    } else if (c == '"' || c == '\\') {
      escaped += '\\';
      escaped += c;
    } else if (c == '\n' && keep_newlines) {
      escaped += c;
    } else if (length == 1 && (static_cast<unsigned char>(c) < 0x20 || c == 0x7F)) {
      escaped += fmt::format("\\u{:04X}", static_cast<unsigned>(c));
    } else {
      escaped += text.substr(0, length);
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return escaped;
}

bool IsBareKey(std::string_view key) {
  return !key.empty() && key.find_first_not_of(
                             "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
                             "abcdefghijklmnopqrstuvwxyz0123456789_-") == std::string_view::npos;
}

std::string NumberText(double value) {
  assert(std::isfinite(value));
  // Adding zero turns a negative zero positive.
  std::string number = fmt::format("{}", value + 0.0);
  if (number.find_first_of(".en") == std::string::npos) number += ".0";
  return number;
}

}  // namespace

void TomlWriter::Table(std::string_view name) { text_ += fmt::format("\n[{}]\n", name); }

void TomlWriter::Element(std::string_view name) { text_ += fmt::format("\n[[{}]]\n", name); }

void TomlWriter::Key(std::string_view key) {
  text_ += IsBareKey(key) ? std::string(key) : fmt::format("\"{}\"", Escaped(key, false));
  text_ += " = ";
}

void TomlWriter::Text(std::string_view key, std::string_view value) {
  Key(key);
  text_ += fmt::format("\"{}\"\n", Escaped(value, false));
}

void TomlWriter::Lines(std::string_view key, std::string_view value) {
  Key(key);
  // A newline right behind the opening quotes is not part of the value.
  text_ += fmt::format("\"\"\"\n{}\"\"\"\n", Escaped(value, true));
}

void TomlWriter::Whole(std::string_view key, std::int64_t value) {
  Key(key);
  text_ += fmt::format("{}\n", value);
}

void TomlWriter::Flag(std::string_view key, bool value) {
  Key(key);
  text_ += value ? "true\n" : "false\n";
}

void TomlWriter::Number(std::string_view key, double value) {
  Key(key);
  text_ += NumberText(value) + '\n';
}

void TomlWriter::Numbers(std::string_view key, std::span<const double> values) {
  Key(key);
  text_ += '[';
  for (std::size_t i = 0; i < values.size(); ++i) {
    text_ += (i > 0 ? ", " : "") + NumberText(values[i]);
  }
  text_ += "]\n";
}

void TomlWriter::Wholes(std::string_view key, std::span<const int> values) {
  Key(key);
  text_ += fmt::format("[{}]\n", fmt::join(values, ", "));
}

void TomlWriter::Rows(std::string_view key, const Eigen::MatrixXd& rows) {
  Key(key);
  text_ += '[';
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    text_ += rows.rows() > 1 ? "\n  [" : "[";
    for (Eigen::Index j = 0; j < rows.cols(); ++j) {
      text_ += (j > 0 ? ", " : "") + NumberText(rows(i, j));
    }
    text_ += rows.rows() > 1 ? "]," : "]";
  }
  text_ += rows.rows() > 1 ? "\n]\n" : "]\n";
}

void TomlWriter::Texts(std::string_view key, std::span<const std::string> values) {
  Key(key);
  text_ += '[';
  for (std::size_t i = 0; i < values.size(); ++i) {
    text_ += fmt::format("{}\"{}\"", i > 0 ? ", " : "", Escaped(values[i], false));
  }
  text_ += "]\n";
}

void TomlWriter::Comment(std::string_view lines) {
  while (!lines.empty()) {
    const std::size_t end = std::min(lines.find('\n'), lines.size());
    text_ += fmt::format("# {}", lines.substr(0, end));
    while (text_.back() == ' ') text_.pop_back();
    text_ += '\n';
    lines.remove_prefix(std::min(end + 1, lines.size()));
  }
}

void WriteInput(TomlWriter& toml, const InputFile& input) {
  toml.Text("role", input.role);
  toml.Text("name", input.name);
  toml.Text("sha256", input.sha256);
}

void WriteInputs(TomlWriter& toml, std::span<const InputFile> inputs) {
  for (const InputFile& input : inputs) {
    toml.Element("input");
    WriteInput(toml, input);
  }
}

}  // namespace wellgyro
