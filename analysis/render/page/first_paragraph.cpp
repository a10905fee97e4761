// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/render/page/first_paragraph.hpp"

#include "analysis/study/reference_sums.hpp"
#include "analysis/study/verdict_table.hpp"
#include "analysis/verdict/drive_verdict.hpp"
#include "engine/text/list_text.hpp"
#include "engine/text/number_text.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::analysis {
namespace {

constexpr const char* kCellIs = " (a cell is a filter in one setting)";

/// What was studied. `cell_is` explains what a cell is, or is empty where that has been said.
std::string studied(const StudyAnalysis& study, const char* cell_is) {
  const std::string n = std::to_string(study.cells.size());
  const std::string runs = std::to_string(study.runs_here);
  const std::string time = fixed_seconds(study.duration);
  const std::string judged = "; its errors are compared with the covariance that it reports.";
  if (study.imported.are_innovations()) {
    return "The innovations of another program in " + runs + (runs == "1" ? " run" : " runs") +
           " of " + time + " are compared with the covariance that it reports.";
  }
  if (study.imported.is_imported()) {
    return "Another program estimated " + runs + " runs of " + time +
           (study.cells.size() == 1 ? "" : " in each of " + n + " cells") + judged;
  }
  const std::string cells =
      (study.cells.size() == 1 ? "One cell" : "Each of " + n + " cells") + cell_is + " estimates ";
  if (study.has_truth) {
    return cells +
           (runs == "1" ? "one simulated drive of "
                        : "the same " + runs + " simulated drives of ") +
           time + " among " + std::to_string(study.beacons) + " landmarks" + judged;
  }
  if (study.own_drives > 0) return cells + runs + " recorded drives of up to " + time + ".";
  return cells + "one recorded drive of " + time +
         (runs == "1" ? " once." : ", " + runs + " times.");
}

/// The verdict on a cell, as the first sentence says it.
struct CellAnswer {
  const CellAnalysis* cell;
  Answer answer;
  std::string words;  ///< "consistent within 1.1", "slightly optimistic"
  double ratio;       ///< NaN if there is none
};

std::string with_margin(const std::string& words, Answer answer, double within) {
  return answer == Answer::consistent ? words + " within " + exact_text(within) : words;
}

std::vector<CellAnswer> answers_by_truth(const StudyAnalysis& study) {
  std::vector<CellAnswer> answers;
  for (const CellAnalysis& cell : study.cells) {
    const Verdict& verdict = cell.verdict;
    answers.push_back({&cell, verdict.answer,
                       with_margin(answer_in_words(verdict), verdict.answer, verdict.within),
                       verdict.ratio_estimate()});
  }
  return answers;
}

std::vector<CellAnswer> answers_by_reference(const StudyAnalysis& study) {
  std::vector<CellAnswer> answers;
  for (const CellAnalysis& cell : study.cells) {
    const DriveConsistencies* all = cell.find<DriveConsistencies>();
    if (all == nullptr) continue;
    const DriveConsistency& drive = all->front();
    answers.push_back({&cell, drive.answer,
                       with_margin(name_of(drive.answer), drive.answer, drive.within),
                       drive.mean.leads().mean});
  }
  return answers;
}

std::string labels_of(const std::vector<CellAnswer>& answers) {
  std::string labels;
  for (const CellAnswer& one : answers) append_part(labels, one.cell->label);
  return labels;
}

/// The ratios of some cells, as far as they have one: " (NEES ratio 0.99 to 1.01)".
std::string ratios_in_words(const std::vector<CellAnswer>& answers, const std::string& ratio) {
  std::vector<double> ratios;
  for (const CellAnswer& one : answers) {
    if (std::isfinite(one.ratio)) ratios.push_back(one.ratio);
  }
  if (ratios.empty()) return "";
  const auto [least, most] = std::ranges::minmax(ratios);
  return " (" + ratio + " " + compact(least) + (ratios.size() == 1 ? "" : " to " + compact(most)) +
         ")";
}

/// "Of 3 cells (a cell is ...), "; nothing if there is one.
std::string of_cells(const StudyAnalysis& study) {
  if (study.cells.size() == 1) return "";
  return "Of " + std::to_string(study.cells.size()) + " cells" + kCellIs + ", ";
}

/// How many cells have which answer, and which they are: "2 are consistent within 1.1: smoother,
/// dead_reckoning (NEES ratio 0.99 to 1.01)"; of a study of one cell: "ekf_slam is optimistic (NEES
/// ratio 1.17)". Empty if none is tested.
std::string answers_in_words(const std::vector<CellAnswer>& answers, const std::string& ratio) {
  std::map<std::pair<Answer, std::string>, std::vector<CellAnswer>> found;
  std::vector<CellAnswer> untested;
  for (const CellAnswer& one : answers) {
    (one.answer == Answer::untested ? untested : found[{one.answer, one.words}]).push_back(one);
  }
  if (found.empty()) return "";
  std::string text;
  for (const auto& [answer, of_answer] : found) {
    const std::string ratios = ratios_in_words(of_answer, ratio);
    if (answers.size() == 1) return of_answer.front().cell->label + " is " + answer.second + ratios;
    const std::string n =
        of_answer.size() == answers.size() ? "all" : std::to_string(of_answer.size());
    append_part(text,
                n + (of_answer.size() == 1 ? " is " : " are ") + answer.second + ": " +
                    labels_of(of_answer) + ratios,
                "; ");
  }
  return text + (untested.empty() ? "" : "; not tested: " + labels_of(untested));
}

/// Which verdicts the cells have by the truth; empty for bounds, which are no estimates.
std::string found_by_truth(const StudyAnalysis& study) {
  const auto has_bound = [](const CellAnalysis& cell) { return has_bounds(cell.settings); };
  if (std::ranges::any_of(study.cells, has_bound)) return "";
  const std::string ratio = study.imported.name_of_ratio();
  const std::string words = answers_in_words(answers_by_truth(study), ratio);
  if (words.empty()) return "";
  return of_cells(study) + words + ". Where the " + ratio +
         " is 1, squared errors are as large as the filter claims. ";
}

/// Which verdicts the cells have by the first reference with known errors; empty if there is none.
std::string found_by_reference(const StudyAnalysis& study) {
  const auto reference = std::ranges::find_if(study.references, &JudgedReference::has_errors);
  if (reference == study.references.end()) return "";
  const std::string words = answers_in_words(answers_by_reference(study), "NEES / expected");
  if (words.empty()) return "";
  return of_cells(study) + (study.cells.size() == 1 ? "Judged by " : "judged by ") +
         reference->name + ", " + words + ". ";
}

/// Which cells are nearest to the leading reference of a recorded drive and farthest from it, in
/// the mean over runs; empty if fewer than two can be compared, if any has failed runs, which are
/// at no distance, or if all are equally far as printed. `of_cells` says of how many cells.
std::string distances_found(const StudyAnalysis& study, const std::string& of_cells) {
  if (study.references.empty() || study.own_drives > 0 || study.has_failures()) return "";
  const JudgedReference& reference = study.references.front();
  const auto score =
      reference.compares_raw() ? &ReferenceScores::rms : &ReferenceScores::aligned_rms;
  std::map<double, std::vector<const CellAnalysis*>> found;
  for (const CellAnalysis& cell : study.cells) {
    const double mean = cell.get<ReferenceAnalyses>().front().over_runs(score).summary.mean;
    if (std::isfinite(mean)) found[mean].push_back(&cell);
  }
  if (found.empty() || compact(found.begin()->first) == compact(found.rbegin()->first)) return "";
  const auto at = [&](const std::string& distance) {
    std::string labels;
    std::size_t count = 0;
    for (const auto& [mean, of_mean] : found) {
      if (compact(mean) != distance) continue;
      for (const CellAnalysis* cell : of_mean) append_part(labels, cell->label), ++count;
    }
    return labels + (count == 1 ? " is" : " are");
  };
  const std::string least = compact(found.begin()->first), most = compact(found.rbegin()->first);
  return of_cells + at(least) + " the nearest to the reference " + reference.name +
         ", with an RMS distance of " + least + " m" +
         (study.runs_here == 1 ? "" : " in the mean over runs") +
         (reference.compares_raw() ? "" : " after the best rigid alignment of each") + ", and " +
         at(most) + " the farthest, with " + most + " m. ";
}

}  // namespace

std::string studied_sentence(const StudyAnalysis& study) { return studied(study, kCellIs); }

std::string first_paragraph(const StudyAnalysis& study) {
  if (study.imported.are_innovations()) return studied_sentence(study);
  std::string found = study.has_truth ? found_by_truth(study) : found_by_reference(study);
  if (!study.has_truth)
    found += distances_found(study, found.empty() ? of_cells(study) : "Of these, ");
  return found + studied(study, found.empty() ? kCellIs : "");
}

}  // namespace montecarta::analysis
