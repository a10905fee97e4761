// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/report.hpp"

#include "analysis/comparison/comparison_csv.hpp"
#include "analysis/figures/ancestry_figure.hpp"
#include "analysis/figures/joint_figure.hpp"
#include "analysis/figures/mismatch_figure.hpp"
#include "analysis/figures/path_figure.hpp"
#include "analysis/figures/reference_figures.hpp"
#include "analysis/figures/time_figures.hpp"
#include "analysis/figures/why_figures.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "analysis/page/page.hpp"
#include "analysis/page/sections.hpp"
#include "analysis/tables/tables.hpp"
#include "engine/errors.hpp"

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

/// The page from top to bottom. What a study has nothing of leaves its section empty.
std::vector<Section> reading_order(const ResultFile& file, const StudyAnalysis& study,
                                   const StudyComparison& comparison,
                                   const ReportOptions& options) {
  return {title_section(study),
          verdict_section(study),
          map_section(study),
          joint_section(study),
          reference_section(study),
          failure_section(study),
          replay_section(file, options.run),
          figure_section({path_figure(file, options.run)}),
          figure_section(reference_figures(study)),
          figure_section(time_figures(study)),
          figure_section({joint_figure(study)}),
          figure_section({ancestry_figure(file, options.run)}),
          figure_section(why_figures(study)),
          figure_section({mismatch_figure(study)}),
          calibration_section(study),
          comparison_section(study, comparison),
          association_section(study),
          why_section(study),
          diversity_section(study),
          innovation_section(study),
          consistency_section(study),
          origin_section(file, study),
          printed_section(study)};
}

}  // namespace

void write_report(const ResultFile& file, const fs::path& directory, const ReportOptions& options) {
  refuse_existing(directory, options.existing);
  const StudyAnalysis study = analyze(file, options.level, *options.parallel);
  const StudyComparison comparison =
      compare_study(study, study.cells.front().label, usual_scores(study.has_truth));
  const std::vector<Section> sections = reading_order(file, study, comparison, options);
  write_csv(study, directory / "tables");
  write_comparison_csv(comparison, directory / "tables");
  write_page(study, sections, directory);
}

}  // namespace montecarta
