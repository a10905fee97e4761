// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/section.hpp"

namespace montecarta {

void Section::add(const std::string& table_name, const TextTable& table) {
  if (!table.rows.empty()) blocks.emplace_back(Table{table_name, table});
}

void Section::add(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) blocks.emplace_back(Note{note});
}

void Section::add_html(const std::string& html) { blocks.emplace_back(Html{html}); }

void Section::add(const Figure& figure) {
  if (!figure.data.empty()) figures.push_back(figure);
}

Section figure_section(const std::string& name, const std::vector<Figure>& figures) {
  Section section{name, ""};
  for (const Figure& figure : figures) section.add(figure);
  return section;
}

}  // namespace montecarta
