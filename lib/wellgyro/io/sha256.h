#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "wellgyro/base/export.h"

namespace wellgyro {

/// SHA-256 (FIPS 180-4) of bytes that come in pieces.
class WELLGYRO_EXPORT Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(Sha256&&) noexcept;
  Sha256& operator=(Sha256&&) noexcept;

  void Update(std::span<const std::byte> bytes);
  void Update(std::string_view bytes);

  /// Of all bytes so far, as 64 lower-case hexadecimal digits; more may follow.
  std::string HexDigest() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Of `bytes` alone.
WELLGYRO_EXPORT std::string Sha256Hex(std::string_view bytes);

}  // namespace wellgyro
