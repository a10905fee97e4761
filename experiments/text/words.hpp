// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/errors.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace montecarta::experiments {

/// Returns `text` without white space at either end.
std::string_view trimmed(std::string_view text);
/// The trimmed parts of `text` between separators. The empty text has one empty part.
std::vector<std::string> split(std::string_view text, char separator);
/// Stores the parts that split() returns in `parts`, as views of `text`.
void split_into(std::string_view text, char separator, std::vector<std::string_view>& parts);
/// Text of `text` in errors: its first 40 bytes, with ? for bytes that cannot be printed.
std::string excerpt(std::string_view text);

/// Shortens a message for a terminal: words of thousands of characters lose their middle, and a
/// message of tens of thousands loses its end.
std::string shortened(const std::string& message);

/// Edit distance: the smallest number of insertions, deletions, replacements and swaps of
/// neighbours that turn `a` into `b`, ignoring case.
std::size_t edit_distance(std::string_view a, std::string_view b);
/// A remedy: "did you mean X?" for the known spelling nearest to `word`, else "known: a, b, c".
std::string nearest_spelling(std::string_view word, std::span<const std::string> known);

/// The item of a container that name_of() calls `name`. If there is none, throws StudyError with
/// the text `problem` and the nearest name as a remedy.
template <class Items, class NameOf>
auto& item_called(std::string_view name, Items&& items, const NameOf& name_of,
                  const std::string& problem) {
  std::vector<std::string> known;
  for (auto& item : items) {
    known.emplace_back(std::invoke(name_of, item));
    if (known.back() == name) return item;
  }
  throw StudyError(problem + ": " + nearest_spelling(name, known));
}

/// Returns what `work` returns. If it throws StudyError, `place` is put in front of the error.
template <class Work>
auto at_place(const std::string& place, const Work& work) {
  try {
    return work();
  } catch (const StudyError& error) {
    throw StudyError(place + ": " + error.what());
  }
}

/// Parses all of `text` as a number in the C locale; nullopt if it is not a finite number.
std::optional<double> to_number(std::string_view text);
/// Parses all of `text` as a whole number without sign; nullopt if it is none or exceeds 64 bits.
std::optional<std::uint64_t> to_count(std::string_view text);
/// The shortest text that reads back as exactly `value`.
std::string to_text(double value);

/// Splits `text` at white space. Quotes, '...' or "...", keep blanks within a part, and are
/// removed. Within "..." a backslash escapes the next character; elsewhere it is an ordinary
/// character. Nothing is expanded. Throws StudyError, worded "(why): remedy", if a quote is not
/// closed.
std::vector<std::string> quoted_words(std::string_view text);

/// Returns `word` in double quotes, so that quoted_words() reads it back.
std::string in_quotes(std::string_view word);

}  // namespace montecarta::experiments
