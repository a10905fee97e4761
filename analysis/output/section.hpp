// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/output/figure.hpp"
#include "analysis/output/text_table.hpp"

#include <string>
#include <variant>
#include <vector>

namespace montecarta::analysis {

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
  /// Of the page alone.
  struct Html {
    std::string text;
  };

  using Block = std::variant<Table, Note, Html>;

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
