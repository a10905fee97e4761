// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/report.hpp"

#include "analysis/comparison/study_comparison.hpp"
#include "analysis/figures/ancestry_figure.hpp"
#include "analysis/figures/path_figure.hpp"
#include "analysis/metrics/metric.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "analysis/output/csv_file.hpp"
#include "analysis/page/page.hpp"
#include "analysis/tables/tables.hpp"
#include "engine/errors.hpp"

#include <algorithm>
#include <array>

namespace montecarta::analysis {
namespace {

namespace fs = std::filesystem;

void refuse_existing(const fs::path& directory, ExistingReport existing) {
  if (existing == ExistingReport::replace) return;
  for (const char* name : {"index.html", "summary.md", "figures", "data", "tables"}) {
    if (!fs::exists(directory / name)) continue;
    throw StudyError((directory / name).string() +
                     ": is there already (nothing is overwritten unasked): add --force, or choose "
                     "another directory");
  }
}

/// The page from top to bottom, by the names of sections and figures; others come before the last
/// two.
constexpr std::array kReadingOrder = {"title",
                                      "verdict",
                                      "map_errors",
                                      "joint_nees",
                                      "observability",
                                      "smoother",
                                      "drive",
                                      "references",
                                      "failures",
                                      "replay",
                                      "figure_paths",
                                      "figure_reference_error",
                                      "figure_map_size",
                                      "figure_anees",
                                      "figure_anees_parts",
                                      "figure_nees_quantiles",
                                      "figure_observability",
                                      "figure_rmse",
                                      "figure_error_envelopes",
                                      "proper_scores",
                                      "figure_diversity",
                                      "figure_ess",
                                      "figure_joint_nees",
                                      "figure_ancestry",
                                      "figure_survival",
                                      "figure_bias",
                                      "figure_nis",
                                      "figure_whiteness",
                                      "figure_mismatch",
                                      "calibration",
                                      "figure_calibration",
                                      "figure_ranks",
                                      "comparison",
                                      "association",
                                      "error_anatomy",
                                      "diversity",
                                      "innovations",
                                      "consistency",
                                      "",
                                      "origin"};

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
  sections.insert(sections.end(),
                  {title_section(study), failure_section(study), replay_section(file, options.run),
                   comparison_section(study, comparison), origin_section(file, study)});
  std::vector<Figure> figures = figures_of(study);
  figures.insert(figures.end(),
                 {path_figure(file, options.run), ancestry_figure(file, options.run)});
  for (const Figure& figure : figures) {
    if (!figure.data.empty())
      sections.push_back({"figure_" + figure.name, "", {}, false, {figure}});
  }
  std::ranges::stable_sort(sections, {}, place_of);
  return sections;
}

}  // namespace

void write_report(const ResultFile& file, const fs::path& directory, const ReportOptions& options) {
  refuse_existing(directory, options.existing);
  const StudyAnalysis study = analyze(file, options.level, *options.parallel, options.within);
  const StudyComparison comparison =
      compare_study(study, study.cells.front().label, usual_scores(study.has_truth));
  const std::vector<Section> sections = all_sections(file, study, comparison, options);
  write_csv(study, directory / "tables");
  write_comparison_csv(comparison, directory / "tables");
  write_page(study, sections, directory);
  write_text(directory / "summary.md", markdown_page(study, sections, file.provenance()));
}

}  // namespace montecarta::analysis
