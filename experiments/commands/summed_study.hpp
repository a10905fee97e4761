// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/plan.hpp"
#include "engine/records/sum_groups.hpp"
#include "engine/runs/monte_carlo.hpp"

#include <cstdint>
#include <filesystem>
#include <vector>

namespace montecarta::experiments {

/// Runs a study that stores sums (ColumnSelection::sums). Each group of runs is run like a study of
/// its own, analysed and stored in the folder OUT.h5.groups, and its rows are removed. At the end
/// the groups become OUT.h5. Ends early, and is resumed, like run_study().
RunOutcome run_summed_study(const StudyPlan& plan, const RunOptions& options);

/// The folder OUT.h5.groups of the unfinished work on the result `output`.
std::filesystem::path groups_of(std::filesystem::path output);

/// Removes the folder of the unfinished work on `output` if it has stored neither runs nor sums. No
/// other process may be at that work. Errors are ignored.
void remove_empty_work(const std::filesystem::path& output);

/// The result files of the unfinished work on `output`: finished groups and the rows of the group
/// at hand, by their first runs; none if there is no such work, or `output` exists.
std::vector<std::filesystem::path> begun_files(const std::filesystem::path& output);

/// {cell} Computes again, and returns, the sums over the group of runs that begins at `first_run`.
/// `folder` is created for the rows of these runs, and removed afterwards.
std::vector<NewGroup> computed_group(const StudyPlan& plan, std::uint64_t first_run,
                                     const std::filesystem::path& folder, const Parallel& parallel);

}  // namespace montecarta::experiments
