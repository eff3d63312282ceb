#pragma once

#include <cstddef>
#include <istream>
#include <string>
#include <string_view>

#include "wellgyro/base/result.h"

namespace wellgyro {

/// Thrown inside io/ where text cannot be used; caught where a Result goes out.
struct TextError {
  Fault fault;
};

/// Lines of foreign text as UTF-8, one block in memory at a time: byte order mark and CR taken off,
/// Latin-1 turned into UTF-8 where a line is not UTF-8. Throws TextError for UTF-16, for NUL bytes,
/// for lines beyond 1 MiB and when the system fails.
class LineReader {
 public:
  LineReader(std::istream& bytes, std::string source);

  /// The next line, good until the next call; false at the end.
  bool Next(std::string_view& line);
  /// The line last given will be given again.
  void Back() { again_ = true; }
  int number() const { return number_; }  ///< of the line last given, from 1
  const std::string& source() const { return source_; }

  [[noreturn]] void Complain(FaultCode code, std::string text, int column = 0) const;

 private:
  bool Fill();

  std::istream& bytes_;
  std::string source_;
  std::string block_, line_;
  std::size_t at_ = 0;
  int number_ = 0;
  bool again_ = false;
};

}  // namespace wellgyro
