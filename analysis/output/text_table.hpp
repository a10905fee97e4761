// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/output/figure.hpp"

#include <iosfwd>
#include <string>
#include <variant>
#include <vector>

namespace montecarta::analysis {

enum class Align { left, right };

using TableRow = std::vector<std::string>;

/// A table in words, whatever it is set in.
struct TextTable {
  struct Heading {
    std::string text;
    Align align = Align::right;
  };
  std::vector<Heading> headings;
  std::vector<TableRow> rows;
};

/// Rows with their columns below each other, two spaces between, each line indented by `indent`.
/// Columns without an element of `alignment` {column} are left-aligned; no line ends in spaces.
std::string aligned(const std::vector<TableRow>& rows, std::size_t indent = 2,
                    const std::vector<Align>& alignment = {});

/// A table for a terminal: columns below each other.
void print_table(std::ostream& out, const TextTable& table);

/// A sentence broken into lines that a terminal holds.
void print_wrapped(std::ostream& out, const std::string& sentence);

/// A part of a report: tables and sentences, then figures. One that has none of them is left out.
struct Section {
  /// Also written as tables/<name>.tex.
  struct Table {
    std::string name;
    TextTable table;
  };
  /// A sentence or more, for someone who never saw such a table.
  struct Note {
    std::string text;
  };
  /// A sentence that says the result, before all tables.
  struct Lead {
    std::string text;
  };
  /// Of the page alone.
  struct Html {
    std::string text;
  };

  using Block = std::variant<Table, Note, Lead, Html>;

  std::string name;   ///< its place in the order of reading
  std::string title;  ///< a heading; empty: none
  std::vector<Block> blocks = {};
  bool is_for_terminal = true;       ///< else of the page alone
  std::vector<Figure> figures = {};  ///< each with a heading of its own

  /// Nothing where it has no rows.
  void add(const std::string& table_name, const TextTable& table);
  void add(const std::vector<std::string>& notes);
  void add_html(const std::string& html);
};

}  // namespace montecarta::analysis
