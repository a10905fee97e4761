// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/report.hpp"

#include "analysis/comparison/comparison_csv.hpp"
#include "analysis/figures/ancestry_figure.hpp"
#include "analysis/figures/path_figure.hpp"
#include "analysis/metrics/metric.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "analysis/page/page.hpp"
#include "analysis/page/sections.hpp"
#include "analysis/tables/tables.hpp"
#include "engine/errors.hpp"

#include <algorithm>
#include <array>

namespace montecarta {
namespace {

namespace fs = std::filesystem;

void refuse_existing(const fs::path& directory, ExistingReport existing) {
  if (existing == ExistingReport::replace) return;
  for (const char* name : {"index.html", "figures", "data", "tables"}) {
    if (!fs::exists(directory / name)) continue;
    throw StudyError((directory / name).string() +
                     ": is there already (nothing is overwritten unasked): add --force, or choose "
                     "another directory");
  }
}

/// The page from top to bottom, by the names of sections; others follow before the last two.
constexpr std::array kReadingOrder = {"title",
                                      "verdict",
                                      "map_errors",
                                      "joint_nees",
                                      "references",
                                      "failures",
                                      "replay",
                                      "paths",
                                      "references_over_time",
                                      "anees",
                                      "rmse",
                                      "diversity_over_time",
                                      "joint_nees_over_time",
                                      "ancestry",
                                      "survival",
                                      "error_anatomy_over_time",
                                      "innovations_over_time",
                                      "mismatch",
                                      "calibration",
                                      "comparison",
                                      "association",
                                      "error_anatomy",
                                      "diversity",
                                      "innovations",
                                      "consistency",
                                      "",
                                      "origin",
                                      "printed"};

std::size_t place_of(const Section& section) {
  const auto found = std::ranges::find(kReadingOrder, section.name);
  return static_cast<std::size_t>(
      (found == kReadingOrder.end() ? std::ranges::find(kReadingOrder, std::string()) : found) -
      kReadingOrder.begin());
}

/// All parts of the page. What a study has nothing of leaves its section empty.
std::vector<Section> all_sections(const ResultFile& file, const StudyAnalysis& study,
                                  const StudyComparison& comparison, const ReportOptions& options) {
  std::vector<Section> sections = sections_of(study);
  for (Section& section : std::vector<Section>{
           title_section(study), failure_section(study), replay_section(file, options.run),
           figure_section("paths", {path_figure(file, options.run)}),
           figure_section("ancestry", {ancestry_figure(file, options.run)}),
           comparison_section(study, comparison), origin_section(file, study),
           printed_section(study)}) {
    sections.push_back(std::move(section));
  }
  std::ranges::stable_sort(sections, {}, place_of);
  return sections;
}

}  // namespace

void write_report(const ResultFile& file, const fs::path& directory, const ReportOptions& options) {
  refuse_existing(directory, options.existing);
  const StudyAnalysis study = analyze(file, options.level, *options.parallel);
  const StudyComparison comparison =
      compare_study(study, study.cells.front().label, usual_scores(study.has_truth));
  const std::vector<Section> sections = all_sections(file, study, comparison, options);
  write_csv(study, directory / "tables");
  write_comparison_csv(comparison, directory / "tables");
  write_page(study, sections, directory);
}

}  // namespace montecarta
