// SPDX-License-Identifier: BSD-3-Clause
#include "engine/text/visible_text.hpp"

#include "engine/namespaces.hpp"

#include <algorithm>

namespace montecarta::engine {
namespace {

/// Number of bytes of the UTF-8 character that begins with `first`; 0 if none begins with it.
std::size_t length_by(unsigned char first) {
  if (first < 0x80) return 1;
  if (first < 0xc2 || first > 0xf4) return 0;
  return first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
}

bool continues(char c) { return (static_cast<unsigned char>(c) & 0xc0U) == 0x80U; }

/// Number of bytes of the character at the beginning of `text`; 0 if it is not valid UTF-8.
std::size_t whole_character(std::string_view text) {
  const std::size_t length = length_by(static_cast<unsigned char>(text.front()));
  if (length == 0 || length > text.size()) return 0;
  const bool is_whole = std::ranges::all_of(text.substr(1, length - 1), continues);
  return is_whole ? length : 0;
}

/// Returns whether it is an ASCII control character or one of two bytes (U+0080 to U+009F).
bool is_control(std::string_view character) {
  const auto first = static_cast<unsigned char>(character.front());
  if (character.size() == 1) return first < 0x20 || first == 0x7f;
  return character.size() == 2 && first == 0xc2 && static_cast<unsigned char>(character[1]) < 0xa0;
}

}  // namespace

std::string hexadecimal(std::string_view bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string digits;
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    digits += kDigits[byte >> 4U];
    digits += kDigits[byte & 15U];
  }
  return digits;
}

std::string visible(std::string_view text, std::string_view kept) {
  std::string shown;
  while (!text.empty()) {
    const std::size_t length = whole_character(text);
    const std::string_view character = text.substr(0, std::max<std::size_t>(length, 1));
    text.remove_prefix(character.size());
    if (length > 0 && (!is_control(character) || kept.find(character) != kept.npos)) {
      shown += character;
    } else if (character == "\n") {
      shown += "\\n";
    } else if (character == "\t") {
      shown += "\\t";
    } else {
      for (const char c : character) shown += "\\x" + hexadecimal({&c, 1});
    }
  }
  return shown;
}

std::string shell_quoted(const std::string& word) {
  const char* plain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-./:=,+@%";
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::size_t unfinished_bytes(std::string_view text) {
  for (std::size_t n = 1; n <= std::min<std::size_t>(3, text.size()); ++n) {
    const char c = text[text.size() - n];
    if (continues(c)) continue;
    return length_by(static_cast<unsigned char>(c)) > n ? n : 0;
  }
  return 0;
}

}  // namespace montecarta::engine
