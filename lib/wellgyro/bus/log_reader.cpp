#include "wellgyro/bus/log_reader.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include <fmt/format.h>

#include "wellgyro/bus/bytes_internal.h"
#include "wellgyro/bus/foreign_file_internal.h"
#include "wellgyro/bus/log_format_internal.h"
#include "wellgyro/bus/log_source_internal.h"

namespace wellgyro {
namespace {

using log_format::kChannelAt;
using log_format::kChannelMax;
using log_format::kDataAt;
using log_format::kDataMax;
using log_format::kHeadSize;
using log_format::kNumberAt;
using log_format::kSync;
using log_format::kSyncSize;
using log_format::kTimeAt;

// How far to look for a first event before calling a file foreign: behind what is left of one whose
// head is missing, kDataMax at most, a second one may be damaged.
constexpr std::int64_t kSearchMax = 2 * static_cast<std::int64_t>(kDataMax);
constexpr std::size_t kBeginning = 64;  // [bytes], by which a file of another kind is told

struct Head {
  std::int64_t number = 0;
  std::int64_t received_us = 0;
  std::size_t channel_size = 0;
  std::size_t data_size = 0;
  std::size_t total() const { return kHeadSize + channel_size + data_size; }
};

enum class Found {
  kNothing,  ///< no head here
  kHead,
  kCut,  ///< the beginning of a head, and the end of the file
};

bool IsControlByte(std::byte b) { return b < std::byte{0x20} || b == std::byte{0x7F}; }

}  // namespace

class LogReader::Parser {
 public:
  Parser(std::string path, LogSource source) : path_(std::move(path)), source_(std::move(source)) {}

  std::optional<Fault> Begin();
  bool Next(LogEvent& event);
  const LogHealth& health() const { return health_; }
  const std::string& path() const { return path_; }

 private:
  bool IsSync(std::size_t at) const {
    return Load<std::uint32_t>(source_.view().data() + at) == kSync;
  }
  std::int64_t NumberAt(std::size_t at) const {
    return Load<std::int64_t>(source_.view().data() + at + kNumberAt);
  }
  Found LookAt(std::size_t at, Head& head);
  Found LookClosely(std::size_t at, Head& head);
  bool LeadsToNext(const Head& head);
  std::optional<std::size_t> OtherInside(const Head& head, bool whole);
  bool SkipTo(std::size_t from);
  void Lose(std::size_t size);
  void EndInside();
  bool End();
  bool Give(const Head& head, LogEvent& event);

