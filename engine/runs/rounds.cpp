// SPDX-License-Identifier: BSD-3-Clause
#include "engine/runs/rounds.hpp"

namespace montecarta::engine {
namespace {

/// Tells how many runs of the cell from `first` on were missing and are not any more.
std::uint64_t spare_rest(std::size_t cell, std::uint64_t first, std::uint64_t last,
                         ResultWriter& writer) {
  std::uint64_t spared = 0;
  for (std::uint64_t run = first; run < last; ++run) {
    if (writer.status(cell, run) != RunStatus::missing) continue;
    writer.spare(cell, run);
    ++spared;
  }
  return spared;
}

}  // namespace

std::vector<std::uint64_t> rounds_of(const StudyPlan& plan) {
  if (plan.is_enough) return rounds_of(plan.runs_here());
  return {plan.runs_here()};
}

std::vector<std::uint64_t> rounds_of(std::uint64_t runs) {
  std::vector<std::uint64_t> rounds;
  for (std::uint64_t n = kFirstRound; n < runs; n *= 2) {
    rounds.push_back(n);
    if (n > runs / 2) break;  // 2 n may be beyond 64 bits
  }
  rounds.push_back(runs);
  return rounds;
}

std::uint64_t spare_what_is_enough(const StudyPlan& plan, std::uint64_t runs,
                                   const Parallel& parallel, ResultWriter& writer) {
  std::uint64_t spared = 0;
  for (std::size_t cell = 0; cell < plan.cells.size(); ++cell) {
    // An earlier session may have asked already, and have been stopped before it was through.
    const bool known = writer.status(cell, runs) == RunStatus::spared;
    if (known || plan.is_enough(writer.unfinished(), cell, runs, parallel)) {
      spared += spare_rest(cell, runs, plan.runs_here(), writer);
    }
  }
  return spared;
}

}  // namespace montecarta::engine
