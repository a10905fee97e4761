// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/imported_estimates.hpp"
#include "analysis/metrics/metric.hpp"
#include "analysis/metrics/reference_report.hpp"
#include "analysis/metrics/verdict_table.hpp"
#include "analysis/output/text_table.hpp"
#include "analysis/tables/tables.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <ostream>
#include <variant>

namespace montecarta::analysis {
namespace {

/// Runs of a cell that failed for one reason are one line.
void print_failures(std::ostream& out, const StudyAnalysis& study) {
  constexpr std::size_t kMost = 20;
  TextTable table;
  table.headings = {
      {"cell", Align::left}, {"runs"}, {"first run"}, {"at step"}, {"reason", Align::left}};
  std::size_t all = 0;
  for (const CellAnalysis& cell : study.cells) {
    std::map<std::string, std::vector<const FailedRun*>> by_reason;
    for (const FailedRun& failure : cell.failures) by_reason[failure.reason].push_back(&failure);
    all += cell.failures.size();
    for (const auto& [reason, runs] : by_reason) {
      table.rows.push_back({cell.label, std::to_string(runs.size()),
                            std::to_string(runs.front()->run), std::to_string(runs.front()->step),
                            reason});
    }
  }
  const std::size_t reasons = table.rows.size();
  out << "Failed runs (" << all << "), left out of everything below:\n";
  table.rows.resize(std::min(reasons, kMost));
  print_table(out, table);
  if (reasons > kMost) out << "... and " << reasons - kMost << " other reasons\n";
  if (all > reasons) out << "Each of them: failures.csv (--csv DIR)\n";
  out << '\n';
}

/// What a reader must hear even if they look at one table only.
void print_warnings(std::ostream& out, const StudyAnalysis& study) {
  for (const CellAnalysis& cell : study.cells) {
    const NeesResult* pose = cell.find_nees(ErrorBlock::pose, cell.leading);
    if (study.imported.is_imported()) break;  // imported_notes() say it
    if (pose == nullptr || pose->series.lower_rank + pose->series.unusable == 0) continue;
    print_wrapped(out, cell.label + ": of " + std::to_string(pose->series.samples) +
                           " covariances " + std::to_string(pose->series.lower_rank) +
                           " are singular (judged by the components that they leave) and " +
                           std::to_string(pose->series.unusable) +
                           " unusable (error or covariance is not finite, or the covariance is not "
                           "positive semidefinite; left out of the average).");
  }
}

/// In this order; tables of other sections follow.
constexpr std::array kTerminalOrder = {
    "verdict",       "drive",         "references", "map_errors",  "joint_nees", "smoother",
    "proper_scores", "error_anatomy", "diversity",  "innovations", "association"};

std::vector<Section> terminal_sections(const StudyAnalysis& study) {
  std::vector<Section> sections = sections_of(study);
  std::erase_if(sections, [](const Section& section) { return !section.is_for_terminal; });
  std::ranges::stable_sort(sections, {}, [](const Section& section) {
    return std::ranges::find(kTerminalOrder, section.name) - kTerminalOrder.begin();
  });
  return sections;
}

void print_leads(std::ostream& out, const Section& section) {
  bool has_any = false;
  for (const Section::Block& block : section.blocks) {
    const auto* lead = std::get_if<Section::Lead>(&block);
    if (lead == nullptr) continue;
    print_wrapped(out, lead->text);
    has_any = true;
  }
  if (has_any) out << '\n';
}

/// A blank line behind each.
void print_section_tables(std::ostream& out, const Section& section) {
  for (const Section::Block& block : section.blocks) {
    const auto* table = std::get_if<Section::Table>(&block);
    if (table == nullptr) continue;
    print_table(out, table->table);
    out << '\n';
  }
}

void print_section_notes(std::ostream& out, const Section& section) {
  for (const Section::Block& block : section.blocks) {
    if (const auto* note = std::get_if<Section::Note>(&block)) print_wrapped(out, note->text);
  }
}

}  // namespace

void print_tables(std::ostream& out, const StudyAnalysis& study, Explanations explanations) {
  const std::vector<Section> sections = terminal_sections(study);
  out << study.study_name << ": " << study.runs_here << " of " << study.study_runs << " runs, "
      << study.scans_text() << ", seed " << study.seed << "\n\n";
  if (study.has_failures()) print_failures(out, study);
  if (!study.has_truth) {
    print_wrapped(out, no_truth_sentence(study));
    out << '\n';
  }
  for (const Section& section : sections) print_leads(out, section);
  for (const Section& section : sections) print_section_tables(out, section);
  if (study.has_truth) print_warnings(out, study);
  if (explanations == Explanations::shown) {
    for (const Section& section : sections) print_section_notes(out, section);
  } else {
    for (const std::string& note : imported_notes(study)) print_wrapped(out, note);
    for (const std::string& note : too_few_notes(study)) print_wrapped(out, note);
  }
}

}  // namespace montecarta::analysis
