// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/sums.hpp"

#include "engine/errors.hpp"

#include <algorithm>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kShortestRepetition = 4;
constexpr std::size_t kMostWords = std::size_t{1} << 28U;  // 2 GB, far more than a group has

/// Number of equal words at the beginning.
std::size_t repetition(std::span<const std::uint64_t> words) {
  const auto other = std::ranges::find_if(words, [&](auto word) { return word != words.front(); });
  return static_cast<std::size_t>(other - words.begin());
}

/// Number of words before the next repetition that is worth writing once.
std::size_t words_before_repetition(std::span<const std::uint64_t> words) {
  std::size_t begin = 0;
  while (begin < words.size()) {
    const std::size_t equal = repetition(words.subspan(begin));
    if (equal >= kShortestRepetition) break;
    begin += equal;
  }
  return begin;
}

}  // namespace

void SumReader::expect(bool condition) {
  if (condition) return;
  throw StudyError("its sums are damaged: take a copy that is whole, or run the study again");
}

// Each stretch begins with twice its number of words, plus 1 if it is a repetition. Its words
// follow, or the one word that is repeated.
Words packed(std::span<const std::uint64_t> words) {
  Words all;
  while (!words.empty()) {
    const std::size_t plain = words_before_repetition(words);
    if (plain > 0) {
      all.push_back(2 * plain);
      all.insert(all.end(), words.begin(), words.begin() + static_cast<std::ptrdiff_t>(plain));
    }
    words = words.subspan(plain);
    if (words.empty()) break;
    const std::size_t equal = repetition(words);
    all.insert(all.end(), {2 * equal + 1, words.front()});
    words = words.subspan(equal);
  }
  return all;
}

Words unpacked(std::span<const std::uint64_t> words) {
  Words all;
  while (!words.empty()) {
    const bool is_repetition = words.front() % 2 == 1;
    const std::uint64_t length = words.front() / 2;
    words = words.subspan(1);
    SumReader::expect(length <= kMostWords - all.size() &&
                      words.size() >= (is_repetition ? 1 : length));
    if (is_repetition) {
      all.insert(all.end(), length, words.front());
      words = words.subspan(1);
    } else {
      all.insert(all.end(), words.begin(), words.begin() + static_cast<std::ptrdiff_t>(length));
      words = words.subspan(length);
    }
  }
  return all;
}

}  // namespace montecarta::analysis
