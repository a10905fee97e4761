// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/output/figure.hpp"
#include "analysis/output/prose.hpp"

#include <iosfwd>
#include <string>
#include <string_view>
#include <variant>
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

  /// Adds a row. All rows have the same headings, which the table has from its first row.
  void add(const std::vector<Entry>& row);
};

/// Rows with their columns below each other, `gap` spaces between, each line indented by `indent`.
/// Columns without an element of `alignment` {column} are left-aligned; no line ends in spaces.
std::string aligned(const std::vector<TableRow>& rows, std::size_t indent = 2,
                    const std::vector<Align>& alignment = {}, std::size_t gap = 2);

/// A table for a terminal of `width` columns. If it is too wide, its headings and its texts are
/// broken between words; if that is not enough, columns continue below, beside the keys again.
void print_table(std::ostream& out, const TextTable& table, std::size_t width);

/// A part of a report: tables and sentences, then figures. A page leaves out a section without
/// content.
struct Section {
  enum class Shown { folded, open };

  struct Table {
    std::string name;  ///< `analyze --table NAME` prints it, a report writes it to tables/NAME.tex
    TextTable table;
  };
  /// Notes for readers who are new to such a table.
  struct Note {
    std::string text;
  };
  /// The result as a sentence before all tables; a page has it on the cards of cells.
  struct Lead {
    std::string text;
  };
  /// HTML for the page alone.
  struct Html {
    std::string text;
  };

  using Block = std::variant<Table, Note, Lead, Html>;

  std::string name;   ///< of its file of prose and of its place in reading_order()
  std::string title;  ///< a heading; empty: none
  std::vector<Block> blocks = {};
  bool is_for_terminal = true;       ///< else of the page alone
  std::vector<Figure> figures = {};  ///< each with a heading of its own
  std::string summary = {};          ///< one line beside the heading: the result in short
  Shown shown = Shown::folded;       ///< on a page, before the reader opens it

  /// Its blocks of one kind.
  template <class Kind>
  std::vector<Kind> all() const {
    std::vector<Kind> found;
    for (const Block& block : blocks) {
      if (const Kind* one = std::get_if<Kind>(&block)) found.push_back(*one);
    }
    return found;
  }
  /// Returns whether there is anything except notes on missing data.
  bool has_content() const;

  /// Adds a table; nothing if it has no rows.
  void add(const std::string& table_name, const TextTable& table);
  void add(const std::vector<std::string>& notes);
  /// Each paragraph below `## key` in the file of prose that is called as the section.
  void add_notes(std::string_view key, const Values& values = {});
  void add_html(const std::string& html);
};

/// A section with the texts below `## section` in the file of prose `name`: the title and, unless
/// the caller sets it, the summary.
Section section_of(std::string_view name, const Values& values = {});

/// The place of a section with its figures.
struct Place {
  std::string section;
  std::vector<std::string> figures = {};          ///< before the one that is called as the section
  Section::Shown shown = Section::Shown::folded;  ///< on the page
};

/// The order of the sections on the page and on a terminal. Sections and figures without a place
/// come behind them.
const std::vector<Place>& reading_order();

}  // namespace montecarta::analysis
