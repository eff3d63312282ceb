#include "wellgyro/bus/splice.h"

#include <algorithm>
#include <functional>

namespace wellgyro {

MessageKey KeyOf(std::string_view channel, std::span<const std::byte> bytes, bool once) {
  const std::hash<std::string_view> hash;
  const std::uint64_t data = hash({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  return {data * 31 + hash(channel), once};
}

void Splice::Used(const MessageKey& key) {
  used_.push_back(key);
  if (used_.size() > kKept) used_.pop_front();
}

std::optional<std::size_t> Splice::Find(std::span<const MessageKey> next) const {
  const auto last =
      std::find_if(used_.rbegin(), used_.rend(), [](const MessageKey& key) { return key.once; });
  if (last == used_.rend()) return std::nullopt;
  const auto found = std::find_if(next.begin(), next.end(), [last](const MessageKey& key) {
    return key.once && key.hash == last->hash;
  });
  if (found == next.end()) return std::nullopt;
  return static_cast<std::size_t>(found - next.begin());
}

void Splice::Turn() {
  before_turn_.clear();
  for (auto used = used_.rbegin(); used != used_.rend() && !used->once; ++used) {
    before_turn_.push_back(*used);
  }
}

bool Splice::WasUsed(const MessageKey& key) {
  if (key.once) return false;
  const auto found = std::find_if(before_turn_.begin(), before_turn_.end(),
                                  [&key](const MessageKey& used) { return used.hash == key.hash; });
  if (found == before_turn_.end()) return false;
  before_turn_.erase(found);
  return true;
}

}  // namespace wellgyro
