// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/plan.hpp"
#include "engine/records/result_writer.hpp"
#include "engine/threads/parallel.hpp"

#include <cstdint>
#include <vector>

namespace montecarta::engine {

/// A study whose cells may stop early is run in rounds. After which numbers of runs: kFirstRound,
/// then twice as many each time, and at last all of them. All of them alone where no cell may stop.
std::vector<std::uint64_t> rounds_of(const StudyPlan& plan);
inline constexpr std::uint64_t kFirstRound = 32;
/// Of a study of `runs` runs whose cells may stop early.
std::vector<std::uint64_t> rounds_of(std::uint64_t runs);

/// Between rounds, when the first `runs` runs of every cell have ended: spares the later runs of
/// each cell that says it has enough. Tells how many that were. A study killed in between finds the
/// same answers again, since they follow from the first `runs` runs alone.
std::uint64_t spare_what_is_enough(const StudyPlan& plan, std::uint64_t runs,
                                   const Parallel& parallel, ResultWriter& writer);

}  // namespace montecarta::engine
