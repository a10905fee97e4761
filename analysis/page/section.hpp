// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/figures/figure.hpp"
#include "analysis/tables/verdict_table.hpp"

#include <string>
#include <vector>

namespace montecarta {

/// A table that is also written as tables/<name>.tex.
struct LatexTable {
  std::string name;
  TextTable table;
};

/// A part of the page. One that has neither body nor figures is left out.
struct Section {
  std::string title = {};               ///< heading of the body; empty: none
  std::string body = {};                ///< HTML
  std::vector<LatexTable> tables = {};  ///< all of them stand in the body already
  std::vector<Figure> figures = {};     ///< below the body, each with a heading of its own
};

/// Adds a table to the body and to the LaTeX tables; nothing where it has no rows.
void add_table(const std::string& name, const TextTable& table, Section& section);
/// Adds sentences, a paragraph each: what a table means, for someone who never saw such a table.
void add_notes(const std::vector<std::string>& sentences, Section& section);
/// Figures alone; those without data are left out.
Section figure_section(std::vector<Figure> figures);

}  // namespace montecarta
