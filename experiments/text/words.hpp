// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
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
/// "a, b, c".
std::string joined(std::span<const std::string> parts, std::string_view between = ", ");
/// `text` as an error message may quote it: its first 40 bytes, with ? for what cannot be printed.
std::string excerpt(std::string_view text);

/// A message as a terminal shows it: words of thousands of characters lose their middle, and a
/// message of tens of thousands its end.
std::string shortened(const std::string& message);

/// Fewest insertions, deletions, replacements and swaps of neighbours that turn `a` into `b`, case
/// ignored.
std::size_t edit_distance(std::string_view a, std::string_view b);
/// "did you mean X?" for the known spelling nearest to `word`, else "known: a, b, c".
std::string nearest_spelling(std::string_view word, std::span<const std::string> known);

/// The number that all of `text` spells, in the C locale; nullopt where it is not one or not
/// finite.
std::optional<double> to_number(std::string_view text);
/// Likewise for whole numbers without sign; nullopt where 64 bits do not hold it.
std::optional<std::uint64_t> to_count(std::string_view text);
/// The shortest text that reads back as exactly `value`.
std::string to_text(double value);

/// The parts of `text` between runs of white space, where quotes, '...' or "...", hold a part or
/// some of it together and are dropped. Within "..." a backslash takes the character behind it as
/// it is, everywhere else it is a character like any other. Nothing is expanded. Throws StudyError,
/// worded "(why): remedy", where a quote is not closed.
std::vector<std::string> quoted_words(std::string_view text);

/// `word` in double quotes, so that quoted_words() reads it back.
std::string in_quotes(std::string_view word);

}  // namespace montecarta::experiments
