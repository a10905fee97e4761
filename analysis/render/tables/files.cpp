// SPDX-License-Identifier: BSD-3-Clause
// Tables as CSV and LaTeX.
#include "analysis/render/tables/files.hpp"

#include "analysis/study/frame.hpp"
#include "analysis/study/metric.hpp"
#include "analysis/study/registry.hpp"
#include "analysis/study/verdict_table.hpp"
#include "analysis/verdict/sentence.hpp"
#include "engine/text/visible_text.hpp"

#include <map>
#include <string_view>

namespace montecarta::analysis {
namespace {

constexpr const char* kFailures = "failures.csv";
constexpr const char* kCells = "cells.csv";
constexpr const char* kConsistency = "consistency.csv";
constexpr const char* kRuns = "runs.csv";
std::string series_name(const std::string& label) { return "series_" + label + ".csv"; }

Frame cells_frame(const StudyAnalysis& study) {
  Frame frame;
  for (const CellAnalysis& cell : study.cells) {
    frame.add({{"cell", cell.label}, {"filter", cell.filter}, {"verdict", in_words(cell.verdict)}},
              numbers_of(cell));
  }
  return frame;
}

Frame consistency_frame(const StudyAnalysis& study) {
  Frame frame;
  for (const CellAnalysis& cell : study.cells) {
    for (const NeesResult& nees : cell.nees) {
      frame.add({{"cell", cell.label},
                 {"error", name_of(nees.block)},
                 {"covariance", name_of(nees.moments)}},
                numbers_of(cell, nees, study.level));
    }
  }
  return frame;
}

Frame runs_frame(const StudyAnalysis& study) {
  Frame frame;
  for (const CellAnalysis& cell : study.cells) {
    for (std::size_t r = 0; r < cell.runs.size(); ++r) {
      Frame::Row row = {{"cell", cell.label}, {"run", std::to_string(cell.runs[r])}};
      for (const Score& score : all_scores()) {
        row.emplace_back(score.name, score.units, cell.scores.column(score.name)[r]);
      }
      frame.add(row);
    }
  }
  return frame;
}

Frame failures_frame(const StudyAnalysis& study) {
  const TextTable table = failure_table(study);
  Frame frame;
  for (std::size_t c = 0; c < table.headings.size(); ++c) {
    frame.columns.push_back({table.headings[c].text});
    for (const TableRow& row : table.rows) frame.columns[c].texts.push_back(row[c]);
  }
  return frame;
}

Frame series_frame(const StudyAnalysis& study, const CellAnalysis& cell) {
  Frame frame{series_of(cell)};
  frame.columns.insert(frame.columns.begin(), {"time", "s", study.times});
  if (frame.columns.size() == 1) frame.columns.front().numbers.clear();
  return frame;
}

}  // namespace

std::vector<std::string> csv_names(const std::vector<std::string>& labels) {
  std::vector<std::string> names = {kFailures, kCells, kConsistency, kRuns};
  for (const Metric& metric : all_metrics()) {
    for (const TableFile& file : metric.files) names.emplace_back(file.name);
  }
  for (const std::string& label : labels) names.push_back(series_name(label));
  return names;
}

void write_csv(const StudyAnalysis& study, const std::filesystem::path& directory) {
  make_directory(directory);
  write_csv(failures_frame(study), directory / kFailures);
  write_csv(cells_frame(study), directory / kCells);
  write_csv(consistency_frame(study), directory / kConsistency);
  write_csv(runs_frame(study), directory / kRuns);
  for (const Metric& metric : all_metrics()) {
    for (const TableFile& file : metric.files) {
      const Frame frame = file.of(study);
      if (!frame.columns.empty()) write_csv(frame, directory / file.name);
    }
  }
  for (const CellAnalysis& cell : study.cells) {
    write_csv(series_frame(study, cell), directory / series_name(cell.label));
  }
}

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
