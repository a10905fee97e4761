// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/map_error_table.hpp"

#include "analysis/metrics/efficiency.hpp"
#include "analysis/metrics/map_errors.hpp"
#include "analysis/output/number_text.hpp"

#include <algorithm>
#include <map>
#include <string_view>

namespace montecarta {
namespace {

std::string text_of(const CellAnalysis& cell, std::string_view score) {
  const Summary summary = cell.over_runs(score);
  return with_error(summary.mean, summary.standard_error());
}

std::vector<std::string> row_of(const CellAnalysis& cell) {
  return {cell.label,
          text_of(cell, "landmark_rms"),
          percent(cell.get<Efficiency>().map),
          text_of(cell, "landmark_nees"),
          percent(cell.get<MapErrors>().share_inside()),
          text_of(cell, "gospa"),
          text_of(cell, "gospa_localisation"),
          text_of(cell, "landmarks_missed"),
          text_of(cell, "landmarks_invented")};
}

std::string paths_of(const CramerRaoBound& bound) {
  return bound.runs == 1 ? "of the path"
                         : "of " + std::to_string(bound.runs) +
                               " paths (root of the mean of their squares, each given its path)";
}

/// Reason, and the labels of the cells it is true of: "a, b".
std::map<std::string, std::string> cells_without_map_errors(const StudyAnalysis& study) {
  std::map<std::string, std::string> cells;
  for (const CellAnalysis& cell : study.cells) {
    if (cell.get<MapErrors>().missing.empty()) continue;
    std::string& labels = cells[cell.get<MapErrors>().missing];
    labels += (labels.empty() ? "" : ", ") + cell.label;
  }
  return cells;
}

}  // namespace

bool has_map_errors(const StudyAnalysis& study) {
  return std::ranges::any_of(
      study.cells, [](const CellAnalysis& cell) { return cell.get<MapErrors>().missing.empty(); });
}

TextTable map_error_table(const StudyAnalysis& study) {
  TextTable table;
  if (!has_map_errors(study)) return table;
  table.headings = {
      {"cell", Align::left}, {"landmark RMSE [m]"}, {"efficiency"},       {"landmark NEES"},
      {"landmarks inside"},  {"GOSPA [m]"},         {"of it errors [m]"}, {"missed"},
      {"invented"}};
  for (const CellAnalysis& cell : study.cells) table.rows.push_back(row_of(cell));
  return table;
}

std::vector<std::string> map_error_notes(const StudyAnalysis& study) {
  std::vector<std::string> notes;
  if (has_map_errors(study)) {
    notes.push_back(
        "The map after the last scan: landmark RMSE is how far landmarks are from where they "
        "stand; "
        "landmark NEES compares that with what the filter expected (2 is right, more is too sure "
        "of "
        "itself), and 'landmarks inside' is the share of landmarks whose NEES over runs is in "
        "its " +
        level_text(study.level) +
        " band, each by itself: the errors of neighbours go together. All three need to know which "
        "landmark is which.");
    notes.push_back(
        "GOSPA pairs the map with the true landmarks that came into view, whoever is who: the root "
        "of the squared errors of the pairs plus " +
        readable(0.5 * kGospaCutoff * kGospaCutoff) +
        " m2 for each landmark missed or invented (farther than " + readable(kGospaCutoff, 1) +
        " m from any partner).");
  }
  if (study.has_truth && study.beacons > 0) {
    for (const auto& [reason, cells] : cells_without_map_errors(study)) {
      notes.push_back(cells + ": no map errors, since " + reason + ".");
    }
  }
  for (const CellAnalysis& cell : study.cells) {
    if (cell.get<MapErrors>().undefined == 0) continue;
    notes.push_back(cell.label + ": the NEES of " +
                    std::to_string(cell.get<MapErrors>().undefined) +
                    " landmarks was not a number (left out of the average).");
  }
  return notes;
}

std::vector<std::string> bound_notes(const StudyAnalysis& study) {
  const CramerRaoBound& bound = study.bound;
  if (bound.empty()) {
    return {"There is no Cramer-Rao bound and no efficiency, since " + bound.missing + "."};
  }
  return {"Efficiency is the Cramer-Rao bound " + paths_of(bound) +
          ", the least error that any filter without bias can have that knows which landmark is "
          "which, divided by the error of the filter (root mean squares over all scans; of the "
          "position, in the table of maps of the landmarks): 100 % is as good as can be. A filter "
          "with a bias may come out above."};
}

}  // namespace montecarta
