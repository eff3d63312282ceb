#include "wellgyro/live/digester.h"

#include <utility>

namespace wellgyro {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 18;  // [bytes], handed to the thread at once

}  // namespace

Digester::Digester() : thread_([this] { Work(); }) {}

Digester::~Digester() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    changed_.notify_all();
  }
  thread_.join();
}

void Digester::Take(MessageType type, std::span<const std::byte> bytes) {
  const auto index = static_cast<std::size_t>(type);
  filling_.bytes.insert(filling_.bytes.end(), bytes.begin(), bytes.end());
  if (!filling_.pieces.empty() && filling_.pieces.back().type == index) {
    filling_.pieces.back().size += bytes.size();
  } else {
    filling_.pieces.push_back({index, bytes.size()});
  }
  if (filling_.bytes.size() >= kBlock) HandOver();
}

void Digester::HandOver() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !busy_; });
  std::swap(filling_, hashing_);
  busy_ = true;
  changed_.notify_all();
  lock.unlock();
  filling_.bytes.clear();
  filling_.pieces.clear();
}

std::string Digester::HexDigest(MessageType type) {
  if (!filling_.bytes.empty()) HandOver();
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !busy_; });
  return digests_[static_cast<std::size_t>(type)].HexDigest();
}

void Digester::Work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return busy_ || ending_; });
    if (!busy_) return;
    lock.unlock();
    std::span<const std::byte> rest(hashing_.bytes);
    for (const Block::Piece& piece : hashing_.pieces) {
      digests_[piece.type].Update(rest.first(piece.size));
      rest = rest.subspan(piece.size);
    }
    lock.lock();
    busy_ = false;
    changed_.notify_all();
  }
}

}  // namespace wellgyro
