#pragma once

#include <string>
#include <string_view>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"

namespace wellgyro {

/// Bytes of a rig's computer: "tcp://HOST:PORT", to which it connects, or a serial line such as
/// "/dev/ttyS0", eight bits, no parity, one stop bit.
class WELLGYRO_EXPORT ByteStream {
 public:
  static constexpr int kBaud = 9600;  ///< what WITS level 0 is sent with where nobody says another

  /// Waits for `patience_ms` at most until it is connected.
  static Result<ByteStream> Open(const std::string& where, int baud = kBaud,
                                 int patience_ms = 2000);
  ~ByteStream();
  ByteStream(ByteStream&& other) noexcept;
  ByteStream& operator=(ByteStream&& other) noexcept;

  /// What has come, or comes within so long; empty where nothing does; a Fault when the line is
  /// cut. Valid until the next Read.
  Result<std::string_view> Read(int patience_ms);

 private:
  ByteStream(std::string where, int descriptor);
  std::string where_;
  std::string buffer_;
  int descriptor_ = -1;
};

}  // namespace wellgyro
