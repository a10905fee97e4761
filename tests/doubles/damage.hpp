// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/posix_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>

// Random damage to files, the same from every seed.
namespace montecarta::engine {

/// Whole numbers below a bound from a counter of its own.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : state_(seed) {}
  std::size_t below(std::size_t bound) {  // splitmix64
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15U);
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return static_cast<std::size_t>((z ^ (z >> 31U)) % bound);
  }

 private:
  std::uint64_t state_;
};

/// The number of damaged files that a test tries: `usual`, or as many times more as the environment
/// variable MONTECARTA_FUZZ says.
inline std::uint64_t damaged_files(std::uint64_t usual) {
  const char* const times = std::getenv("MONTECARTA_FUZZ");
  return times == nullptr ? usual : usual * std::strtoull(times, nullptr, 10);
}

/// Eight bytes that are extreme as a number of one kind or another.
inline std::uint64_t extreme_word(Dice& dice) {
  using Limits = std::numeric_limits<double>;
  constexpr std::uint64_t ones = ~std::uint64_t{0};
  const std::uint64_t words[] = {0, 1, ones, ones >> 1U, ones >> 32U, 1ULL << 31U, 1ULL << 63U};
  const double numbers[] = {Limits::quiet_NaN(),
                            Limits::infinity(),
                            -Limits::infinity(),
                            Limits::max(),
                            Limits::lowest(),
                            Limits::denorm_min(),
                            -1.0,
                            1e9,
                            1e150};
  const std::size_t which = dice.below(std::size(words) + std::size(numbers));
  return which < std::size(words) ? words[which]
                                  : std::bit_cast<std::uint64_t>(numbers[which - std::size(words)]);
}

/// Flips one bit of a file; a second call restores it.
inline void flip_bit(const std::filesystem::path& path, std::uint64_t at) {
  const PosixFile file(path, PosixFile::Mode::write);
  std::byte stored{};
  file.read_at(at, std::span(&stored, 1));
  stored ^= std::byte{2};  // turns the status "complete" into "not needed"
  file.write_at(at, std::span(&stored, 1));
}

inline void set_word(std::string& bytes, std::size_t at, std::uint64_t word) {
  for (std::size_t i = 0; i < 8 && at + i < bytes.size(); ++i, word >>= 8U) {
    bytes[at + i] = static_cast<char>(word & 0xffU);
  }
}

/// Changes bytes in one place, or cuts the rest off.
inline void damage(std::string& bytes, Dice& dice) {
  if (bytes.empty()) return;
  const std::size_t at = dice.below(bytes.size());
  const std::size_t length = 1 + dice.below(12);
  switch (dice.below(8)) {
    case 0:
      bytes.erase(at, length);
      break;
    case 1:
      bytes.insert(at, bytes.substr(at, length));
      break;
    case 2:
      bytes[at] = static_cast<char>(bytes[at] ^ (1 << dice.below(8)));
      break;
    case 3:
      bytes[at] = static_cast<char>(dice.below(256));
      break;
    case 4:  // headers stand in front
      bytes[at % 256 % bytes.size()] = static_cast<char>(dice.below(256));
      break;
    case 5:
      set_word(bytes, at, extreme_word(dice));
      break;
    case 6:
      set_word(bytes, at / 8 * 8, extreme_word(dice));
      break;
    default:
      if (dice.below(4) == 0) bytes.resize(at);
  }
}

/// Puts another word of the text, or an extreme number, where a word stands.
inline void swap_words(std::string& text, Dice& dice) {
  constexpr std::string_view kBetween = " ,=\n\t;";
  constexpr std::array<std::string_view, 12> kExtremes = {"0",
                                                          "-1",
                                                          "1e308",
                                                          "-1e308",
                                                          "1e-320",
                                                          "nan",
                                                          "inf",
                                                          "18446744073709551615",
                                                          "99999999999999999999",
                                                          "",
                                                          "[",
                                                          "0x1"};
  const auto word_near = [&](std::size_t at) {
    const std::size_t before = text.find_last_of(kBetween, at);
    const std::size_t begin = before == std::string::npos ? 0 : before + 1;
    const std::size_t end = std::min(text.find_first_of(kBetween, begin), text.size());
    return std::pair(begin, end - begin);
  };
  if (text.empty()) return;
  const auto [begin, length] = word_near(dice.below(text.size()));
  const auto [other, other_length] = word_near(dice.below(text.size()));
  const std::size_t which = dice.below(2 * kExtremes.size());
  text.replace(
      begin, length,
      which < kExtremes.size() ? std::string(kExtremes[which]) : text.substr(other, other_length));
}

/// A file of bytes, damaged in one to three places.
inline std::string damaged(std::string bytes, std::uint64_t seed) {
  Dice dice(seed);
  for (std::size_t n = 1 + dice.below(3); n > 0; --n) damage(bytes, dice);
  return bytes;
}

/// A file of text, likewise.
inline std::string damaged_text(std::string text, std::uint64_t seed) {
  Dice dice(seed);
  for (std::size_t n = 1 + dice.below(3); n > 0; --n) {
    if (dice.below(2) == 0) {
      swap_words(text, dice);
    } else {
      damage(text, dice);
    }
  }
  return text;
}

}  // namespace montecarta::engine
