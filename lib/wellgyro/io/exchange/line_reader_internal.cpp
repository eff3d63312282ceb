#include "wellgyro/io/exchange/line_reader_internal.h"

#include <algorithm>
#include <utility>

#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

constexpr std::size_t kBlock = 1 << 18;
constexpr std::size_t kLongestLine = 1 << 20;

}  // namespace

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
  return got > 0;
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
  at_ = std::min(end + 1, block_.size());
  ++number_;
  if (number_ == 1) {
    if (raw.starts_with("\xFF\xFE") || raw.starts_with("\xFE\xFF")) {
      Complain(FaultCode::kForeign, "this is UTF-16 text: save it as UTF-8");
    }
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
