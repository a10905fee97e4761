// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/text/words.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/text/list_text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <system_error>

namespace montecarta::experiments {
namespace {

constexpr std::string_view kWhite = " \t\r\n\f\v";

char lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

template <class Number>
std::optional<Number> whole_text_as(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// The text between the quotes that begin at `at`. Moves `at` behind the closing quote.
std::string between_quotes(std::string_view text, std::size_t& at) {
  const char quote = text[at];
  std::string inside;
  while (++at < text.size() && text[at] != quote) {
    const bool escapes = quote == '"' && text[at] == '\\' && at + 1 < text.size();
    inside += text[escapes ? ++at : at];
  }
  if (at++ < text.size()) return inside;
  throw StudyError("a quote {} is not closed (# begins a comment, in quotes too): close it", quote);
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kWhite);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kWhite) - begin + 1);
}

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  split_into(text, separator, parts);
  return {parts.begin(), parts.end()};
}

void split_into(std::string_view text, char separator, std::vector<std::string_view>& parts) {
  parts.clear();
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    parts.push_back(trimmed(text.substr(begin, end - begin)));
    begin = end + 1;
  }
}

std::string excerpt(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string shown(text.substr(0, kLongest));
  const auto unprintable = [](unsigned char c) { return c < 0x20 || c >= 0x7f; };
  std::ranges::replace_if(shown, unprintable, '?');
  return text.size() > kLongest ? shown + "..." : shown;
}

std::string shortened(const std::string& message) {
  constexpr std::size_t kLongestWord = 400, kKept = 100, kLongestMessage = 8000;
  std::string shown;
  for (std::size_t begin = 0; begin < message.size() && shown.size() < kLongestMessage;) {
    const std::size_t end = std::min(message.find_first_of(" \n", begin), message.size());
    const std::string_view word = std::string_view(message).substr(begin, end - begin);
    if (word.size() > kLongestWord) {
      shown.append(word.substr(0, kKept)).append("...").append(word.substr(word.size() - kKept));
    } else {
      shown += word;
    }
    if (end < message.size()) shown += message[end];
    begin = end + 1;
  }
  if (shown.size() >= kLongestMessage) shown.replace(kLongestMessage, shown.npos, "...");
  return shown;
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> cost(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        cost[i][j] = i + j;
        continue;
      }
      const std::size_t differs = lower(a[i - 1]) == lower(b[j - 1]) ? 0 : 1;
      cost[i][j] = std::min({cost[i - 1][j] + 1, cost[i][j - 1] + 1, cost[i - 1][j - 1] + differs});
      const bool swapped = i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) &&
                           lower(a[i - 2]) == lower(b[j - 1]);
      if (swapped) cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
    }
  }
  return cost[a.size()][b.size()];
}

std::string nearest_spelling(std::string_view word, std::span<const std::string> known) {
  const auto nearer = [word](const std::string& a, const std::string& b) {
    return edit_distance(word, a) < edit_distance(word, b);
  };
  const auto nearest = std::min_element(known.begin(), known.end(), nearer);
  const std::size_t tolerated = std::max<std::size_t>(2, word.size() / 3);
  if (nearest != known.end() && edit_distance(word, *nearest) <= tolerated) {
    return formatted("did you mean {}?", *nearest);
  }
  return "known: " + joined(known);
}

std::optional<double> to_number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  const std::optional<double> value = whole_text_as<double>(text);
  if (!value || !std::isfinite(*value)) return std::nullopt;
  return value;
}

std::optional<std::uint64_t> to_count(std::string_view text) {
  return whole_text_as<std::uint64_t>(text);
}

std::string to_text(double value) {
  std::array<char, 32> buffer;
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return std::string(buffer.data(), error == std::errc() ? end : buffer.data());
}

std::vector<std::string> quoted_words(std::string_view text) {
  std::vector<std::string> words;
  std::size_t at = 0;
  while ((at = text.find_first_not_of(kWhite, at)) != std::string_view::npos) {
    std::string word;
    while (at < text.size() && kWhite.find(text[at]) == std::string_view::npos) {
      if (text[at] == '"' || text[at] == '\'') {
        word += between_quotes(text, at);
      } else {
        word += text[at++];
      }
    }
    words.push_back(word);
  }
  return words;
}

std::string in_quotes(std::string_view word) {
  std::ostringstream quoted;
  quoted << std::quoted(word);
  return quoted.str();
}

}  // namespace montecarta::experiments
