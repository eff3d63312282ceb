#include "wellgyro/io/signature.h"

#include <memory>
#include <new>

#include <fmt/core.h>
#include <openssl/evp.h>
#include <openssl/pem.h>

#include "wellgyro/io/atomic_file.h"
#include "wellgyro/io/digest_context_internal.h"
#include "wellgyro/io/text_file.h"

namespace wellgyro {
namespace {

struct FreeKey {
  void operator()(EVP_PKEY* key) const { EVP_PKEY_free(key); }
};
struct FreeBio {
  void operator()(BIO* bio) const { BIO_free(bio); }
};
using Key = std::unique_ptr<EVP_PKEY, FreeKey>;
using Bio = std::unique_ptr<BIO, FreeBio>;

// Ed25519 is always there, so that all OpenSSL can refuse us is memory.
void Demand(bool done) {
  if (!done) throw std::bad_alloc();
}

const unsigned char* Raw(std::span<const std::byte> bytes) {
  return reinterpret_cast<const unsigned char*>(bytes.data());
}

unsigned char* Raw(std::vector<std::byte>& bytes) {
  return reinterpret_cast<unsigned char*>(bytes.data());
}

Key KeyOf(const PrivateKey& key) {
  Key made(
      EVP_PKEY_new_raw_private_key(EVP_PKEY_ED25519, nullptr, Raw(key.bytes), key.bytes.size()));
  Demand(made != nullptr);
  return made;
}

Result<PrivateKey> Refused(const std::filesystem::path& path) {
  return Fault{
      FaultCode::kForeign,
      "is no Ed25519 private key in PEM, as `openssl genpkey -algorithm ed25519` makes one",
      path.string()};
}

}  // namespace

PrivateKey NewPrivateKey() {
  EVP_PKEY* made = nullptr;
  const std::unique_ptr<EVP_PKEY_CTX, decltype(&EVP_PKEY_CTX_free)> context(
      EVP_PKEY_CTX_new_id(EVP_PKEY_ED25519, nullptr), EVP_PKEY_CTX_free);
  Demand(context != nullptr && EVP_PKEY_keygen_init(context.get()) == 1 &&
         EVP_PKEY_keygen(context.get(), &made) == 1);
  const Key key(made);
  PrivateKey result{std::vector<std::byte>(32)};
  std::size_t size = result.bytes.size();
  Demand(EVP_PKEY_get_raw_private_key(key.get(), Raw(result.bytes), &size) == 1);
  return result;
}

Result<PrivateKey> ReadPrivateKey(const std::filesystem::path& path) {
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return text.fault();
  const Bio bio(BIO_new_mem_buf(text->data(), static_cast<int>(text->size())));
  Demand(bio != nullptr);
  // Of a file with a pass phrase nobody is asked.
  const auto no_phrase = [](char*, int, int, void*) { return -1; };
  const Key key(PEM_read_bio_PrivateKey(bio.get(), nullptr, no_phrase, nullptr));
  if (!key || EVP_PKEY_id(key.get()) != EVP_PKEY_ED25519) return Refused(path);
  PrivateKey result{std::vector<std::byte>(32)};
  std::size_t size = result.bytes.size();
  Demand(EVP_PKEY_get_raw_private_key(key.get(), Raw(result.bytes), &size) == 1);
  return result;
}

std::optional<Fault> WritePrivateKey(const PrivateKey& key, const std::filesystem::path& path) {
  const Bio bio(BIO_new(BIO_s_mem()));
  Demand(bio != nullptr && PEM_write_bio_PrivateKey(bio.get(), KeyOf(key).get(), nullptr, nullptr,
                                                    0, nullptr, nullptr) == 1);
  char* text = nullptr;
  const long size = BIO_get_mem_data(bio.get(), &text);
  return WriteSecretFile(path, {text, static_cast<std::size_t>(size)});
}

std::vector<std::byte> PublicKeyOf(const PrivateKey& key) {
  std::vector<std::byte> result(kPublicKeySize);
  std::size_t size = result.size();
  Demand(EVP_PKEY_get_raw_public_key(KeyOf(key).get(), Raw(result), &size) == 1);
  return result;
}

std::vector<std::byte> Sign(const PrivateKey& key, std::span<const std::byte> message) {
  const Key made = KeyOf(key);
  const DigestContext context(EVP_MD_CTX_new());
  std::vector<std::byte> signature(kSignatureSize);
  std::size_t size = signature.size();
  Demand(context != nullptr &&
         EVP_DigestSignInit(context.get(), nullptr, nullptr, nullptr, made.get()) == 1 &&
         EVP_DigestSign(context.get(), Raw(signature), &size, Raw(message), message.size()) == 1);
  return signature;
}

bool Verify(std::span<const std::byte> public_key, std::span<const std::byte> message,
            std::span<const std::byte> signature) {
  if (public_key.size() != kPublicKeySize || signature.size() != kSignatureSize) return false;
  const Key key(
      EVP_PKEY_new_raw_public_key(EVP_PKEY_ED25519, nullptr, Raw(public_key), public_key.size()));
  const DigestContext context(EVP_MD_CTX_new());
  return key && context &&
         EVP_DigestVerifyInit(context.get(), nullptr, nullptr, nullptr, key.get()) == 1 &&
         EVP_DigestVerify(context.get(), Raw(signature), signature.size(), Raw(message),
                          message.size()) == 1;
}

std::string HexOf(std::span<const std::byte> bytes) {
  std::string hex;
  for (const std::byte byte : bytes) hex += fmt::format("{:02x}", std::to_integer<int>(byte));
  return hex;
}

std::optional<std::vector<std::byte>> BytesOfHex(std::string_view hex) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  if (hex.size() % 2 != 0) return std::nullopt;
  std::vector<std::byte> bytes;
  for (std::size_t i = 0; i < hex.size(); i += 2) {
    const std::size_t high = kDigits.find(hex[i]), low = kDigits.find(hex[i + 1]);
    if (high == std::string_view::npos || low == std::string_view::npos) return std::nullopt;
    bytes.push_back(static_cast<std::byte>(16 * high + low));
  }
  return bytes;
}

}  // namespace wellgyro
