#pragma once

#include <memory>

#include <openssl/evp.h>

namespace wellgyro {

struct FreeDigestContext {
  void operator()(EVP_MD_CTX* context) const { EVP_MD_CTX_free(context); }
};
/// OpenSSL's state of one hash or signature.
using DigestContext = std::unique_ptr<EVP_MD_CTX, FreeDigestContext>;

}  // namespace wellgyro
