#include "wellgyro/live/notices.h"

#include <utility>

#include <fmt/core.h>

namespace wellgyro {
namespace {

// Faults of one kind that are told as they come; then one a second, with their count.
constexpr std::int64_t kToldAtOnce = 10;

}  // namespace

std::string Printable(std::string_view text) {
  std::string printable;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    printable += byte >= 0x20 && byte < 0x7f ? std::string(1, c) : fmt::format("\\x{:02x}", byte);
  }
  return printable;
}

void Notices::Say(std::string_view sentence) {
  const std::lock_guard lock(mutex_);
  observer_.OnNotice(sentence);
}

void Notices::Tell(const Fault& fault) {
  const std::lock_guard lock(mutex_);
  Count& count = counts_[fault.code];
  const std::int64_t now = clock_.monotonic_us();
  if (count.told >= kToldAtOnce && now - count.last_us < kSecondUs) {
    ++count.untold;
    return;
  }
  observer_.OnNotice(SentenceOf(fault));
  if (const std::int64_t untold = std::exchange(count.untold, 0); untold > 0) {
    observer_.OnNotice(fmt::format("and {} more of this kind before", untold));
  }
  ++count.told;
  count.last_us = now;
}

}  // namespace wellgyro
