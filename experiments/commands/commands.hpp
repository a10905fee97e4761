// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/commands/arguments.hpp"

#include <string>
#include <vector>

namespace montecarta::experiments {

/// Exit codes that users and scripts rely on. exit_code() gives those of an interrupted study.
inline constexpr int kDone = 0, kFailed = 1, kWrongInput = 2, kDifferent = 4;
/// Exit codes of `gate`: the filter is not consistent, or there are too few runs to decide.
inline constexpr int kInconsistent = 4, kUndecided = 5;

/// Runs a command, and returns the exit code.
using CommandFunction = int(const Arguments&);
CommandFunction run_command, check_command, info_command, status_command, merge_command,
    analyze_command, report_command, compare_command, gate_command, verify_command, replay_command,
    bounds_command, plan_command, tune_command, export_command, judge_command, list_command,
    work_command, benchmark_command;

/// One command of the program.
struct Command {
  CommandSpec spec;
  CommandFunction* run;
};

/// The contents of commands.md, which is built into the program.
std::string commands_text();

/// All commands, in the order of the help.
std::vector<Command> all_commands();

/// Runs the program with the words that follow its name: finds the command, runs it, and turns
/// exceptions into messages on standard error. Returns the exit code.
int run_program(const std::vector<std::string>& words);

}  // namespace montecarta::experiments
