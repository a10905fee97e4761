// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/imported_notes.hpp"

#include "analysis/run/nees.hpp"
#include "analysis/study/cell_analysis.hpp"
#include "analysis/study/nees_result.hpp"
#include "analysis/study/prose.hpp"
#include "analysis/verdict/block_errors.hpp"
#include "analysis/verdict/convention_hints.hpp"
#include "analysis/verdict/gate_scale.hpp"
#include "analysis/verdict/sentence.hpp"
#include "engine/text/list_text.hpp"
#include "engine/text/number_text.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace montecarta::analysis {
namespace {

std::string sentence_on(const std::string& state, const std::string& convention) {
  if (convention == "body") return "in the frame of the estimate";
  if (convention == "world-body")
    return "position in the frame of the map, rotation in that of the estimate";
  if (convention == "right-invariant")
    return "right-invariant: the logarithm of mean times inverse truth";
  if (convention == "left-invariant")
    return "left-invariant: the logarithm of inverse truth times mean";
  return state == "vector" ? "estimate minus truth"
                           : "estimate minus truth in the frame of the map";
}

std::vector<std::string> notes_on_innovations(const StudyAnalysis& study) {
  std::vector<std::string> notes;
  if (study.has_truth && !study.cells.empty()) {
    notes.push_back(prose("innovations", "alone",
                          {{"components", components_text(study)},
                           {"each", level_text(study.cells.front().verdict.level)},
                           {"level", level_text(study.level)}}));
  }
  std::string gates;
  for (const CellAnalysis& cell : study.cells) {
    if (cell.find<GateScale>() == nullptr) continue;
    append_part(gates, cell.label + " (" + setting_of(cell.settings, "gate") + ")");
  }
  if (!gates.empty()) notes.push_back(prose("innovations", "gate", {{"gates", gates}}));
  return notes;
}

/// The cells whose covariances are only bounds, or those whose covariances are exact.
std::string cells_of(const StudyAnalysis& study, bool are_bounded) {
  std::string cells;
  for (const CellAnalysis& cell : study.cells) {
    if (has_bounds(cell.settings) != are_bounded) continue;
    append_part(cells, cell.label);
  }
  return cells;
}

/// What increments are, and by which covariance those of each cell are judged.
std::vector<std::string> notes_on_windows(const StudyAnalysis& study) {
  std::vector<std::string> notes = {
      prose("components", "windows",
            {{"windows", study.imported.windows}, {"components", components_text(study)}})};
  const std::string added = cells_of(study, false), bounded = cells_of(study, true);
  const auto of = [](const std::string& cells, const std::string& others) {
    return others.empty() ? std::string() : " of " + cells;
  };
  if (!added.empty())
    notes.push_back(prose("components", "added", {{"cells", of(added, bounded)}}));
  if (!bounded.empty())
    notes.push_back(prose("components", "bounded", {{"cells", of(bounded, added)}}));
  return notes;
}

/// Hints on other errors and layouts. Bounds belong to the stated error alone, and have none.
std::vector<std::string> hints_of(const StudyAnalysis& study) {
  std::vector<std::string> hints;
  for (const CellAnalysis& cell : study.cells) {
    if (has_bounds(cell.settings)) continue;
    const std::string hint = in_words(cell.get<ConventionHint>(), cell.label,
                                      study.imported.convention, cell.verdict.has_finding());
    if (!hint.empty()) hints.push_back(prose("components", "hint", {{"hint", hint}}));
  }
  return hints;
}

/// Why blocks of a state are undecided, which their row in the table does not say. Of bounds a note
/// says it once.
std::vector<std::string> notes_on_blocks(const StudyAnalysis& study) {
  std::vector<std::string> notes;
  for (const CellAnalysis& cell : study.cells) {
    if (has_bounds(cell.settings)) continue;
    for (const BlockVerdict& block : cell.get<std::vector<BlockVerdict>>()) {
      if (block.verdict.answer != Answer::undecided) continue;
      notes.push_back(prose(
          "components", "undecided block",
          {{"cell", cell.label}, {"block", block.name}, {"verdict", in_words(block.verdict)}}));
    }
  }
  return notes;
}

}  // namespace

std::string components_text(const StudyAnalysis& study) {
  return joined(study.imported.components);
}

std::vector<std::string> imported_notes(const StudyAnalysis& study) {
  if (study.imported.are_innovations()) return notes_on_innovations(study);
  if (!study.imported.is_imported()) return {};
  const std::string& convention = study.imported.convention;
  std::vector<std::string> notes = {
      prose("components", "imported",
            {{"convention", convention},
             {"meaning", sentence_on(study.imported.state, convention)},
             {"components", components_text(study)}})};
  if (!study.imported.windows.empty()) notes = notes_on_windows(study);
  if (!study.imported.pair.empty()) {
    notes.push_back(prose("components", "pair", {{"pair", study.imported.pair}}));
    return notes;
  }
  if (!study.imported.moved.empty()) {
    notes.push_back(prose("components", "anchor", {{"moved", study.imported.moved}}));
    const std::string bounded = cells_of(study, true);
    if (!bounded.empty())
      notes.push_back(prose("components", "anchor bounded", {{"cells", bounded}}));
  }
  if (study.imported.adds_truth_covariance)
    notes.push_back(prose("components", "truth covariance"));
  std::ranges::move(hints_of(study), std::back_inserter(notes));
  std::ranges::move(notes_on_blocks(study), std::back_inserter(notes));
  for (const CellAnalysis& cell : study.cells) {
    const NeesResult* all = cell.find_nees(ErrorBlock::pose, cell.leading);
    if (all == nullptr || all->series.unusable == 0) continue;
    const double share =
        static_cast<double>(all->series.unusable) / static_cast<double>(all->series.samples);
    const bool are_increments = !study.imported.windows.empty();
    notes.push_back(prose("components", are_increments ? "unusable increments" : "unusable",
                          {{"cell", cell.label},
                           {"unusable", std::to_string(all->series.unusable)},
                           {"samples", std::to_string(all->series.samples)},
                           {"share", percent(share)}}));
  }
  return notes;
}

}  // namespace montecarta::analysis
