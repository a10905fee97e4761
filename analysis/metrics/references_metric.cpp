// SPDX-License-Identifier: BSD-3-Clause
// Independent measurements of the path.
#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/metric.hpp"
#include "analysis/metrics/reference_analysis.hpp"
#include "analysis/metrics/reference_report.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "analysis/statistics/means.hpp"

namespace montecarta::analysis {
namespace {

/// By the leading reference.
template <double ReferenceScores::*kValue>
double of_reference(const MeasuredRun& run) {
  return run.references.empty() ? kNaN : run.references.front().scores.*kValue;
}

constexpr Score kReferencesScores[] = {
    {"reference_rms", "m", "RMS distance to the reference", of_reference<&ReferenceScores::rms>},
    {"reference_median", "m", "median distance to the reference",
     of_reference<&ReferenceScores::median>},
    {"reference_gated_rms", "m", "RMS distance to the reference without outliers",
     of_reference<&ReferenceScores::gated_rms>},
    {"reference_aligned_rms", "m", "RMS distance to the reference, aligned",
     of_reference<&ReferenceScores::aligned_rms>},
    {"reference_aligned_median", "m", "median distance to the reference, aligned",
     of_reference<&ReferenceScores::aligned_median>},
    {"reference_aligned_gated_rms", "m", "RMS distance to the reference without outliers, aligned",
     of_reference<&ReferenceScores::aligned_gated_rms>},
    {"reference_heading_rmse", "rad", "heading RMSE to the reference",
     of_reference<&ReferenceScores::heading_rmse>},
};

class ReferencesOverRuns final : public MetricSums {
 public:
  explicit ReferencesOverRuns(const RunCriteria& criteria)
      : references_(
            criteria.references.size(),
            ReferenceAccumulator(criteria.drives.empty() ? ReferenceAccumulator::Fixes::same
                                                         : ReferenceAccumulator::Fixes::own)) {}
  void add(const MeasuredRun& run) override {
    for (std::size_t r = 0; r < references_.size(); ++r) references_[r].add(run.references[r]);
  }
  void put(CellAnalysis& cell) override {
    ReferenceAnalyses all;
    for (const ReferenceAccumulator& sums : references_) all.push_back(sums.result());
    cell.findings.put(all);
  }

 private:
  std::vector<ReferenceAccumulator> references_;
};

std::vector<Section> references_sections(const StudyAnalysis& study) {
  if (study.has_truth && study.references.empty()) return {};
  Section section{"references", "Judged by references"};
  if (!study.has_truth) section.add_html("<p>" + no_truth_sentence(study) + "</p>\n");
  section.add("reference", reference_table(study));
  section.add("baseline", baseline_table(study));
  section.add("map", map_table(study));
  section.add(reference_notes(study));
  return {section};
}

bool has_references(const StudyAnalysis& study) { return !study.references.empty(); }

bool has_common_fixes(const StudyAnalysis& study) {
  return has_references(study) && study.own_drives == 0;
}

}  // namespace

Metric references_metric() {
  return {.scores = kReferencesScores,
          .scores_are_numbers = false,
          .sums = make_sums<ReferencesOverRuns>,
          .sections = references_sections,
          .figures = reference_figures,
          .files = {{"references.csv", has_references, write_references},
                    {"reference_errors.csv", has_common_fixes, write_reference_errors}}};
}

}  // namespace montecarta::analysis
