// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/render/tables/terminal.hpp"

#include "analysis/study/drive_facts.hpp"
#include "analysis/study/imported_notes.hpp"
#include "analysis/study/metric.hpp"
#include "analysis/study/reference_sums.hpp"
#include "analysis/study/registry.hpp"
#include "analysis/study/section.hpp"
#include "analysis/study/text_table.hpp"
#include "analysis/study/verdict_table.hpp"
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/text/list_text.hpp"
#include "engine/text/wrapped_text.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <ostream>

namespace montecarta::analysis {
namespace {

/// Prints the failed runs; those of a cell that failed for the same reason share a line.
void print_failures(std::ostream& out, const StudyAnalysis& study, std::size_t width) {
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
  print_table(out, table, width);
  if (reasons > kMost) out << "... and " << reasons - kMost << " other reasons\n";
  if (all > reasons) out << "Each of them: failures.csv (--csv DIR)\n";
  out << '\n';
}

std::vector<Section> terminal_sections(const StudyAnalysis& study) {
  std::vector<Section> sections = sections_of(study);
  std::erase_if(sections, [](const Section& section) { return !section.is_for_terminal; });
  std::ranges::stable_sort(sections, {}, [](const Section& section) {
    const auto& places = reading_order();
    return std::ranges::find(places, section.name, &SectionPlace::section) - places.begin();
  });
  return sections;
}

/// Prints the tables of a section, with a blank line after each.
void print_section_tables(std::ostream& out, const Section& section, std::size_t width) {
  for (const auto& table : section.all<Section::Table>()) {
    print_table(out, table.table, width);
    out << '\n';
  }
}

/// Prints what happened on a recorded drive.
void print_facts(std::ostream& out, const StudyAnalysis& study, std::size_t width) {
  const std::vector<std::string> facts = drive_facts(study);
  for (const std::string& fact : facts) out << engine::wrapped(fact, width, 2);
  if (!facts.empty()) out << '\n';
}

/// Prints the subject of the study, the failed runs, and the verdict on each cell in a sentence.
void print_head(std::ostream& out, const StudyAnalysis& study, std::size_t width) {
  const std::string runs =
      std::to_string(study.runs_here) +
      (study.runs_here == study.study_runs ? "" : " of " + std::to_string(study.study_runs));
  const std::string noun = study.runs_here == 1 && study.study_runs == 1 ? " run, " : " runs, ";
  out << engine::wrapped(formatted("{}: {}{}{}, seed {}", study.study_name, runs, noun,
                                   study.scans_text(), study.seed),
                         width)
      << '\n';
  if (study.has_failures()) print_failures(out, study, width);
  if (!study.has_truth) out << engine::wrapped(no_truth_sentence(study), width) << '\n';
  print_sentences(out, study, width);
}

/// Prints the warnings for a reader who only looks at the summary.
void print_cautions(std::ostream& out, const StudyAnalysis& study, std::size_t width) {
  std::vector<std::string> sentences = imported_notes(study);
  std::ranges::copy(cautions(study.cells, study.imported), std::back_inserter(sentences));
  for (const std::string& caution : sentences) out << engine::wrapped(caution, width, 2);
  if (!sentences.empty()) out << '\n';
}

}  // namespace

void print_sentences(std::ostream& out, const StudyAnalysis& study, std::size_t width) {
  print_facts(out, study, width);
  bool has_any = false;
  for (const Section& section : terminal_sections(study)) {
    for (const auto& lead : section.all<Section::Lead>()) {
      out << engine::wrapped(lead.text, width, 2);
      has_any = true;
    }
  }
  if (has_any) out << '\n';
}

void print_summary(std::ostream& out, const StudyAnalysis& study, std::size_t width) {
  print_head(out, study, width);
  if (study.has_truth) {
    print_table(out, summary_table(study), width);
    out << '\n';
  } else {
    constexpr std::size_t kMostDrives = 10;  // of which each has a row for every cell
    for (const Section& section : terminal_sections(study)) {
      const bool is_wanted =
          (section.name == "own_drives" && study.own_drives <= kMostDrives) ||
          (study.references.empty() ? section.name == "innovations"
                                    : section.name == "drive" || section.name == "references");
      if (is_wanted) print_section_tables(out, section, width);
    }
  }
  print_cautions(out, study, width);
}

void print_all(std::ostream& out, const StudyAnalysis& study, std::size_t width) {
  print_head(out, study, width);
  for (const Section& section : terminal_sections(study)) {
    print_section_tables(out, section, width);
  }
  print_cautions(out, study, width);
}

void print_named(std::ostream& out, const StudyAnalysis& study, const std::string& name,
                 std::size_t width) {
  std::string known;
  for (const Section& section : sections_of(study)) {
    for (const auto& table : section.all<Section::Table>()) {
      append_part(known, table.name);
      if (table.name != name) continue;
      print_table(out, table.table, width);
      for (const auto& note : section.all<Section::Note>()) {
        out << '\n' << engine::wrapped(note.text, width);
      }
      return;
    }
  }
  throw StudyError("--table {}: no table of this study has that name: take one of {}", name, known);
}

}  // namespace montecarta::analysis
