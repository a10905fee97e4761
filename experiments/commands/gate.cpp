// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/render/page/html.hpp"
#include "analysis/run/imported_state.hpp"
#include "analysis/study/study_analysis.hpp"
#include "analysis/verdict/block_errors.hpp"
#include "analysis/verdict/innovations.hpp"
#include "analysis/verdict/sentence.hpp"
#include "analysis/verdict/verdict.hpp"
#include "engine/core/judgement.hpp"
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/text/wrapped_text.hpp"
#include "experiments/commands/arguments.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/commands/stored_result.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <iostream>
#include <set>
#include <string>
#include <vector>

namespace montecarta::experiments {
namespace {

/// What the gate says of a cell.
struct GatedCell {
  CellAnalysis cell;
  Verdict verdict;  ///< verdict on its errors, or on the size of its innovations
  const analysis::Innovations* innovations = nullptr;  ///< of imported innovations; else nullptr
  GateAnswer answer = GateAnswer::undecided;
  std::string beside = {};  ///< what else decided: "The innovations are not white."
};

bool are_innovations(const ResultFile& file) {
  return !file.cells().empty() && analysis::imported_state(file.cells().front()).are_innovations();
}

/// Whether the cells are the sensors of one filter: FILTER.SENSOR.
bool are_of_one_filter(const ResultFile& file) {
  std::set<std::string> filters;
  for (const StoredCell& cell : file.cells()) {
    const std::string end = "." + analysis::setting_of(cell.settings, "sensor");
    filters.insert(cell.label.ends_with(end) ? cell.label.substr(0, cell.label.size() - end.size())
                                             : cell.label);
  }
  return filters.size() == 1;
}

/// The cells that are judged: the one that is named, or all sensors of the only filter.
std::vector<StoredCell> cells_to_judge(const Arguments& arguments, const ResultFile& file) {
  const auto label = arguments.text("cell");
  if (!label && (file.cells().size() == 1 || (are_innovations(file) && are_of_one_filter(file))))
    return file.cells();
  return {item_called(label.value_or(""), file.cells(), &StoredCell::label,
                      (label ? formatted("--cell {}: no cell of {}", *label, file.path())
                             : "gate: --cell CELL is needed") +
                          " (one of its filters is judged)")};
}

/// Throws StudyError if runs are missing: those that ended first are not a fair sample.
void require_all_runs(const ResultFile& file, const StoredCell& cell) {
  const RunCounts counts = count_status(file, cell);
  if (counts.missing == 0) return;
  throw StudyError(
      "{}: {} runs of cell {} are missing (those that ended first are no fair sample): finish the "
      "study with montecarta run ... --resume",
      file.path(), counts.missing, cell.label);
}

int code_of(GateAnswer answer) {
  return answer == GateAnswer::consistent     ? kDone
         : answer == GateAnswer::inconsistent ? kInconsistent
                                              : kUndecided;
}

const char* name_of(GateAnswer answer) {
  return answer == GateAnswer::consistent     ? "consistent"
         : answer == GateAnswer::inconsistent ? "inconsistent"
                                              : "undecided";
}

/// Sentence that says that more runs failed, or that more samples are unusable, than are allowed;
/// empty if neither is so.
std::string too_many(const Verdict& verdict, const Allowance& allowed) {
  const auto words = [](const std::string& what, std::uint64_t most) {
    return formatted(" More {} than are allowed ({}).", what, most);
  };
  if (verdict.failed > allowed.failed) return words("runs failed", allowed.failed);
  if (verdict.unusable > allowed.unusable) return words("samples are unusable", allowed.unusable);
  return "";
}

Json json_of(const Interval& interval) {
  return {rounded(interval.lower), rounded(interval.upper)};
}

Json json_of(const Member& member, bool is_shown) {
  return {{"name", analysis::name_of(member)},
          {"estimate", rounded(member.estimate)},
          {"interval", json_of(member.interval)},
          {"simultaneous_interval", json_of(member.simultaneous)},
          {"p", member.p},
          {"shown", is_shown}};
}

/// The lag whose correlation is farthest from its bound, of the NIS or of a component.
Json whiteness_of(const analysis::Innovations& found) {
  const bool is_tested = found.worst_lag > 0;
  const auto at_lag = [&](const std::vector<double>& values) {
    return is_tested ? Json(rounded(values[found.worst_lag - 1])) : Json();
  };
  Json components = Json::array();
  for (const analysis::ComponentCorrelation& one : found.components) {
    components.push_back({{"lag", one.lag},
                          {"correlation", rounded(one.correlation)},
                          {"bound", rounded(one.bound)},
                          {"mean", rounded(one.mean)},
                          {"mean_bound", rounded(one.mean_bound)}});
  }
  return {{"answer", analysis::whiteness_in_words(found.whiteness(), std::nullopt)},
          {"lag", found.worst_lag},
          {"correlation", at_lag(found.autocorrelation)},
          {"bound", at_lag(found.white_bound)},
          {"components", std::move(components)}};
}

Json json_of(const analysis::BlockVerdict& block) {
  return {{"name", block.name},
          {"verdict", analysis::name_of(block.verdict.answer)},
          {"estimate", rounded(block.verdict.ratio_estimate())},
          {"interval", json_of(block.verdict.ratio())}};
}

std::string reason_of(const GatedCell& gated, const Allowance& allowed) {
  return sentence(gated.cell.label, gated.verdict) + too_many(gated.verdict, allowed) +
         gated.beside;
}

/// JSON with all numbers on which the verdict rests. The scans are represented by the one with the
/// least p-value.
Json json_of(const GatedCell& gated, const Allowance& allowed) {
  const auto& [cell, verdict, innovations, answer, beside] = gated;
  Json blocks = Json::array();
  if (const auto* found = cell.find<std::vector<analysis::BlockVerdict>>()) {
    for (const analysis::BlockVerdict& block : *found) blocks.push_back(json_of(block));
  }
  Json families = Json::array();
  for (const FamilyTest& test : verdict.families) {
    Json members = Json::array();
    for (const Member& member : test.members) {
      if (test.family == Family::scan && &member != &test.strongest()) continue;
      members.push_back(json_of(member, test.is_shown(member)));
    }
    families.push_back({{"family", key_of(test.family)},
                        {"p", test.p},
                        {"rejected", test.is_rejected},
                        {"members", std::move(members)}});
  }
  Json json = {{"cell", cell.label},
               {"gate", name_of(answer)},
               {"verdict", analysis::name_of(verdict.answer)},
               {"reason", reason_of(gated, allowed)},
               {"more_runs", verdict.more_runs ? Json(*verdict.more_runs) : Json()},
               {"within", verdict.within},
               {"level", verdict.level},
               {"runs", verdict.runs},
               {"failed", verdict.failed},
               {"failed_allowed", allowed.failed},
               {"samples", verdict.samples},
               {"unusable", verdict.unusable},
               {"unusable_allowed", allowed.unusable},
               {"missing", verdict.missing},
               {"families", std::move(families)},
               {"blocks", std::move(blocks)}};
  if (innovations != nullptr) json["whiteness"] = whiteness_of(*innovations);
  return json;
}

/// Judges innovations by their whiteness too. Those of a few drives whose components are not known
/// may be off for whole drives, which neither whiteness nor size shows.
void judge_innovations(const Allowance& allowed, GatedCell& gated) {
  const analysis::Innovations& found = *gated.innovations;
  if (found.judges_size()) {
    gated.verdict = found.verdict;
    gated.verdict.is_of_innovations = true;
    gated.verdict.runs = gated.cell.complete;
    gated.verdict.failed = gated.cell.failures.size();
  }
  if (found.whiteness() == analysis::Whiteness::not_white) {
    gated.answer = GateAnswer::inconsistent;
    gated.beside = " The innovations are not white.";
    return;
  }
  gated.answer = gate(gated.verdict, allowed);
  if (gated.answer != GateAnswer::consistent) return;
  if (found.whiteness() == analysis::Whiteness::untested) {
    gated.answer = GateAnswer::undecided;
    gated.beside = " There are too few innovations in a run to tell whether they are white.";
  } else if (found.judges_size() && gated.cell.complete < analysis::kFewestRunsOfAPlan) {
    gated.answer = GateAnswer::undecided;
    gated.beside = formatted(
        " The NIS alone of fewer than {} drives does not show that a filter is consistent.",
        analysis::kFewestRunsOfAPlan);
  }
}

GatedCell gated(const ResultFile& file, const StoredCell& stored, const Arguments& arguments,
                const Allowance& allowed) {
  require_all_runs(file, stored);
  GatedCell result;
  result.cell = analyze_cell(file, stored, kUsualLevel, file.runs().size(), parallel_of(arguments),
                             arguments.number("within", kLeastMargin, kMostMargin));
  result.verdict = result.cell.verdict;
  if (are_innovations(file)) result.innovations = result.cell.find<analysis::Innovations>();
  at_place(formatted("{}: cell {}", file.path().string(), stored.label), [&] {
    if (result.innovations != nullptr) {
      judge_innovations(allowed, result);
    } else {
      result.answer = gate(result.verdict, allowed);
    }
    return result.answer;
  });
  return result;
}

/// Inconsistent if one cell is, else undecided if one is.
GateAnswer answer_of(const std::vector<GatedCell>& all) {
  for (const GateAnswer answer : {GateAnswer::inconsistent, GateAnswer::undecided}) {
    if (std::ranges::find(all, answer, &GatedCell::answer) != all.end()) return answer;
  }
  return GateAnswer::consistent;
}

}  // namespace

int gate_command(const Arguments& arguments) {
  const Allowance allowed = {.failed = arguments.count("failed", 0, UINT64_MAX).value_or(0),
                             .unusable = arguments.count("invalid", 0, UINT64_MAX).value_or(0)};
  const ResultFile file = open_stored(arguments.operands().front());
  const std::vector<StoredCell> cells = cells_to_judge(arguments, file);
  if (!file.has_errors() && !are_innovations(file)) {
    throw StudyError(
        "{}: has no truth (a gate judges errors or innovations): gate a study with a truth, or see "
        "references by montecarta analyze",
        file.path().string());
  }
  std::vector<GatedCell> all;
  all.reserve(cells.size());  // no cell is copied, so that `innovations` stays valid
  for (const StoredCell& cell : cells) all.push_back(gated(file, cell, arguments, allowed));
  if (arguments.has("json")) {
    Json json = Json::array();
    for (const GatedCell& one : all) json.push_back(json_of(one, allowed));
    std::cout << (all.size() == 1 ? json.front() : json).dump(2) << "\n";
  } else {
    for (const GatedCell& one : all) std::cout << wrapped(reason_of(one, allowed), output_width());
  }
  return code_of(answer_of(all));
}

}  // namespace montecarta::experiments
