#include "wellgyro/io/iso_time_internal.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <fmt/core.h>

#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

// Days since 1970-01-01 of the proleptic Gregorian calendar (H. Hinnant's days_from_civil).
std::int64_t DaysOf(int year, int month, int day) {
  const std::int64_t y = month <= 2 ? year - 1 : year;
  const std::int64_t era = (y >= 0 ? y : y - 399) / 400;
  const std::int64_t year_of_era = y - era * 400;
  const std::int64_t day_of_year = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
  return era * 146097 + year_of_era * 365 + year_of_era / 4 - year_of_era / 100 + day_of_year -
         719468;
}

std::optional<int> Digits(std::string_view text, std::size_t at, std::size_t count) {
  if (at + count > text.size()) return std::nullopt;
  for (const char c : text.substr(at, count)) {
    if (c < '0' || c > '9') return std::nullopt;
  }
  return IntegerOf(text.substr(at, count));
}

// +hh:mm, -hh:mm or Z, in seconds.
std::optional<int> ZoneOf(std::string_view zone) {
  if (zone == "Z" || zone == "z") return 0;
  const auto hours = Digits(zone, 1, 2);
  const auto minutes = Digits(zone, 4, 2);
  if (zone.size() != 6 || (zone[0] != '+' && zone[0] != '-') || zone[3] != ':' || !hours ||
      !minutes) {
    return std::nullopt;
  }
  return (zone[0] == '-' ? -1 : 1) * (*hours * 3600 + *minutes * 60);
}

}  // namespace

std::optional<double> UtcOf(std::string_view text) {
  text = Trim(text);
  const auto year = Digits(text, 0, 4), month = Digits(text, 5, 2), day = Digits(text, 8, 2);
  const auto hour = Digits(text, 11, 2), minute = Digits(text, 14, 2);
  const auto second = Digits(text, 17, 2);
  if (!year || !month || !day || !hour || !minute || !second || text[10] != 'T') return {};
  if (*month < 1 || *month > 12 || *day < 1 || *day > 31 || *hour > 24 || *minute > 59 ||
      *second > 60) {
    return std::nullopt;
  }
  std::size_t end = 19;
  double fraction = 0;
  if (end < text.size() && text[end] == '.') {
    end = std::min(text.find_first_not_of("0123456789", end + 1), text.size());
    const auto part = NumberOf("0" + std::string(text.substr(19, end - 19)));
    if (!part) return std::nullopt;
    fraction = *part;
  }
  const auto zone = ZoneOf(text.substr(end));
  if (!zone) return std::nullopt;
  const int clock = *hour * 3600 + *minute * 60 + *second - *zone;
  return static_cast<double>(DaysOf(*year, *month, *day) * 86400 + clock) + fraction;
}

std::string IsoUtc(double seconds) {
  auto micros = static_cast<std::int64_t>(std::llround((seconds - std::floor(seconds)) * 1e6));
  auto whole = static_cast<std::int64_t>(std::floor(seconds));
  if (micros == 1000000) {
    micros = 0;
    ++whole;
  }
  std::int64_t days = whole / 86400;
  if (whole % 86400 < 0) --days;
  const std::int64_t rest = whole - days * 86400;
  // Hinnant's civil_from_days.
  const std::int64_t z = days + 719468;
  const std::int64_t era = (z >= 0 ? z : z - 146096) / 146097;
  const std::int64_t day_of_era = z - era * 146097;
  const std::int64_t year_of_era =
      (day_of_era - day_of_era / 1460 + day_of_era / 36524 - day_of_era / 146096) / 365;
  const std::int64_t day_of_year =
      day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
  const std::int64_t shifted = (5 * day_of_year + 2) / 153;
  const std::int64_t day = day_of_year - (153 * shifted + 2) / 5 + 1;
  const std::int64_t month = shifted < 10 ? shifted + 3 : shifted - 9;
  const std::int64_t year = year_of_era + era * 400 + (month <= 2 ? 1 : 0);
  const std::string fraction =
      micros % 1000 == 0 ? fmt::format("{:03}", micros / 1000) : fmt::format("{:06}", micros);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{}Z", year, month, day, rest / 3600,
                     rest / 60 % 60, rest % 60, fraction);
}

}  // namespace wellgyro
