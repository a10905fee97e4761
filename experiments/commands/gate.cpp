// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/data/study_settings.hpp"
#include "analysis/metrics/consistency.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "engine/errors.hpp"
#include "experiments/commands/arguments.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/commands/stored_result.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <iostream>

namespace montecarta::experiments {
namespace {

constexpr double kGateLevel = 0.95;

const StoredCell& cell_to_judge(const Arguments& arguments, const ResultFile& file) {
  std::vector<std::string> labels;
  for (const StoredCell& cell : file.cells()) labels.push_back(cell.label);
  const auto label = arguments.text("cell");
  if (!label && file.cells().size() == 1) return file.cells().front();
  if (!label) {
    throw StudyError("gate: --cell CELL is needed (one filter is judged): one of " +
                     joined(labels));
  }
  const auto found = std::ranges::find(file.cells(), *label, &StoredCell::label);
  if (found != file.cells().end()) return *found;
  throw StudyError("--cell " + *label + ": no cell of " + file.path().string() +
                   " (it must be one of them): " + nearest_spelling(*label, labels));
}

/// A sample of those runs that happened to end first is none.
void expect_all_runs(const ResultFile& file, const StoredCell& cell) {
  const StatusCounts counts = count_status(file.status(cell));
  if (counts.missing == 0) return;
  throw StudyError(file.path().string() + ": " + std::to_string(counts.missing) + " runs of cell " +
                   cell.label +
                   " are missing (those that ended first are no fair sample): finish the study "
                   "with montecarta run ... --resume");
}

int code_of(GateAnswer answer) {
  return answer == GateAnswer::consistent     ? kDone
         : answer == GateAnswer::inconsistent ? kInconsistent
                                              : kUndecided;
}

int gate_file(const Arguments& arguments) {
  const auto within = arguments.number("within", kLeastMargin, kMostMargin);
  const Allowance allowed = {.failed = arguments.count("failed", 0, UINT64_MAX).value_or(0),
                             .unusable = arguments.count("invalid", 0, UINT64_MAX).value_or(0)};
  const ResultFile file = open_stored(arguments.operands().front());
  const StoredCell& stored = cell_to_judge(arguments, file);
  const std::string place = file.path().string();
  if (!file.has_errors()) {
    throw StudyError(place +
                     ": a recorded drive without truth (no run knows its errors): gate a simulated "
                     "study, or see the scores against references by montecarta analyze");
  }
  expect_all_runs(file, stored);
  const CellAnalysis cell =
      analyze_cell(file, stored, kGateLevel, file.runs().size(), parallel_of(arguments), within);
  try {
    const Gate found = gate(cell.consistency(), allowed);
    std::cout << stored.label << ": " << found.why << "\n";
    return code_of(found.answer);
  } catch (const StudyError& error) {
    throw StudyError(place + ": cell " + stored.label + ": " + error.what());
  }
}

}  // namespace

Command gate_command() {
  return {
      {.name = "gate",
       .summary = "tells a script by its exit code whether a filter is consistent",
       .operands = {{"FILE.h5"}},
       .options = {{"cell", "", {"CELL"}, "the cell that is judged"},
                   {"within", "", {"R"}, kWithinMeaning},
                   {"failed", "", {"N"}, "accept so many failed runs; default 0"},
                   {"invalid", "", {"N"}, "accept so many unusable samples; default 0"},
                   {"threads", "", {"N"}, "default: what this process may use"},
                   {"backend", "", {"tbb|openmp|serial"}, "how the work is spread over threads"}},
       .details =
           "Prints one line that says why. Exit codes: 0 shown to be consistent within R, "
           "4 not (optimistic,\nconservative, or more failed runs or unusable samples than "
           "accepted), 5 too few runs to know, 2 wrong\ninput or nothing to judge, 1 failed. "
           "A sample is unusable if its error or covariance is not finite\nor the covariance "
           "is not positive semidefinite. The verdict is that of montecarta analyze at\n95 "
           "%.\n\n"
           "example:\n  montecarta gate first_study.h5 --cell ekf_slam --within 1.2\n"},
      gate_file};
}

}  // namespace montecarta::experiments
