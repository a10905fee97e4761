// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/plan.hpp"
#include "experiments/external/external_filter.hpp"
#include "experiments/study/study.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace montecarta::experiments {

/// Runs [first, last) of a study.
struct RunRange {
  std::uint64_t first = 0;
  std::uint64_t last = 0;
};

/// Parses "A:B", a half-open range; A or B may be left out. Throws StudyError unless 0 <= A < B <=
/// runs.
RunRange parse_run_range(const std::string& text, std::uint64_t runs);
/// Parses "I/N", the I-th (from 0) of N nearly equal ranges that follow each other and consist of
/// whole units of `runs_of_unit` runs. Throws StudyError unless I < N and there are N units.
RunRange parse_shard(const std::string& text, std::uint64_t runs, std::uint64_t runs_of_unit = 1);

/// The reason why the study cannot store joint estimates, as the end of a StudyError: "(why):
/// remedy"; empty if it can.
std::string objection_to_joint(const Study& study);

/// The reasons why the study cannot store the columns observability and evolution, in the form of
/// objection_to_joint(); empty if it can.
std::string objection_to_observability(const Study& study);
std::string objection_to_evolution(const Study& study);

/// The number of the first scan that is judged: that at study.judge_from or later.
std::size_t first_judged_scan(const Study& study, const Itinerary& itinerary);

/// Makes the plan of a study: its drives and its filters, for all runs or those in `range`. Filters
/// that are external programs cannot be made unless `programs` allows it. Throws StudyError if
/// settings that are valid by themselves do not fit together, or if an external program does not
/// exist.
StudyPlan make_plan(const Study& study, std::optional<RunRange> range = std::nullopt,
                    ExternalPrograms programs = ExternalPrograms::refused);

}  // namespace montecarta::experiments
