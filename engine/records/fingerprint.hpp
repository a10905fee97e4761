// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace montecarta::engine {

/// 64-bit XXH3 over bytes handed in piece by piece: tells torn data from whole, not a signature.
class Fingerprint {
 public:
  Fingerprint();
  ~Fingerprint();
  Fingerprint(const Fingerprint&) = delete;
  Fingerprint& operator=(const Fingerprint&) = delete;

  void add(std::span<const std::byte> bytes);
  /// Of everything added so far; never 0, which means "not there" in a file.
  std::uint64_t value() const;

 private:
  alignas(64) std::byte state_[640];
};

/// SHA-256 in lower-case hexadecimal, 64 characters, as sha256sum prints it.
std::string sha256(std::string_view text);

}  // namespace montecarta::engine
