#include "console.h"

#include <fmt/core.h>

#include "wellgyro/live/glance_line.h"

#include "live.h"

namespace wellgyro::apps {
namespace {

constexpr std::int64_t kPlainUs = 4'500'000;  // so that no silence is longer than 5 s

}  // namespace

Console::Console() : said_us_(MonotonicUs()) {}

void Console::OnNotice(std::string_view sentence) {
  voice_.Say(fmt::format("wellgyro: {}", sentence));
  said_us_ = MonotonicUs();
}

void Console::OnGlance(const Glance& glance) {
  Show(advice_.empty() ? LineOf(glance) : fmt::format("{} | {}", advice_, LineOf(glance)));
}

void Console::Show(const std::string& line) {
  const std::int64_t now = MonotonicUs();
  if (!voice_.on_terminal() && now - said_us_ < kPlainUs) return;
  voice_.Show(line);
  said_us_ = now;
}

}  // namespace wellgyro::apps
