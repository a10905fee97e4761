// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/plan.hpp"
#include "engine/records/result_description.hpp"
#include "engine/threads/parallel.hpp"
#include "experiments/commands/arguments.hpp"
#include "experiments/external/external_filter.hpp"
#include "experiments/study/study.hpp"

#include <string>
#include <vector>

namespace montecarta::experiments {

/// Of the option --within of commands that judge.
inline constexpr const char* kWithinMeaning =
    "consistent: ANEES so many times too large or small at most; default: as the study says, 1.1";

/// Options that choose what part of a study runs and on how many threads: --set, --runs, --shard,
/// --threads, --backend.
std::vector<OptionSpec> plan_options();
/// --allow-external, without which no command starts a program that a study names.
OptionSpec external_option();
/// Whether that was given. Throws StudyError where it was not and a cell of the study is a program.
ExternalPrograms programs_of(const Study& study, const Arguments& arguments);
/// The study that is the first operand, a file or the name of a shipped study, changed by --set.
Study study_of(const Arguments& arguments);
/// Its plan, cut by --runs or --shard, with programs if --allow-external is given.
StudyPlan plan_of(const Study& study, const Arguments& arguments);
/// As --threads, --backend and the environment have it.
Parallel parallel_of(const Arguments& arguments);
/// How `command` makes a file, for the file: this build and machine, the command line, threads.
TextPairs provenance_of(const std::string& command, const Arguments& arguments);

}  // namespace montecarta::experiments
