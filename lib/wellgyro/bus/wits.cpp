#include "wellgyro/bus/wits.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/record/limits.h"

namespace wellgyro {
namespace {

// What a sender puts where it has no value.
constexpr double kNulls[] = {-9999, -8888, -999.25};

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

bool IsItem(std::string_view line) {
  if (line.size() < 4) return false;
  for (const char c : line.substr(0, 4)) {
    if (!IsDigit(c)) return false;
  }
  for (const char c : line) {
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7e) return false;
  }
  return true;
}

std::string_view Trimmed(std::string_view text) {
  while (!text.empty() && (text.back() == ' ' || text.back() == '\r')) text.remove_suffix(1);
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  return text;
}

/// Six digits as three numbers of two.
bool Pairs(const std::string& text, int (&pairs)[3]) {
  if (text.size() != 6) return false;
  for (std::size_t i = 0; i < 6; ++i) {
    if (!IsDigit(text[i])) return false;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    pairs[i] = 10 * (text[2 * i] - '0') + (text[2 * i + 1] - '0');
  }
  return true;
}

}  // namespace

void WitsReader::Take(std::string_view bytes) {
  for (const char c : bytes) {
    if (c == '\n') {
      TakeLine();
      line_.clear();
      line_too_long_ = false;
    } else if (line_.size() < kLineMax) {
      line_ += c;
    } else {
      line_too_long_ = true;
    }
  }
}

void WitsReader::Cut() {
  line_.clear();
  line_too_long_ = false;
  if (std::exchange(inside_, false)) Bad("is cut");
}

void WitsReader::TakeLine() {
  const std::string_view line = Trimmed(line_);
  if (line == "&&") {
    if (inside_) Bad("has no end");
    inside_ = true;
    wrong_.clear();
    values_.clear();
  } else if (line == "!!") {
    if (std::exchange(inside_, false)) EndRecord();
  } else if (inside_ && !line.empty()) {
    const bool room = values_.size() < kItemsMax;
    if (!IsItem(line) || line_too_long_ || !room) {
      wrong_ = "has a line that is no item";
      return;
    }
    int number = 0;
    std::from_chars(line.data(), line.data() + 4, number);
    const bool again = !values_.try_emplace(number, Trimmed(line.substr(4))).second;
    if (again) wrong_ = fmt::format("has item {:04} twice", number);
  }
}

void WitsReader::Bad(const std::string& why) {
  ++bad_;
  tell_({.code = FaultCode::kSyntax, .text = fmt::format("a WITS record {} and is left out", why)});
}

std::optional<double> WitsReader::Number(int item) const {
  const auto found = values_.find(item);
  if (found == values_.end() || found->second.empty()) return std::nullopt;
  const std::string& text = found->second;
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<UtcTime> WitsReader::Time() const {
  namespace calendar = std::chrono;
  const auto date = values_.find(items_.date), time = values_.find(items_.time);
  int day[3], clock[3];
  if (date == values_.end() || time == values_.end()) return std::nullopt;
  if (!Pairs(date->second, day) || !Pairs(time->second, clock)) return std::nullopt;
  const calendar::year_month_day ymd{calendar::year(2000 + day[0]),
                                     calendar::month(static_cast<unsigned>(day[1])),
                                     calendar::day(static_cast<unsigned>(day[2]))};
  if (!ymd.ok() || clock[0] > 23 || clock[1] > 59 || clock[2] > 59) return std::nullopt;
  const std::int64_t days = calendar::sys_days(ymd).time_since_epoch().count();
  const std::int64_t seconds = 86'400 * days + 3600 * clock[0] + 60 * clock[1] + clock[2];
  return UtcTime{seconds * 1'000'000'000} - Duration::Seconds(items_.utc_offset);
}

void WitsReader::EndRecord() {
  if (!wrong_.empty()) return Bad(wrong_);
  // Records of other kinds have neither.
  if (!values_.contains(items_.bit_depth)) return;
  const std::optional<UtcTime> utc = Time();
  if (!utc) return Bad("has no time that can be");
  std::optional<double> depth = Number(items_.bit_depth);
  if (depth && std::ranges::find(kNulls, *depth) != std::end(kNulls)) depth.reset();
  const double md = depth.value_or(0) * items_.length_unit;
  if (!depth || std::abs(md) > limits::kMd) return Bad("has no depth that can be");
  if (last_ && *last_ == *utc) return;
  last_ = utc;
  DepthMark mark;
  mark.utc = *utc;
  mark.seq = seq_++;
  mark.session = session_;
  mark.kind = items_.kind;
  mark.md = md;
  if (items_.sigma > 0) mark.sigma = items_.sigma;
  ++marks_;
  use_(mark);
}

}  // namespace wellgyro
