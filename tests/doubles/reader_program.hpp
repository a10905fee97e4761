// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdio>
#include <string>

namespace montecarta::engine {

/// The output of a program, standard error included, and its status (0: success).
struct ProgramOutcome {
  int status = -1;
  std::string output;
};

/// Runs a shell command.
inline ProgramOutcome run_program(const std::string& command) {
  ProgramOutcome outcome;
  std::FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return outcome;
  std::array<char, 4096> buffer;
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe))
    outcome.output.append(buffer.data(), n);
  outcome.status = ::pclose(pipe);
  return outcome;
}

/// Returns whether the shell finds a program; tests of real readers skip visibly where not.
inline bool installed(const std::string& program) {
  return run_program("command -v " + program).status == 0;
}

/// Returns whether Debian's Python finds a module.
inline bool python_has(const std::string& module) {
  return run_program("/usr/bin/python3 -c 'import " + module + "'").status == 0;
}

}  // namespace montecarta::engine
