#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "wellgyro/io/text_file.h"

namespace wellgyro {

/// Writes TOML line by line, the same bytes for the same values everywhere.
class TomlWriter {
 public:
  void Table(std::string_view name);    ///< [name], after an empty line
  void Element(std::string_view name);  ///< [[name]], after an empty line

  void Text(std::string_view key, std::string_view value);
  void Lines(std::string_view key, std::string_view value);  ///< text over several lines
  void Whole(std::string_view key, std::int64_t value);
  void Flag(std::string_view key, bool value);
  /// The shortest text that reads back as `value`, with a dot or exponent.
  void Number(std::string_view key, double value);

  void Numbers(std::string_view key, std::span<const double> values);
  void Wholes(std::string_view key, std::span<const int> values);
  /// A matrix by rows, each on a line of its own where there are several.
  void Rows(std::string_view key, const Eigen::MatrixXd& rows);
  void Texts(std::string_view key, std::span<const std::string> values);
  void Comment(std::string_view lines);  ///< each line behind "# "

  const std::string& text() const { return text_; }

 private:
  void Key(std::string_view key);
  std::string text_;
};

/// Role, name and SHA-256 of a file that was read.
void WriteInput(TomlWriter& toml, const InputFile& input);
/// An [[input]] of each.
void WriteInputs(TomlWriter& toml, std::span<const InputFile> inputs);

}  // namespace wellgyro
