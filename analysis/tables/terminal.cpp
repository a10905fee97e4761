// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/print_table.hpp"
#include "analysis/printed/comparison.hpp"
#include "analysis/tables/joint_table.hpp"
#include "analysis/tables/map_error_table.hpp"
#include "analysis/tables/reference_table.hpp"
#include "analysis/tables/tables.hpp"
#include "analysis/tables/verdict_table.hpp"
#include "analysis/tables/why_tables.hpp"

#include <algorithm>
#include <ostream>

namespace montecarta {
namespace {

/// Failures of a study that fails a thousand times are not worth a thousand lines.
void print_failures(std::ostream& out, const StudyAnalysis& study) {
  constexpr std::size_t kMost = 20;
  TextTable table = failure_table(study);
  const std::size_t all = table.rows.size();
  out << "Failed runs (" << all << "), left out of everything below:\n";
  table.rows.resize(std::min(all, kMost));
  print_table(out, table);
  if (all > kMost) out << "... and " << all - kMost << " more: see failures.csv (--csv DIR)\n";
  out << '\n';
}

/// What a reader must hear even if they look at one table only.
void print_warnings(std::ostream& out, const StudyAnalysis& study) {
  for (const CellAnalysis& cell : study.cells) {
    const NeesResult* pose = cell.find_nees(ErrorBlock::pose, cell.leading);
    if (pose == nullptr || pose->series.floored + pose->series.undefined == 0) continue;
    print_wrapped(out, cell.label + ": of " + std::to_string(pose->series.samples) +
                           " covariances " + std::to_string(pose->series.floored) +
                           " were singular (a floor of 0.1 mm and 0.00001 rad was added) and " +
                           std::to_string(pose->series.undefined) +
                           " not a number (left out of the average).");
  }
}

void print_judged_by_truth(std::ostream& out, const StudyAnalysis& study) {
  print_table(out, verdict_table(study));
  out << '\n';
  print_table(out, accuracy_table(study));
  out << '\n';
  for (const TextTable& table : {map_error_table(study), joint_table(study), why_table(study),
                                 diversity_table(study), innovation_table(study)}) {
    if (table.rows.empty()) continue;
    print_table(out, table);
    out << '\n';
  }
  print_warnings(out, study);
}

void print_judged_by_references(std::ostream& out, const StudyAnalysis& study) {
  if (!study.has_truth) {
    print_wrapped(out, no_truth_sentence());
    out << '\n';
  }
  for (const TextTable& table : {reference_table(study), baseline_table(study), map_table(study)}) {
    if (table.rows.empty()) continue;
    print_table(out, table);
    out << '\n';
  }
  for (const std::string& note : reference_notes(study)) print_wrapped(out, note);
}

/// What a paper printed against what was measured, and what had to be assumed.
void print_printed(std::ostream& out, const StudyAnalysis& study) {
  if (study.printed.empty()) return;
  out << "\nPrinted and measured" << (study.printed.source.empty() ? "" : ": ")
      << study.printed.source << "\n\n";
  for (const TextTable& table : {printed_value_table(study), printed_claim_table(study)}) {
    if (table.rows.empty()) continue;
    print_table(out, table);
    out << '\n';
  }
  for (const std::string& note : printed_notes(study)) print_wrapped(out, note);
  for (const std::string& each : study.printed.assumptions) print_wrapped(out, "Assumed: " + each);
}

}  // namespace

void print_tables(std::ostream& out, const StudyAnalysis& study) {
  out << study.study_name << ": " << study.runs_here << " of " << study.study_runs << " runs, "
      << study.times.size() << " scans each, seed " << study.seed << "\n\n";
  if (study.has_failures()) print_failures(out, study);
  if (study.has_truth) print_judged_by_truth(out, study);
  if (!study.has_truth || !study.references.empty()) print_judged_by_references(out, study);
  if (const TextTable table = association_table(study); !table.rows.empty()) {
    print_table(out, table);
    out << '\n';
    for (const std::string& note : association_notes()) print_wrapped(out, note);
  }
  if (study.has_truth) {
    for (const std::string& note : verdict_notes(study)) print_wrapped(out, note);
    for (const std::string& note : bound_notes(study)) print_wrapped(out, note);
    for (const std::string& note : map_error_notes(study)) print_wrapped(out, note);
    for (const std::string& note : joint_notes(study)) print_wrapped(out, note);
  }
  print_printed(out, study);
}

}  // namespace montecarta
