// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace montecarta::engine {

/// `text` with every control character and every byte that is no UTF-8 written out, \n, \t or \x1b:
/// on one line, and harmless to a terminal and to LaTeX. Characters in `kept` stay as they are.
std::string visible(std::string_view text, std::string_view kept = "");

/// How many bytes at the end of `text` begin a character that is not whole: 0 to 3.
std::size_t unfinished_bytes(std::string_view text);

}  // namespace montecarta::engine
