// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::analysis {

enum class Align { left, right };

/// Whether a text is good or bad news, which a page shows by its colour.
enum class Tone : std::uint8_t { plain, good, bad };

using TableRow = std::vector<std::string>;

/// A table of texts, for every output format.
struct TextTable {
  struct Heading {
    std::string text;
    Align align = Align::right;
  };
  /// One column of a row.
  struct Entry {
    std::string heading;
    std::string text;
    Align align = Align::right;
    Tone tone = Tone::plain;
  };
  std::vector<Heading> headings = {};
  std::vector<TableRow> rows = {};
  /// {row, column} The tones that are not plain.
  std::map<std::pair<std::size_t, std::size_t>, Tone> tones = {};
  std::size_t keys = 1;  ///< number of first columns that identify a row

  /// Adds a row. All rows have the headings of the first one.
  void add(const std::vector<Entry>& row);
  Tone tone_at(std::size_t row, std::size_t column) const;
};

/// {row} Rows as lines with their columns aligned, `gap` spaces between them. Columns without an
/// element of `alignment` {column} are left-aligned; no line ends in spaces.
std::vector<std::string> aligned_lines(const std::vector<TableRow>& rows,
                                       const std::vector<Align>& alignment = {},
                                       std::size_t gap = 2);

/// These lines as one text, each indented by `indent`.
std::string aligned(const std::vector<TableRow>& rows, std::size_t indent = 2,
                    const std::vector<Align>& alignment = {}, std::size_t gap = 2);

/// Prints a table for a terminal of `width` columns. If it is too wide, its headings and texts are
/// broken between words; if that is not enough, columns continue below, with the key columns
/// repeated.
void print_table(std::ostream& out, const TextTable& table, std::size_t width);

}  // namespace montecarta::analysis
