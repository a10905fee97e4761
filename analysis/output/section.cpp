// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/section.hpp"

namespace montecarta::analysis {

void Section::add(const std::string& table_name, const TextTable& table) {
  if (!table.rows.empty()) blocks.emplace_back(Table{table_name, table});
}

void Section::add(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) blocks.emplace_back(Note{note});
}

void Section::add_html(const std::string& html) { blocks.emplace_back(Html{html}); }

}  // namespace montecarta::analysis
