// SPDX-License-Identifier: BSD-3-Clause
// The verdict on the whole error of every cell.
#include "analysis/run/measured_run.hpp"
#include "analysis/study/efficiency.hpp"
#include "analysis/study/imported_notes.hpp"
#include "analysis/study/metric.hpp"
#include "analysis/study/study_analysis.hpp"
#include "analysis/study/verdict_table.hpp"
#include "analysis/verdict/innovations.hpp"
#include "analysis/verdict/interim_analysis.hpp"
#include "analysis/verdict/sentence.hpp"
#include "analysis/verdict/whole_error.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace montecarta::analysis {
namespace {

class VerdictOverRuns final : public MergedSums<VerdictOverRuns> {
 public:
  explicit VerdictOverRuns(const RunCriteria& criteria) : criteria_(&criteria) {}
  void add(const MeasuredRun& run) override {
    const WhitenedRun& errors = run.metrics.whitened();
    if (errors.dimension == 0) return;
    if (!sums_) sums_.emplace(errors.dimension, criteria_->times.size());
    sums_->add(errors, run.metrics.leading_nees()->value[0]);
  }
  void put(CellAnalysis& cell) override {
    const std::uint64_t ended = cell.complete + cell.failures.size();
    const double level = criteria_->verdict_level(ended);
    cell.verdict.level = level;
    cell.verdict.within = criteria_->within;
    if (!sums_) return;
    const InterimAnalysis analysis{.level = criteria_->level_of_each(),
                                   .within = criteria_->within,
                                   .runs_at_analyses = criteria_->runs_at_analyses,
                                   .share_of_runs = criteria_->share_of_runs,
                                   .gate = cell.find<GateScale>()};
    cell.verdict =
        judge(*sums_, {criteria_->components, criteria_->times}, analysis, ended, cell.complete);
    if (criteria_->by_upper_bounds) take_for_upper_bounds(cell.verdict);
    const NeesSeries& series = cell.nees.front().series;
    cell.verdict.samples = series.samples;
    cell.verdict.unusable = series.unusable;
    cell.verdict.missing = criteria_->has_own_scans ? 0 : series.missing;
    if (criteria_->innovation_components == 0) return;
    cell.verdict.is_of_innovations = true;
    put_verdict_on_white(level, cell);
  }
  static constexpr auto parts() { return std::tuple(added(&VerdictOverRuns::sums_)); }

 private:
  void put_verdict_on_white(double level, CellAnalysis& cell) const {
    const ErrorNames names{criteria_->components, criteria_->times};
    std::vector<FamilyTest> families = sums_->white_families(level, names, cell.find<GateScale>());
    if (families.empty()) return;
    VerdictOnWhite white{cell.verdict};
    const Verdict found =
        judge(std::move(families), level, criteria_->within, cell.complete, cell.verdict.beside);
    white.verdict.families = found.families;
    white.verdict.answer = found.answer;
    white.verdict.of_tests = found.of_tests;
    white.verdict.is_refused = found.is_refused;
    take_for_white_drives(cell.verdict, white.verdict);
    cell.findings.put(std::move(white));
  }

  const RunCriteria* criteria_;
  std::optional<WholeError> sums_;
};

/// Adds the p-value of each family as p_FAMILY; NaN if the family does not apply.
void verdict_numbers(const CellAnalysis& cell, Frame::Row& all) {
  const Verdict& found = cell.verdict;
  all.insert(all.end(),
             {{"verdict_level", "1", found.level},
              {"within", "1", found.within},
              {"nees_ratio", "1", found.ratio_estimate()},
              {"nees_ratio_lower", "1", found.ratio().lower},
              {"nees_ratio_upper", "1", found.ratio().upper},
              {"more_runs", "1", found.more_runs ? static_cast<double>(*found.more_runs) : kNaN}});
  for (const Family family : kFamilies) {
    const FamilyTest* test = found.find(family);
    all.emplace_back("p_" + key_of(family), "1", test == nullptr ? kNaN : test->p);
  }
}

/// Adds the simultaneous interval of the ratio of every scan; NaN if a scan is not judged.
void verdict_series(const CellAnalysis& cell, std::vector<Frame::Column>& all) {
  const FamilyTest* scans = cell.verdict.find(Family::scan);
  if (scans == nullptr) return;
  const std::size_t n = cell.nees.front().series.average.size();
  Frame::Column lower{"nees_ratio_lower", "1", std::vector<double>(n, kNaN)};
  Frame::Column upper{"nees_ratio_upper", "1", std::vector<double>(n, kNaN)};
  auto member = scans->members.begin();
  for (std::size_t s = 0; s < n; ++s) {
    if (std::isnan(cell.nees.front().series.average[s])) continue;
    lower.numbers[s] = member->simultaneous.lower;
    upper.numbers[s] = member->simultaneous.upper;
    ++member;
  }
  all.push_back(std::move(lower));
  all.push_back(std::move(upper));
}

/// Text of the answers, in the order of the cells: "2 of 3 cells are optimistic, 1 is undecided".
std::string answers_text(const StudyAnalysis& study) {
  std::vector<std::string> names;
  for (const CellAnalysis& cell : study.cells) names.push_back(name_of(cell.verdict.answer));
  std::string text;
  for (auto name = names.begin(); name != names.end(); ++name) {
    if (std::find(names.begin(), name, *name) != name) continue;
    const auto n = std::count(name, names.end(), *name);
    text += text.empty() ? std::to_string(n) + " of " + std::to_string(names.size()) + " cells "
                         : ", " + std::to_string(n) + " ";
    text += (n == 1 ? "is " : "are ") + *name;
  }
  return text;
}

Section verdict_section(const StudyAnalysis& study) {
  Section section = section_of("verdict", {{"answers", answers_text(study)}});
  for (const CellAnalysis& cell : study.cells) {
    section.blocks.emplace_back(Section::Lead{sentence(cell.label, cell.verdict)});
  }
  section.add("verdict", verdict_table(study));
  const bool has_poses = !study.imported.is_imported() || study.imported.state == "pose";
  if (has_poses) section.add("accuracy", accuracy_table(study));
  section.add(imported_notes(study));
  section.add(verdict_notes(study));
  section.add(bound_notes(study.bound));
  section.add(cautions(study.cells, study.imported));
  return section;
}

std::vector<Section> verdict_sections(const StudyAnalysis& study) {
  if (!study.has_truth) return {};
  return {verdict_section(study)};
}

}  // namespace

Metric verdict_metric() {
  return {.sums = make_sums<VerdictOverRuns>,
          .add_numbers = verdict_numbers,
          .add_series = verdict_series,
          .sections = verdict_sections};
}

}  // namespace montecarta::analysis
