// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/fingerprint.hpp"

#include "engine/errors.hpp"
#include "engine/text/visible_text.hpp"

// XXH3 is inlined, so that it is compiled for the instruction set of the other files, which makes
// it three times faster than the shared library.
#define XXH_INLINE_ALL
#include <openssl/evp.h>
#include <xxhash.h>

#include <array>

namespace montecarta::engine {
namespace {

XXH3_state_t* state_in(std::byte* memory) { return reinterpret_cast<XXH3_state_t*>(memory); }

}  // namespace

Fingerprint::Fingerprint() {
  static_assert(sizeof(XXH3_state_t) <= sizeof(state_) && alignof(XXH3_state_t) <= 64);
  XXH3_64bits_reset(std::construct_at(state_in(state_)));
}

Fingerprint::~Fingerprint() { std::destroy_at(state_in(state_)); }

void Fingerprint::add(std::span<const std::byte> bytes) {
  if (!bytes.empty()) XXH3_64bits_update(state_in(state_), bytes.data(), bytes.size());
}

std::uint64_t Fingerprint::value() const {
  const std::uint64_t digest = XXH3_64bits_digest(reinterpret_cast<const XXH3_state_t*>(state_));
  return digest == 0 ? 1 : digest;
}

std::string sha256(std::string_view text) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned length = 0;
  const int done =
      EVP_Digest(text.data(), text.size(), digest.data(), &length, EVP_sha256(), nullptr);
  expect(done == 1 && length == 32, "libcrypto has no SHA-256");
  return hexadecimal({reinterpret_cast<const char*>(digest.data()), length});
}

}  // namespace montecarta::engine
