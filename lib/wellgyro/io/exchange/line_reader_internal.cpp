#include "wellgyro/io/exchange/line_reader_internal.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

constexpr std::size_t kBlock = 1 << 18;        // [bytes], of one read
constexpr std::size_t kLongestLine = 1 << 20;  // [bytes]; a file without line ends is no table

void AppendUtf8(std::string& text, unsigned code) {
  if (code < 0x80) {
    text += static_cast<char>(code);
  } else if (code < 0x800) {
    text += static_cast<char>(0xC0 | (code >> 6));
    text += static_cast<char>(0x80 | (code & 0x3F));
  } else if (code < 0x10000) {
    text += static_cast<char>(0xE0 | (code >> 12));
    text += static_cast<char>(0x80 | ((code >> 6) & 0x3F));
    text += static_cast<char>(0x80 | (code & 0x3F));
  } else {
    text += static_cast<char>(0xF0 | (code >> 18));
    text += static_cast<char>(0x80 | ((code >> 12) & 0x3F));
    text += static_cast<char>(0x80 | ((code >> 6) & 0x3F));
    text += static_cast<char>(0x80 | (code & 0x3F));
  }
}

constexpr unsigned kReplacement = 0xFFFD;
bool IsHigh(unsigned unit) { return unit >= 0xD800 && unit < 0xDC00; }
bool IsLow(unsigned unit) { return unit >= 0xDC00 && unit < 0xE000; }

}  // namespace

std::string Utf8OfUtf16(std::string_view raw, bool little, std::string& rest) {
  const auto unit = [&](std::size_t i) -> unsigned {
    const auto a = static_cast<unsigned char>(raw[i]), b = static_cast<unsigned char>(raw[i + 1]);
    return little ? a | (b << 8U) : b | (a << 8U);
  };
  std::string text;
  std::size_t i = 0;
  for (; i + 1 < raw.size(); i += 2) {
    unsigned code = unit(i);
    if (IsHigh(code)) {
      if (i + 3 >= raw.size()) break;
      const unsigned low = unit(i + 2);
      if (IsLow(low)) {
        code = 0x10000 + ((code - 0xD800) << 10) + (low - 0xDC00);
        i += 2;
      } else {
        code = kReplacement;
      }
    } else if (IsLow(code)) {
      code = kReplacement;
    }
    AppendUtf8(text, code);
  }
  rest = raw.substr(i);
  return text;
}

LineReader::LineReader(std::istream& bytes, std::string source)
    : bytes_(bytes), source_(std::move(source)) {}

void LineReader::Complain(FaultCode code, std::string text, int column) const {
  throw TextError{{.code = code,
                   .text = std::move(text),
                   .source = source_,
                   .line = number_,
                   .column = column}};
}

bool LineReader::Fill() {
  block_.erase(0, at_);
  at_ = 0;
  const std::size_t had = block_.size();
  block_.resize(had + kBlock);
  bytes_.read(block_.data() + had, static_cast<std::streamsize>(kBlock));
  const auto got = static_cast<std::size_t>(std::max<std::streamsize>(bytes_.gcount(), 0));
  block_.resize(had + got);
  if (bytes_.bad()) Complain(FaultCode::kIo, "reading this file failed half way");
  if (encoding_ == Encoding::kUnseen) {
    encoding_ = block_.starts_with("\xFF\xFE")   ? Encoding::kLittleEndian
                : block_.starts_with("\xFE\xFF") ? Encoding::kBigEndian
                                                 : Encoding::kBytes;
  }
  if (encoding_ != Encoding::kBytes) Decode(had);
  return got > 0;
}

void LineReader::Decode(std::size_t had) {
  const std::string raw = odd_ + block_.substr(had);
  block_.resize(had);
  block_ += Utf8OfUtf16(raw, encoding_ == Encoding::kLittleEndian, odd_);
}

std::string LineReader::Ahead() {
  if (block_.size() - at_ < kBlock / 2) Fill();
  return (again_ ? line_ + "\n" : std::string()) + block_.substr(at_);
}

void LineReader::Count(std::string_view raw) {
  if (certificate_) {
    below_.Update(raw);
    bytes_below_ += static_cast<std::int64_t>(raw.size());
  } else if (number_ < 100) {
    certificate_ = CertificateIn(raw);
  }
}

std::string LineReader::CheckCertificate() const {
  if (!certificate_) return {};
  if (bytes_below_ < certificate_->bytes) {
    throw TextError{{.code = FaultCode::kSize,
                     .text = fmt::format("the file is cut: {} of {} bytes, where its head promises "
                                         "{} stations",
                                         bytes_below_, certificate_->bytes, certificate_->stations),
                     .source = source_,
                     .line = number_}};
  }
  if (below_.HexDigest() == certificate_->sha256) return {};
  return "the file was changed after it was written: its SHA-256 is another than its head says";
}

bool LineReader::Next(std::string_view& line) {
  if (again_) {
    again_ = false;
    line = line_;
    return true;
  }
  std::size_t end = block_.find('\n', at_);
  while (end == std::string::npos) {
    const std::size_t searched = block_.size() - at_;
    if (searched > kLongestLine) {
      ++number_;
      Complain(FaultCode::kForeign, "a line of more than a mebibyte: this is no survey file");
    }
    if (!Fill()) {
      if (block_.size() == at_) return false;
      end = block_.size();
      break;
    }
    end = block_.find('\n', at_ + searched);
  }
  std::string_view raw(block_.data() + at_, end - at_);
  const std::size_t after = std::min(end + 1, block_.size());
  Count(std::string_view(block_).substr(at_, after - at_));
  at_ = after;
  ++number_;
  if (number_ == 1) {
    if (raw.starts_with("\xEF\xBB\xBF")) raw.remove_prefix(3);
  }
  if (raw.ends_with('\r')) raw.remove_suffix(1);
  if (raw.find('\0') != std::string_view::npos) {
    Complain(FaultCode::kForeign, "holds a zero byte: this is no text file");
  }
  line_ = ToUtf8(raw);
  line = line_;
  return true;
}

}  // namespace wellgyro
