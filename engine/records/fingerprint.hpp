// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace montecarta::engine {

/// 64-bit XXH3 over bytes that are added piece by piece. Detects damaged data, but is no signature.
class Fingerprint {
 public:
  Fingerprint();
  ~Fingerprint();
  Fingerprint(const Fingerprint&) = delete;
  Fingerprint& operator=(const Fingerprint&) = delete;

  void add(std::span<const std::byte> bytes);
  /// The fingerprint of all bytes added so far. Never 0, which means "not stored" in a file.
  std::uint64_t value() const;

 private:
  alignas(64) std::byte state_[640];
};

/// SHA-256 as 64 lower-case hexadecimal digits, as printed by sha256sum.
std::string sha256(std::string_view text);

}  // namespace montecarta::engine
