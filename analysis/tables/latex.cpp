// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/tables/tables.hpp"
#include "engine/visible_text.hpp"

#include <map>
#include <string_view>

namespace montecarta::analysis {
namespace {

/// The LaTeX code that prints a character.
std::string latex_escaped(char c) {
  static const std::map<char, std::string> kWords = {{'\\', "\\textbackslash{}"},
                                                     {'~', "\\textasciitilde{}"},
                                                     {'^', "\\textasciicircum{}"},
                                                     {'<', "\\textless{}"},
                                                     {'>', "\\textgreater{}"}};
  const auto word = kWords.find(c);
  if (word != kWords.end()) return word->second;
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
  for (const char c : text) latex += latex_escaped(c);
  return replaced(latex, "+-", "$\\pm$");
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
