// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/sha256.hpp"

#include "engine/errors.hpp"

#include <openssl/evp.h>

#include <array>

namespace montecarta::engine {

std::string sha256(std::string_view text) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned length = 0;
  const int done =
      EVP_Digest(text.data(), text.size(), digest.data(), &length, EVP_sha256(), nullptr);
  expect(done == 1 && length == 32, "libcrypto has no SHA-256");
  constexpr std::string_view digits = "0123456789abcdef";
  std::string hexadecimal;
  for (unsigned i = 0; i < length; ++i) {
    hexadecimal += digits[digest[i] >> 4U];
    hexadecimal += digits[digest[i] & 15U];
  }
  return hexadecimal;
}

}  // namespace montecarta::engine
