// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <iosfwd>
#include <string>
#include <vector>

namespace montecarta::analysis {

enum class Align { left, right };

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
  };
  std::vector<Heading> headings = {};
  std::vector<TableRow> rows = {};
  std::size_t keys = 1;  ///< number of first columns that identify a row

  /// Adds a row. All rows have the headings of the first one.
  void add(const std::vector<Entry>& row);
};

/// Rows as text with their columns aligned, `gap` spaces between them, and each line indented by
/// `indent`. Columns without an element of `alignment` {column} are left-aligned; no line ends in
/// spaces.
std::string aligned(const std::vector<TableRow>& rows, std::size_t indent = 2,
                    const std::vector<Align>& alignment = {}, std::size_t gap = 2);

/// Prints a table for a terminal of `width` columns. If it is too wide, its headings and texts are
/// broken between words; if that is not enough, columns continue below, with the key columns
/// repeated.
void print_table(std::ostream& out, const TextTable& table, std::size_t width);

}  // namespace montecarta::analysis
