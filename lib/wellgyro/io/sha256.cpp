#include "wellgyro/io/sha256.h"

#include <array>
#include <new>

#include <openssl/evp.h>

#include "wellgyro/io/digest_context_internal.h"

namespace wellgyro {
namespace {

// SHA-256 is always there, so that all OpenSSL can refuse us is memory.
void Demand(int done) {
  if (done != 1) throw std::bad_alloc();
}

DigestContext NewContext() {
  DigestContext context(EVP_MD_CTX_new());
  if (!context) throw std::bad_alloc();
  return context;
}

}  // namespace

struct Sha256::State {
  DigestContext context = NewContext();
};

Sha256::Sha256() : state_(std::make_unique<State>()) {
  Demand(EVP_DigestInit_ex(state_->context.get(), EVP_sha256(), nullptr));
}
Sha256::~Sha256() = default;
Sha256::Sha256(Sha256&&) noexcept = default;
Sha256& Sha256::operator=(Sha256&&) noexcept = default;

void Sha256::Update(std::span<const std::byte> bytes) {
  Demand(EVP_DigestUpdate(state_->context.get(), bytes.data(), bytes.size()));
}

void Sha256::Update(std::string_view bytes) { Update(std::as_bytes(std::span(bytes))); }

std::string Sha256::HexDigest() const {
  const DigestContext copy = NewContext();
  Demand(EVP_MD_CTX_copy_ex(copy.get(), state_->context.get()));
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  Demand(EVP_DigestFinal_ex(copy.get(), digest.data(), &size));
  std::string text;
  for (unsigned int i = 0; i < size; ++i) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    text += kDigits[digest[i] >> 4];
    text += kDigits[digest[i] & 15];
  }
  return text;
}

std::string Sha256Hex(std::string_view bytes) {
  Sha256 hash;
  hash.Update(bytes);
  return hash.HexDigest();
}

}  // namespace wellgyro
