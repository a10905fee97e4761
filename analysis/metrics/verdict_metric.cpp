// SPDX-License-Identifier: BSD-3-Clause
// The verdict on the whole error: all families of tests of every cell.
#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/metric.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "analysis/metrics/verdict_table.hpp"
#include "analysis/output/number_text.hpp"
#include "analysis/verdict/whole_error.hpp"

#include <algorithm>
#include <optional>

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
    cell.verdict = judge(sums_->families(level, {criteria_->components, criteria_->times}), level,
                         criteria_->within, cell.complete);
    const NeesSeries& series = cell.nees.front().series;
    cell.verdict.samples = series.samples;
    cell.verdict.unusable = series.unusable;
    const bool has_samples = !series.run_averages.empty();
    if (cell.verdict.families.empty() && has_samples) cell.verdict.answer = Answer::undecided;
  }
  static constexpr auto parts() { return std::tuple(added(&VerdictOverRuns::sums_)); }

 private:
  const RunCriteria* criteria_;
  std::optional<WholeError> sums_;
};

void verdict_numbers(const CellAnalysis& cell, std::vector<NamedNumber>& all) {
  const Verdict& found = cell.verdict;
  all.push_back({"verdict_level", "1", found.level});
  all.push_back({"within", "1", found.within});
  all.push_back({"nees_ratio", "1", found.ratio_estimate()});
  all.push_back({"nees_ratio_lower", "1", found.ratio().lower});
  all.push_back({"nees_ratio_upper", "1", found.ratio().upper});
  all.push_back({"more_runs", "1", found.more_runs ? static_cast<double>(*found.more_runs) : kNaN});
  for (const Family family : kFamilies) {
    const FamilyTest* test = found.find(family);
    all.push_back({"p_" + key_of(family), "1", test == nullptr ? kNaN : test->p});
  }
}

/// Simultaneous interval of the ratio of every scan; NaN if a scan is not judged.
void verdict_series(const CellAnalysis& cell, std::vector<NamedSeries>& all) {
  const FamilyTest* scans = cell.verdict.find(Family::scan);
  if (scans == nullptr) return;
  const std::size_t n = cell.nees.front().series.average.size();
  NamedSeries lower{"nees_ratio_lower", "1", std::vector<double>(n, kNaN)};
  NamedSeries upper{"nees_ratio_upper", "1", std::vector<double>(n, kNaN)};
  auto member = scans->members.begin();
  for (std::size_t s = 0; s < n; ++s) {
    if (std::isnan(cell.nees.front().series.average[s])) continue;
    lower.values[s] = member->simultaneous.lower;
    upper.values[s] = member->simultaneous.upper;
    ++member;
  }
  all.push_back(std::move(lower));
  all.push_back(std::move(upper));
}

bool has_families(const StudyAnalysis& study) {
  return std::ranges::any_of(
      study.cells, [](const CellAnalysis& cell) { return !cell.verdict.families.empty(); });
}

TextTable family_table(const StudyAnalysis& study) {
  TextTable table;
  for (const CellAnalysis& cell : study.cells) {
    for (const FamilyTest& test : cell.verdict.families) {
      const Member& member = test.strongest();
      table.add({{"cell", cell.label, Align::left},
                 {"family", name_of(test.family), Align::left},
                 {"p", readable(test.p, 2)},
                 {"farthest from right", name_of(member), Align::left},
                 {"estimate [" + level_text(study.level) + "]",
                  with_interval(member.estimate, member.interval)},
                 {"shown", test.is_rejected ? "yes" : "no", Align::left}});
    }
  }
  return table;
}

std::vector<Section> verdict_sections(const StudyAnalysis& study) {
  if (!study.has_truth || !has_families(study)) return {};
  std::size_t tests = 0;
  std::ptrdiff_t rejected = 0;
  for (const CellAnalysis& cell : study.cells) {
    tests += cell.verdict.families.size();
    rejected += std::ranges::count_if(cell.verdict.families, &FamilyTest::is_rejected);
  }
  Section section = section_of(
      "families", {{"rejected", std::to_string(rejected)}, {"tests", std::to_string(tests)}});
  section.is_for_terminal = false;
  section.add("families", family_table(study));
  section.add_notes("notes");
  return {section};
}

/// One row for each member of each family; of scans too.
void write_families(const StudyAnalysis& study, const std::filesystem::path& path) {
  NamedRows file(path);
  for (const CellAnalysis& cell : study.cells) {
    for (const FamilyTest& test : cell.verdict.families) {
      const std::vector<NamedSeries> columns = family_columns(test);
      for (std::size_t m = 0; m < test.members.size(); ++m) {
        std::vector<NamedNumber> row;
        for (const NamedSeries& column : columns) {
          row.push_back({column.name, column.units, column.values[m]});
        }
        file.row({{"cell", cell.label},
                  {"family", key_of(test.family)},
                  {"member", name_of(test.members[m])}},
                 row);
      }
    }
  }
  file.close();
}

}  // namespace

Metric verdict_metric() {
  return {.sums = make_sums<VerdictOverRuns>,
          .add_numbers = verdict_numbers,
          .add_series = verdict_series,
          .sections = verdict_sections,
          .files = {{"families.csv", has_families, write_families}}};
}

}  // namespace montecarta::analysis
