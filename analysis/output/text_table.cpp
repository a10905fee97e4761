// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/text_table.hpp"

#include <algorithm>
#include <ostream>
#include <sstream>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kTextWidth = 100;

std::vector<std::size_t> widths_of(const std::vector<TableRow>& rows) {
  std::vector<std::size_t> widths;
  for (const TableRow& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
  }
  return widths;
}

}  // namespace

std::string aligned(const std::vector<TableRow>& rows, std::size_t indent,
                    const std::vector<Align>& alignment) {
  const std::vector<std::size_t> widths = widths_of(rows);
  std::string text;
  for (const TableRow& row : rows) {
    std::string line(indent, ' ');
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string space(widths[c] - row[c].size(), ' ');
      const bool is_right = c < alignment.size() && alignment[c] == Align::right;
      line += (is_right ? space + row[c] : row[c] + space) + "  ";
    }
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

void print_table(std::ostream& out, const TextTable& table) {
  std::vector<TableRow> rows(1);
  std::vector<Align> alignment;
  for (const TextTable::Heading& heading : table.headings) {
    rows.front().push_back(heading.text);
    alignment.push_back(heading.align);
  }
  rows.insert(rows.end(), table.rows.begin(), table.rows.end());
  TableRow rule;
  for (const std::size_t width : widths_of(rows)) rule.emplace_back(width, '-');
  rows.insert(rows.begin() + 1, std::move(rule));
  out << aligned(rows, 0, alignment);
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
