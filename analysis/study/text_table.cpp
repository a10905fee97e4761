// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/text_table.hpp"

#include "engine/errors.hpp"
#include "engine/text/wrapped_text.hpp"

#include <algorithm>
#include <numeric>
#include <sstream>
#include <utility>

namespace montecarta::analysis {
namespace {

std::vector<std::size_t> widths_of(const std::vector<TableRow>& rows) {
  std::vector<std::size_t> widths;
  for (const TableRow& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
  }
  return widths;
}

constexpr std::size_t kNarrowestText = 24;  // least width of a column of sentences

std::size_t longest_word(const std::string& text) {
  std::istringstream words(text);
  std::size_t longest = 0;
  for (std::string word; words >> word;) longest = std::max(longest, word.size());
  return longest;
}

std::vector<std::string> lines_of(const std::string& text, std::size_t width) {
  std::istringstream wrapped(engine::wrapped(text, width));
  std::vector<std::string> lines;
  for (std::string line; std::getline(wrapped, line);) lines.push_back(line);
  return lines;
}

/// Widths of columns and the spaces between them.
struct TableLayout {
  std::vector<std::size_t> widths;
  std::size_t gap;

  std::size_t total() const {
    return std::accumulate(widths.begin(), widths.end(), gap * (widths.size() - 1));
  }
};

TableLayout natural_layout(const TextTable& table) {
  TableLayout layout{widths_of(table.rows), 2};
  layout.widths.resize(table.headings.size());
  for (std::size_t c = 0; c < layout.widths.size(); ++c) {
    layout.widths[c] = std::max(layout.widths[c], table.headings[c].text.size());
  }
  return layout;
}

/// Narrows headings, spaces and texts until the table fits into `width`, if that is possible.
TableLayout layout_of(const TextTable& table, std::size_t width) {
  TableLayout layout = natural_layout(table);
  if (layout.total() <= width) return layout;
  layout.widths = widths_of(table.rows);
  layout.widths.resize(table.headings.size());
  for (std::size_t c = 0; c < layout.widths.size(); ++c) {
    layout.widths[c] = std::max(layout.widths[c], longest_word(table.headings[c].text));
  }
  if (layout.total() > width) layout.gap = 1;
  for (std::size_t c = table.keys; c < layout.widths.size(); ++c) {
    const std::size_t all = layout.total(), here = layout.widths[c];
    if (table.headings[c].align == Align::right || all <= width) continue;
    std::size_t least = kNarrowestText;
    for (const TableRow& row : table.rows) least = std::max(least, longest_word(row[c]));
    if (here > least) layout.widths[c] = std::max(least, here - std::min(all - width, here));
  }
  return layout;
}

/// {block} Columns that fit beside each other; each block begins with the first `keys` columns.
std::vector<std::vector<std::size_t>> blocks_of(const TableLayout& layout, std::size_t keys,
                                                std::size_t width) {
  std::vector<std::size_t> first(keys);
  std::iota(first.begin(), first.end(), std::size_t{0});
  std::size_t width_of_keys = 0;
  for (const std::size_t c : first) width_of_keys += layout.widths[c] + (c > 0 ? layout.gap : 0);
  std::vector<std::vector<std::size_t>> blocks = {first};
  std::size_t used = width_of_keys;
  for (std::size_t c = keys; c < layout.widths.size(); ++c) {
    const std::size_t more = layout.gap + layout.widths[c];
    if (used + more > width && blocks.back().size() > keys) {
      blocks.push_back(first);
      used = width_of_keys;
    }
    blocks.back().push_back(c);
    used += more;
  }
  return blocks;
}

enum class Anchor { top, bottom };

/// One row of some columns, with as many lines as its highest text has.
std::vector<TableRow> lines_of_row(const TableRow& row, const std::vector<std::size_t>& columns,
                                   const std::vector<std::size_t>& widths, Anchor anchor) {
  std::vector<std::vector<std::string>> texts;
  std::size_t height = 1;
  for (const std::size_t c : columns) {
    texts.push_back(lines_of(row[c], widths[c]));
    height = std::max(height, texts.back().size());
  }
  std::vector<TableRow> lines(height, TableRow(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const std::size_t first = anchor == Anchor::bottom ? height - texts[k].size() : 0;
    for (std::size_t l = 0; l < texts[k].size(); ++l) lines[first + l][k] = texts[k][l];
  }
  return lines;
}

}  // namespace

std::vector<std::string> aligned_lines(const std::vector<TableRow>& rows,
                                       const std::vector<Align>& alignment, std::size_t gap) {
  const std::vector<std::size_t> widths = widths_of(rows);
  std::vector<std::string> lines;
  for (const TableRow& row : rows) {
    std::string line;
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string space(widths[c] - row[c].size(), ' ');
      const bool is_right = c < alignment.size() && alignment[c] == Align::right;
      line += (is_right ? space + row[c] : row[c] + space) + std::string(gap, ' ');
    }
    lines.push_back(line.substr(0, line.find_last_not_of(' ') + 1));
  }
  return lines;
}

std::string aligned(const std::vector<TableRow>& rows, std::size_t indent,
                    const std::vector<Align>& alignment, std::size_t gap) {
  std::string text;
  for (const std::string& line : aligned_lines(rows, alignment, gap))
    text += std::string(line.empty() ? 0 : indent, ' ') + line + "\n";
  return text;
}

void print_table(std::ostream& out, const TextTable& table, std::size_t width) {
  if (table.headings.empty()) return;
  TableRow headings;
  for (const TextTable::Heading& heading : table.headings) headings.push_back(heading.text);
  const TableLayout layout = layout_of(table, width);
  const std::vector<std::size_t>& widths = layout.widths;
  bool is_first = true;
  for (const std::vector<std::size_t>& columns :
       blocks_of(layout, std::min(table.keys, table.headings.size()), width)) {
    std::vector<TableRow> rows = lines_of_row(headings, columns, widths, Anchor::bottom);
    std::vector<Align> alignment;
    TableRow rule;
    for (const std::size_t c : columns) {
      alignment.push_back(table.headings[c].align);
      rule.emplace_back(widths[c], '-');
    }
    rows.push_back(rule);
    for (const TableRow& row : table.rows) {
      for (TableRow& line : lines_of_row(row, columns, widths, Anchor::top)) {
        rows.push_back(std::move(line));
      }
    }
    out << (is_first ? "" : "\n") << aligned(rows, 0, alignment, layout.gap);
    is_first = false;
  }
}

void TextTable::add(const std::vector<Entry>& row) {
  TableRow texts;
  for (const Entry& entry : row) {
    if (rows.empty()) headings.push_back({entry.heading, entry.align});
    if (entry.tone != Tone::plain) tones[{rows.size(), texts.size()}] = entry.tone;
    texts.push_back(entry.text);
  }
  expect(texts.size() == headings.size(), "all rows of a table have the same columns");
  rows.push_back(std::move(texts));
}

Tone TextTable::tone_at(std::size_t row, std::size_t column) const {
  const auto found = tones.find({row, column});
  return found == tones.end() ? Tone::plain : found->second;
}

}  // namespace montecarta::analysis
