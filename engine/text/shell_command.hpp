// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace montecarta::engine {

/// How a command ended, and what it wrote.
struct CommandOutcome {
  static constexpr int kNotFound = 127;  ///< exit code of the shell if there is no such program
  int exit_code = 0;                     ///< -1 if a signal ended it
  std::string output;
  bool has_succeeded() const { return exit_code == 0; }
  /// The last line of the output that is not empty, or "it says nothing". Lines of ^, by which
  /// gnuplot marks the place of an error, do not count.
  std::string last_line() const;
};

/// Runs a command of the shell without input, and waits for its end. Its error output is part of
/// its output if the command says 2>&1. Throws RunError, naming `program`, if no process can be
/// started.
CommandOutcome run_command(const std::string& command, const std::string& program);

}  // namespace montecarta::engine
