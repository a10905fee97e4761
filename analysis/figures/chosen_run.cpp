// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/figures/chosen_run.hpp"

#include "engine/errors.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace montecarta::analysis {
namespace {

/// In how many cells each run is complete.
std::vector<std::size_t> completeness(const ResultFile& file) {
  std::vector<std::size_t> cells(file.runs().size());
  for (const StoredCell& cell : file.cells()) {
    const auto status = file.status(cell);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      cells[i] += status[i] == RunStatus::complete ? 1 : 0;
    }
  }
  return cells;
}

}  // namespace

std::optional<std::size_t> chosen_run(const ResultFile& file, std::optional<std::uint64_t> run) {
  if (run) {
    const auto found = std::ranges::find(file.runs(), *run);
    if (found == file.runs().end()) {
      throw StudyError(file.path().string() + ": run " + std::to_string(*run) +
                       " (the file does not hold it): choose another with --run");
    }
    return static_cast<std::size_t>(found - file.runs().begin());
  }
  const auto cells = completeness(file);
  const auto best = std::ranges::max_element(cells);
  if (best == cells.end() || *best == 0) return std::nullopt;
  return static_cast<std::size_t>(best - cells.begin());
}

}  // namespace montecarta::analysis
