// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace montecarta::engine {

/// The two halves of a product of 32-bit numbers.
template <class Word>
struct Halves {
  Word high, low;
};

/// a times b for one word held in 64 bits.
inline Halves<std::uint64_t> multiply_words(std::uint64_t a, std::uint32_t b) {
  const std::uint64_t product = a * b;
  return {product >> 32, product & 0xffffffffU};
}

/// Philox4x32-10 (Salmon, Moraes, Dror and Shaw, SC 2011): ten rounds turn a counter and a key into
/// four random words. `Word` holds one 32-bit number in 64 bits: std::uint64_t, or one such for
/// each lane.
template <class Word>
std::array<Word, 4> philox(std::array<Word, 4> counter, std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < 10; ++round) {
    const Halves<Word> a = multiply_words(counter[0], 0xD2511F53U);
    const Halves<Word> b = multiply_words(counter[2], 0xCD9E8D57U);
    counter = {b.high ^ counter[1] ^ key[0], b.low, a.high ^ counter[3] ^ key[1], a.low};
    key[0] += 0x9E3779B9U;
    key[1] += 0xBB67AE85U;
  }
  return counter;
}

/// Who owns which counter: index, step, run, and purpose with the number of the block within it.
inline constexpr int kPurposeShift = 24;
inline constexpr std::uint32_t kBlockMask = 0xffffffU;

}  // namespace montecarta::engine
