// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/section.hpp"

#include "analysis/page/html.hpp"

#include <utility>

namespace montecarta {

void add_table(const std::string& name, const TextTable& table, Section& section) {
  if (table.rows.empty()) return;
  section.body += html_table(table);
  section.tables.push_back({name, table});
}

void add_notes(const std::vector<std::string>& sentences, Section& section) {
  for (const std::string& sentence : sentences) {
    section.body += "<p class=\"soft\">" + html_escape(sentence) + "</p>\n";
  }
}

Section figure_section(std::vector<Figure> figures) {
  std::erase_if(figures, [](const Figure& figure) { return figure.data.empty(); });
  Section section;
  section.figures = std::move(figures);
  return section;
}

}  // namespace montecarta
