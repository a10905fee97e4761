// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace montecarta::engine {

/// Escapes every control character and every byte that is not valid UTF-8 as \n, \t or \x1b, so
/// that `text` is one line, harmless to terminals and LaTeX. Characters in `kept` stay as they are.
std::string visible(std::string_view text, std::string_view kept = "");

/// The bytes in two lower-case hexadecimal digits each.
std::string hexadecimal(std::string_view bytes);

/// `word`, quoted so that a POSIX shell reads it back as one word.
std::string shell_quoted(const std::string& word);

/// Number of bytes at the end of `text` that begin an incomplete character: 0 to 3.
std::size_t unfinished_bytes(std::string_view text);

}  // namespace montecarta::engine
