// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/tables/tables.hpp"
#include "engine/visible_text.hpp"

#include <string_view>

namespace montecarta::analysis {
namespace {

std::string latex_escaped(char c) {
  switch (c) {
    case '\\':
      return "\\textbackslash{}";
    case '~':
      return "\\textasciitilde{}";
    case '^':
      return "\\textasciicircum{}";
    case '<':
      return "\\textless{}";
    case '>':
      return "\\textgreater{}";
    default:
      break;
  }
  const bool special = std::string_view("&%$#_{}").find(c) != std::string_view::npos;
  return special ? std::string("\\") + c : std::string(1, c);
}

template <class Texts>
std::string latex_row(const Texts& texts) {
  std::string row;
  std::string_view between;
  for (const std::string& text : texts) {
    row.append(between).append(latex_escape(text));
    between = " & ";
  }
  return row + " \\\\\n";
}

}  // namespace

std::string latex_escape(const std::string& text) {
  std::string latex;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text.compare(i, 2, "+-") == 0) {
      latex += "$\\pm$";
      ++i;
    } else {
      latex += latex_escaped(text[i]);
    }
  }
  return latex;
}

std::string latex_tabular(const TextTable& table) {
  std::string columns;
  std::vector<std::string> headings;
  for (const auto& heading : table.headings) {
    columns += heading.align == Align::left ? 'l' : 'r';
    headings.push_back(heading.text);
  }
  std::string latex = "\\begin{tabular}{" + columns + "}\n\\toprule\n";
  latex += latex_row(headings) + "\\midrule\n";
  for (const auto& row : table.rows) latex += latex_row(row);
  return latex + "\\bottomrule\n\\end{tabular}\n";
}

std::string latex_table(const StudyAnalysis& study, const TextTable& table) {
  return "% " + visible(study.study_name) + ", seed " + std::to_string(study.seed) + ", study " +
         study.study_sha256 + "; needs \\usepackage{booktabs}\n" + latex_tabular(table);
}

}  // namespace montecarta::analysis
