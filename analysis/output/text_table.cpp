// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/text_table.hpp"

#include <algorithm>
#include <ostream>
#include <sstream>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kTextWidth = 100;

std::vector<std::size_t> widths_of(const TextTable& table) {
  std::vector<std::size_t> widths;
  for (const auto& heading : table.headings) widths.push_back(heading.text.size());
  for (const auto& row : table.rows) {
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
  }
  return widths;
}

std::string padded(const std::string& text, std::size_t width, Align align) {
  const std::string space(width - std::min(width, text.size()), ' ');
  return align == Align::left ? text + space : space + text;
}

}  // namespace

void print_table(std::ostream& out, const TextTable& table) {
  const auto widths = widths_of(table);
  const auto line = [&](const auto& text_of) {
    std::string printed;
    for (std::size_t c = 0; c < widths.size(); ++c) {
      printed += padded(text_of(c), widths[c], table.headings[c].align) + "  ";
    }
    printed.erase(printed.find_last_not_of(' ') + 1);
    out << printed << '\n';
  };
  line([&](std::size_t c) { return table.headings[c].text; });
  line([&](std::size_t c) { return std::string(widths[c], '-'); });
  for (const auto& row : table.rows) line([&](std::size_t c) { return row[c]; });
}

void print_wrapped(std::ostream& out, const std::string& sentence) {
  std::istringstream words(sentence);
  std::string line;
  for (std::string word; words >> word;) {
    if (!line.empty() && line.size() + 1 + word.size() > kTextWidth) {
      out << line << '\n';
      line.clear();
    }
    line += (line.empty() ? "" : " ") + word;
  }
  out << line << '\n';
}

void Section::add(const std::string& table_name, const TextTable& table) {
  if (!table.rows.empty()) blocks.emplace_back(Table{table_name, table});
}

void Section::add(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) blocks.emplace_back(Note{note});
}

void Section::add_html(const std::string& html) { blocks.emplace_back(Html{html}); }

}  // namespace montecarta::analysis
