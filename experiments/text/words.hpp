// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace montecarta::experiments {

/// `text` without white space at either end.
std::string_view trimmed(std::string_view text);
/// The trimmed parts of `text` between separators; "" has one empty part.
std::vector<std::string> split(std::string_view text, char separator);
/// Likewise, as views of `text`, into `parts`.
void split_into(std::string_view text, char separator, std::vector<std::string_view>& parts);
/// The parts of `text` between runs of white space; "" has none.
std::vector<std::string> words_of(std::string_view text);
/// "a, b, c".
std::string joined(std::span<const std::string> parts, std::string_view between = ", ");
/// `text` as an error message may quote it: its first 40 bytes, with ? for what cannot be printed.
std::string excerpt(std::string_view text);

/// Fewest insertions, deletions, replacements and swaps of neighbours that turn `a` into `b`, case
/// ignored.
std::size_t edit_distance(std::string_view a, std::string_view b);
/// "did you mean X?" for the known spelling nearest to `word`, else "known: a, b, c".
std::string nearest_spelling(std::string_view word, std::span<const std::string> known);

}  // namespace montecarta::experiments
