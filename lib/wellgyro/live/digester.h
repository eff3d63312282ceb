#pragma once

#include <array>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/bus/message.h"
#include "wellgyro/io/sha256.h"

namespace wellgyro {

/// SHA-256 of the messages of each type, one after the other, made in a thread of its own: at full
/// speed hashing would take as long as surveying.
class WELLGYRO_EXPORT Digester {
 public:
  Digester();
  ~Digester();
  Digester(const Digester&) = delete;
  Digester& operator=(const Digester&) = delete;

  void Take(MessageType type, std::span<const std::byte> bytes);
  /// Of all that was taken; waits for it.
  std::string HexDigest(MessageType type);

 private:
  /// Bytes of messages, and how many of which type stand one after the other.
  struct Block {
    struct Piece {
      std::size_t type, size;
    };
    std::vector<std::byte> bytes;
    std::vector<Piece> pieces;
  };
  void HandOver();
  void Work();

  std::array<Sha256, kMessageTypes> digests_;
  Block filling_, hashing_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool busy_ = false;  ///< hashing_ belongs to the thread
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace wellgyro
