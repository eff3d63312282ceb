#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"

/// Ed25519 (RFC 8032), by OpenSSL: who may order what of a survey.
namespace wellgyro {

inline constexpr std::size_t kPublicKeySize = 32;  ///< [bytes], Ed25519, RFC 8032
inline constexpr std::size_t kSignatureSize = 64;  ///< [bytes]

/// A private key. Files are PKCS 8 in PEM, as `openssl genpkey -algorithm ed25519` writes them.
struct PrivateKey {
  std::vector<std::byte> bytes;  ///< 32, secret
};

/// A key from OpenSSL's random generator.
WELLGYRO_EXPORT PrivateKey NewPrivateKey();
/// A Fault where the file cannot be read or holds no Ed25519 key.
WELLGYRO_EXPORT Result<PrivateKey> ReadPrivateKey(const std::filesystem::path& path);
/// For the owner's eyes alone; a Fault where the file exists.
WELLGYRO_EXPORT std::optional<Fault> WritePrivateKey(const PrivateKey& key,
                                                     const std::filesystem::path& path);

/// kPublicKeySize bytes.
WELLGYRO_EXPORT std::vector<std::byte> PublicKeyOf(const PrivateKey& key);
/// Ed25519 (RFC 8032), kSignatureSize bytes: the same for the same message.
WELLGYRO_EXPORT std::vector<std::byte> Sign(const PrivateKey& key,
                                            std::span<const std::byte> message);
/// False also for a key or signature of another size.
WELLGYRO_EXPORT bool Verify(std::span<const std::byte> public_key,
                            std::span<const std::byte> message,
                            std::span<const std::byte> signature);

/// Lower-case hexadecimal, two digits a byte.
WELLGYRO_EXPORT std::string HexOf(std::span<const std::byte> bytes);
/// Nothing where the text is anything else.
WELLGYRO_EXPORT std::optional<std::vector<std::byte>> BytesOfHex(std::string_view hex);

}  // namespace wellgyro
