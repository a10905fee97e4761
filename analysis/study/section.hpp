// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study/figure.hpp"
#include "analysis/study/prose.hpp"
#include "analysis/study/text_table.hpp"

#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace montecarta::analysis {

/// A part of a report: tables and sentences, then figures. A page leaves out a section without
/// content.
struct Section {
  enum class Shown { folded, open };

  struct Table {
    std::string name;  ///< `analyze --table NAME` prints the table; reports write tables/NAME.tex
    TextTable table;
  };
  /// Notes for readers who are new to such a table.
  struct Note {
    std::string text;
  };
  /// The result as a sentence before all tables; a page shows it on the cards of cells.
  struct Lead {
    std::string text;
  };
  /// HTML for the page only.
  struct Html {
    std::string text;
  };

  using Block = std::variant<Table, Note, Lead, Html>;

  std::string name;   ///< name of its file of prose and of its place in reading_order()
  std::string title;  ///< heading; empty if there is none
  std::vector<Block> blocks = {};
  bool is_for_terminal = true;       ///< whether a terminal shows the section, or only the page
  std::vector<Figure> figures = {};  ///< each with a heading of its own
  std::string summary = {};          ///< one line beside the heading with the result in short
  Shown shown = Shown::folded;       ///< state on a page before the reader opens it

  /// The blocks of one kind.
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

  /// Adds a table if it has rows.
  void add(const std::string& table_name, const TextTable& table);
  void add(const std::vector<std::string>& notes);
  /// Adds each paragraph below `## key` in the file of prose that has the name of the section.
  void add_notes(std::string_view key, const Values& values = {});
  void add_html(const std::string& html);
};

/// A section with the texts below `## section` in the file of prose `name`: the title and, unless
/// the caller sets it, the summary.
Section section_of(std::string_view name, const Values& values = {});

/// The place of a section with its figures.
struct SectionPlace {
  std::string section;
  std::vector<std::string> figures = {};  ///< figures before the one with the name of the section
  Section::Shown shown = Section::Shown::folded;  ///< state on the page
  /// Beginning of the names of further figures, of which a study may have any number.
  std::string prefix = {};
};

/// The order of the sections on the page and on a terminal. Sections and figures without a place
/// come last.
const std::vector<SectionPlace>& reading_order();

}  // namespace montecarta::analysis