  std::string path_;
  LogSource source_;
  std::size_t given_ = 0;  // bytes of the event last given out
  LogHealth health_;
};

std::optional<Fault> LogReader::Parser::Begin() {
  source_.Grow(kBeginning);
  const auto view = source_.view().first(std::min(kBeginning, source_.view().size()));
  const std::vector<std::byte> beginning(view.begin(), view.end());
  const bool found = SkipTo(0);
  if (source_.fault()) return source_.fault();
  if (found) return std::nullopt;
  if (health_.cut && health_.cut->offset == 0) {
    return Fault{FaultCode::kDamaged, fmt::format("{} ends inside its first event", path_), path_,
                 0};
  }
  return Fault{FaultCode::kForeign,
               fmt::format("{} {}: it is no LCM log", path_, ForeignFileText(beginning)), path_, 0};
}

Found LogReader::Parser::LookAt(std::size_t at, Head& head) {
  if (!source_.Grow(at + kSyncSize)) {
    // A file that ends with a part of the sync word was cut there.
    const std::array<std::byte, kSyncSize> sync = {std::byte{0xED}, std::byte{0xA1},
                                                   std::byte{0xDA}, std::byte{0x01}};
    const auto rest = source_.view().subspan(at);
    return std::equal(rest.begin(), rest.end(), sync.begin()) ? Found::kCut : Found::kNothing;
  }
  if (!IsSync(at)) return Found::kNothing;
  if (!source_.Grow(at + kHeadSize)) return Found::kCut;
  const std::byte* bytes = source_.view().data() + at;
  head.number = NumberAt(at);
  head.received_us = Load<std::int64_t>(bytes + kTimeAt);
  head.channel_size = Load<std::uint32_t>(bytes + kChannelAt);
  head.data_size = Load<std::uint32_t>(bytes + kDataAt);
  const bool plausible =
      head.channel_size >= 1 && head.channel_size <= kChannelMax && head.data_size <= kDataMax;
  return plausible ? Found::kHead : Found::kNothing;
}

/// For places that no event before has led to: the channel must look like one, too.
Found LogReader::Parser::LookClosely(std::size_t at, Head& head) {
  const Found found = LookAt(at, head);
  if (found != Found::kHead) return found;
  if (!source_.Grow(at + kHeadSize + head.channel_size)) return Found::kCut;
  const auto channel = source_.view().subspan(at + kHeadSize, head.channel_size);
  return std::none_of(channel.begin(), channel.end(), IsControlByte) ? Found::kHead
                                                                     : Found::kNothing;
}

/// The usual case, told without looking at the data: the next event begins where this one ends and
/// has the next number.
bool LogReader::Parser::LeadsToNext(const Head& head) {
  const std::size_t next = head.total();
  return source_.Grow(next + kTimeAt) && IsSync(next) && NumberAt(next) == head.number + 1;
}

/// Where another event begins inside this one, so that this one's length must be wrong. Data may
/// hold a log themselves: where the length does lead to the next event or to the end of the file,
/// the one inside counts only with the number that must come next.
std::optional<std::size_t> LogReader::Parser::OtherInside(const Head& head, bool whole) {
  const std::size_t end = std::min(head.total(), source_.view().size());
  const bool leads =
      whole && (!source_.Grow(end + 1) || (source_.Grow(end + kSyncSize) && IsSync(end)));
  for (std::size_t at = 1; at < end; ++at) {
    const std::byte* data = source_.view().data();
    const void* hit = std::memchr(data + at, 0xED, end - at);
    if (hit == nullptr) break;
    at = static_cast<std::size_t>(static_cast<const std::byte*>(hit) - data);
    Head inner;
    if (LookClosely(at, inner) != Found::kHead) continue;
    if (!leads || inner.number == head.number + 1) return at;
  }
  return std::nullopt;
}

/// Moves to the next head at or behind `from`; false when there is none. Where a head could have
/// been cut off by the end of the file, the search goes on: its lengths may be what is damaged.
bool LogReader::Parser::SkipTo(std::size_t from) {
  std::size_t at = from;
  std::optional<std::size_t> cut;
  while (source_.Grow(at + 1)) {
    const auto view = source_.view();
    const void* hit = std::memchr(view.data() + at, 0xED, view.size() - at);
    if (hit == nullptr) {
      if (cut) break;
      Lose(view.size());
      at = 0;
      if (health_.events == 0 && source_.offset() > kSearchMax) return false;
      continue;
    }
    at = static_cast<std::size_t>(static_cast<const std::byte*>(hit) - view.data());
    Head head;
    const Found found = LookClosely(at, head);
    if (found == Found::kHead) {
      Lose(at);
      return true;
    }
    if (found == Found::kCut && !cut) cut = at;
    ++at;
  }
  Lose(cut.value_or(source_.view().size()));
  if (cut) EndInside();
  return false;
}

void LogReader::Parser::Lose(std::size_t size) {
  if (size == 0) return;
  const auto length = static_cast<std::int64_t>(size);
  health_.lost_bytes += length;
  LogGap* last = health_.gaps.empty() ? nullptr : &health_.gaps.back();
  if (last != nullptr && last->offset + last->length == source_.offset()) {
    last->length += length;
  } else {
    ++health_.gap_count;
    if (health_.gaps.size() < LogHealth::kGapsMax) {
      health_.gaps.push_back({source_.offset(), length});
    }
  }
  source_.Drop(size);
}

void LogReader::Parser::EndInside() {
  const std::size_t rest = source_.view().size();
  health_.cut = LogGap{source_.offset(), static_cast<std::int64_t>(rest)};
  source_.Drop(rest);
}

bool LogReader::Parser::End() {
  health_.bytes = source_.offset();
  health_.io = source_.fault();
  return false;
}

bool LogReader::Parser::Give(const Head& head, LogEvent& event) {
  const std::byte* bytes = source_.view().data();
  event.number = head.number;
  event.received_us = head.received_us;
  event.channel = {reinterpret_cast<const char*>(bytes + kHeadSize), head.channel_size};
  event.data = {bytes + kHeadSize + head.channel_size, head.data_size};
  event.data_offset = source_.offset() + static_cast<std::int64_t>(kHeadSize + head.channel_size);
  given_ = head.total();
  ++health_.events;
  health_.bytes = source_.offset() + static_cast<std::int64_t>(given_);
  return true;
}

bool LogReader::Parser::Next(LogEvent& event) {
  source_.Drop(std::exchange(given_, 0));
  while (source_.Grow(1)) {
    Head head;
    const Found found = LookAt(0, head);
    if (found == Found::kHead) {
      if (LeadsToNext(head)) return Give(head, event);
      const bool whole = source_.Grow(head.total());
      const std::optional<std::size_t> other = OtherInside(head, whole);
      if (other) {
        Lose(*other);
      } else if (whole) {
        return Give(head, event);
      } else {
        EndInside();
      }
    } else if (found == Found::kCut) {
      EndInside();
    } else {
      SkipTo(1);
    }
  }
  return End();
}

LogReader::LogReader(std::unique_ptr<Parser> parser) : parser_(std::move(parser)) {}
LogReader::~LogReader() = default;
LogReader::LogReader(LogReader&&) noexcept = default;
LogReader& LogReader::operator=(LogReader&&) noexcept = default;

Result<LogReader> LogReader::Open(const std::string& path) {
  Result<LogSource> source = LogSource::Open(path);
  if (!source) return source.fault();
  auto parser = std::make_unique<Parser>(path, std::move(*source));
  if (std::optional<Fault> fault = parser->Begin()) return *std::move(fault);
  return LogReader(std::move(parser));
}

Result<LogReader> LogReader::OpenAt(const std::string& path, std::int64_t from) {
  if (from < 0) {
    return Fault{FaultCode::kRange, fmt::format("{} has no byte {}", path, from), path};
  }
  Result<LogSource> source = LogSource::Open(path);
  if (!source) return source.fault();
  if (static_cast<std::int64_t>(source->view().size()) < from) {
    return Fault{FaultCode::kDamaged, fmt::format("{} has become shorter", path), path, from};
  }
  source->Drop(static_cast<std::size_t>(from));
  return LogReader(std::make_unique<Parser>(path, std::move(*source)));
}

bool LogReader::Next(LogEvent& event) { return parser_->Next(event); }

const LogHealth& LogReader::health() const { return parser_->health(); }

std::vector<Fault> LogReader::Faults() const {
  const LogHealth& health = parser_->health();
  const std::string& path = parser_->path();
  std::vector<Fault> faults;
  for (const LogGap& gap : health.gaps) {
    faults.push_back(
        {FaultCode::kDamaged,
         fmt::format("{}: {} damaged bytes at byte {} were skipped", path, gap.length, gap.offset),
         path, gap.offset});
  }
  const auto untold = health.gap_count - static_cast<std::int64_t>(health.gaps.size());
  if (untold > 0) {
    faults.push_back(
        {FaultCode::kDamaged, fmt::format("{}: {} more damaged places", path, untold), path});
  }
  if (health.cut) {
    faults.push_back({FaultCode::kDamaged,
                      fmt::format("{} ends inside an event: its last {} bytes, from byte {} on, "
                                  "could not be used",
                                  path, health.cut->length, health.cut->offset),
                      path, health.cut->offset});
  }
  if (health.io) faults.push_back(*health.io);
  return faults;
}

}  // namespace wellgyro
