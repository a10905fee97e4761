// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/drive_facts.hpp"

#include "analysis/run/path_at_fixes.hpp"
#include "analysis/study/prose.hpp"
#include "analysis/study/reference_sums.hpp"
#include "analysis/verdict/drive_verdict.hpp"
#include "analysis/verdict/innovations.hpp"
#include "engine/text/list_text.hpp"
#include "engine/text/number_text.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace montecarta::analysis {
namespace {

constexpr const char* kDeadReckoning = "dead_reckoning";

std::string count(std::size_t n) { return std::to_string(n); }

/// Adds a fact below `## key` of the texts.
void add(const char* key, const Values& values, std::vector<std::string>& facts) {
  facts.push_back(prose("drive_facts", key, values));
}

/// Returns whether the cell estimates a map and reports it. External programs need not report one.
bool has_map(const CellAnalysis& cell) {
  return cell.complete > 0 && cell.filter != kDeadReckoning && cell.filter != "external";
}

/// Says which cells have a map and never compared a detection with it.
void add_cells_without_innovation(const StudyAnalysis& study, std::vector<std::string>& facts) {
  std::string cells;
  for (const CellAnalysis& cell : study.cells) {
    const std::vector<double> landmarks = cell.scores.column("map_landmarks");
    const bool is_empty = std::ranges::count(landmarks, 0.0) > 0;
    if (!has_map(cell) || is_empty || cell.find<Innovations>() != nullptr) continue;
    append_part(cells, cell.label);
  }
  if (!cells.empty()) add("no innovation", {{"cells", cells}}, facts);
}

/// Cells that initialised no landmark in the same number of runs share a sentence.
void add_cells_without_landmark(const StudyAnalysis& study, std::vector<std::string>& facts) {
  std::vector<std::pair<std::string, std::string>> found;  // runs, cells
  for (const CellAnalysis& cell : study.cells) {
    const std::vector<double> landmarks = cell.scores.column("map_landmarks");
    const auto without = static_cast<std::size_t>(std::ranges::count(landmarks, 0.0));
    if (!has_map(cell) || without == 0) continue;
    const std::string runs = without == cell.complete ? ""
                                                      : " in " + count(without) + " of " +
                                                            count(cell.complete) + " runs";
    const auto same = std::ranges::find(found, runs, [](const auto& pair) { return pair.first; });
    if (same == found.end()) {
      found.emplace_back(runs, cell.label);
    } else {
      same->second += ", " + cell.label;
    }
  }
  for (const auto& [runs, cells] : found) {
    add("no landmark", {{"cells", cells}, {"runs", runs}}, facts);
  }
}

void add_fixes_in_gaps(const StudyAnalysis& study, std::vector<std::string>& facts) {
  for (const JudgedReference& reference : study.references) {
    if (reference.in_gaps == 0) continue;
    add(study.rows_are_scans ? "in gaps of scans" : "in gaps of odometry",
        {{"left", count(reference.in_gaps)},
         {"all", count(reference.all_fixes())},
         {"reference", reference.name},
         {"gap", readable(kLongestGap, 1)}},
        facts);
  }
}

void add_fixes_outside(const StudyAnalysis& study, std::vector<std::string>& facts) {
  for (const JudgedReference& reference : study.references) {
    Values values = {{"all", count(reference.all_fixes())}, {"reference", reference.name}};
    if (reference.outside > 0 && reference.outside == reference.all_fixes()) {
      add("other clock", values, facts);
    } else if (reference.outside > 0) {
      values.emplace_back("left", count(reference.outside));
      add(study.rows_are_scans ? "outside of scans" : "outside of odometry", values, facts);
    }
  }
}

/// Says of each reference whether the filter that only integrates the odometry has its headings.
void add_headings_of_odometry(const StudyAnalysis& study, std::vector<std::string>& facts) {
  constexpr double kSameHeading = 1e-3;  // [rad]
  const auto found = std::ranges::find(study.cells, kDeadReckoning, &CellAnalysis::filter);
  if (found == study.cells.end()) return;
  const ReferenceAnalyses& all = found->get<ReferenceAnalyses>();
  for (std::size_t r = 0; r < all.size(); ++r) {
    const double rmse = all[r].over_runs(&ReferenceScores::heading_rmse).summary.mean;
    if (!(rmse < kSameHeading)) continue;
    add("odometry heading", {{"reference", study.references[r].name}, {"cell", found->label}},
        facts);
  }
}

void add_facts_of_drive(const CellAnalysis& cell, const std::string& reference,
                        const DriveScores& drive, std::vector<std::string>& facts) {
  const Values names = {{"cell", cell.label}, {"reference", reference}};
  const auto with_names = [&](Values values) {
    values.insert(values.end(), names.begin(), names.end());
    return values;
  };
  if (drive.undefined > 0) {
    add("undefined",
        with_names(
            {{"left", count(drive.undefined)}, {"all", count(drive.fixes + drive.undefined)}}),
        facts);
  }
  if (drive.outliers == 0 || drive.leads().mean <= 2.0 * drive.ratio_without_outliers) return;
  add("outliers",
      with_names({{"outliers", count(drive.outliers)},
                  {"fixes", count(drive.fixes)},
                  {"sigmas", readable(kGrossDeviations, 2)},
                  {"ratio", compact(drive.leads().mean)},
                  {"without", compact(drive.ratio_without_outliers)}}),
      facts);
}

void add_facts_of_drives(const StudyAnalysis& study, std::vector<std::string>& facts) {
  for (const CellAnalysis& cell : study.cells) {
    const DriveConsistencies& all = cell.get<DriveConsistencies>();
    std::size_t k = 0;
    for (const JudgedReference& reference : study.references) {
      if (!reference.has_errors || k == all.size()) continue;
      add_facts_of_drive(cell, reference.name, all[k++].mean, facts);
    }
  }
}

}  // namespace

std::vector<std::string> drive_facts(const StudyAnalysis& study) {
  std::vector<std::string> facts;
  if (study.has_truth || study.imported.is_imported()) return facts;
  if (!study.odometry.empty()) add("odometry", {{"way", study.odometry}}, facts);
  add_cells_without_landmark(study, facts);
  add_cells_without_innovation(study, facts);
  add_fixes_in_gaps(study, facts);
  add_fixes_outside(study, facts);
  add_headings_of_odometry(study, facts);
  add_facts_of_drives(study, facts);
  return facts;
}

}  // namespace montecarta::analysis
