// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/text/quoted_words.hpp"

#include "engine/errors.hpp"

namespace montecarta::experiments {
namespace {

constexpr std::string_view kBlank = " \t\r\n\f\v";

/// The text in the quotes that begin at `at`, which becomes the place behind them.
std::string between_quotes(std::string_view text, std::size_t& at) {
  const char quote = text[at];
  std::string inside;
  while (++at < text.size() && text[at] != quote) {
    const bool escapes = quote == '"' && text[at] == '\\' && at + 1 < text.size();
    inside += text[escapes ? ++at : at];
  }
  if (at++ < text.size()) return inside;
  throw StudyError(std::string("a quote ") + quote +
                   " is not closed (# begins a comment, in quotes too): close it");
}

}  // namespace

std::vector<std::string> quoted_words(std::string_view text) {
  std::vector<std::string> words;
  std::size_t at = 0;
  while ((at = text.find_first_not_of(kBlank, at)) != std::string_view::npos) {
    std::string word;
    while (at < text.size() && kBlank.find(text[at]) == std::string_view::npos) {
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
  std::string quoted = "\"";
  for (const char c : word) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

}  // namespace montecarta::experiments
