// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/commands/arguments.hpp"

#include <functional>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// Exit codes that users and scripts rely on. exit_code() gives those of an interrupted study.
inline constexpr int kDone = 0, kFailed = 1, kWrongInput = 2, kDifferent = 4;
/// Exit codes of `gate`: the filter is not consistent, or there are too few runs to decide.
inline constexpr int kInconsistent = 4, kUndecided = 5;

/// One command of the program. `run` returns the exit code.
struct Command {
  CommandSpec spec;
  std::function<int(const Arguments&)> run;
};

Command run_command();
Command check_command();
Command info_command();
Command status_command();
Command merge_command();
Command analyze_command();
Command report_command();
Command verify_command();
Command replay_command();
Command compare_command();
Command gate_command();
Command bounds_command();
Command plan_command();
Command export_command();
Command judge_command();
Command list_command();

/// All commands, in the order of the help.
std::vector<Command> all_commands();

/// Runs the program with the words that follow its name: finds the command, runs it, and turns
/// exceptions into messages on standard error. Returns the exit code.
int run_program(const std::vector<std::string>& words);

}  // namespace montecarta::experiments
