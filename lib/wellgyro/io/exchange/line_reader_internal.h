#pragma once

#include <cstddef>
#include <cstdint>
#include <istream>
#include <optional>
#include <string>
#include <string_view>

#include "wellgyro/base/result.h"
#include "wellgyro/io/exchange/certificate_internal.h"
#include "wellgyro/io/sha256.h"

namespace wellgyro {

/// Thrown inside io/ where text cannot be used; caught where a Result goes out.
struct TextError {
  Fault fault;
};

/// UTF-16 as UTF-8; halves of pairs that stand alone become U+FFFD. `rest`: bytes at the end that
/// are no whole character yet.
std::string Utf8OfUtf16(std::string_view raw, bool little, std::string& rest);

/// Lines of foreign text as UTF-8, one block in memory at a time: byte order mark and CR taken off,
/// UTF-16 with its mark and, line by line, Latin-1 turned into UTF-8. Throws TextError for NUL
/// bytes, for lines beyond 1 MiB and when the system fails.
class LineReader {
 public:
  LineReader(std::istream& bytes, std::string source);

  /// The next line, good until the next call; false at the end.
  bool Next(std::string_view& line);
  /// The line last given will be given again.
  void Back() { again_ = true; }
  /// What is in memory of the text after the line last given, at most some hundred kilobytes, as
  /// the file has it; that line too where it will be given again.
  std::string Ahead();
  int number() const { return number_; }  ///< of the line last given, from 1
  const std::string& source() const { return source_; }

  /// To be asked at the end: what the file says of its own bytes, held against them. Throws, kSize,
  /// where some are missing; a sentence where they are others than were written.
  std::string CheckCertificate() const;
  bool certified() const { return certificate_.has_value(); }

  [[noreturn]] void Complain(FaultCode code, std::string text, int column = 0) const;

 private:
  bool Fill();
  void Count(std::string_view raw);
  void Decode(std::size_t had);

  std::istream& bytes_;
  std::string source_;
  std::string block_, line_;
  std::string odd_;  ///< begin of a character in UTF-16
  std::size_t at_ = 0;
  enum class Encoding { kUnseen, kBytes, kLittleEndian, kBigEndian } encoding_ = Encoding::kUnseen;
  std::optional<FileCertificate> certificate_;
  Sha256 below_;
  std::int64_t bytes_below_ = 0;
  int number_ = 0;
  bool again_ = false;
};

}  // namespace wellgyro
