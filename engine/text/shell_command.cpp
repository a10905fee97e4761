// SPDX-License-Identifier: BSD-3-Clause
#include "engine/text/shell_command.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string_view>
#include <sys/wait.h>

namespace montecarta::engine {

std::string CommandOutcome::last_line() const {
  std::string last = "it says nothing";
  std::string_view rest = output;
  while (!rest.empty()) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    if (line.find_first_not_of(" \t^\r") != line.npos) last = line;
    rest.remove_prefix(std::min(rest.size(), line.size() + 1));
  }
  return last;
}

CommandOutcome run_command(const std::string& command, const std::string& program) {
  FILE* const output = ::popen((command + " </dev/null").c_str(), "re");
  if (output == nullptr) {
    throw RunError("{}: cannot be started ({})", program, std::strerror(errno));
  }
  CommandOutcome outcome;
  std::array<char, 4096> part{};
  while (const std::size_t n = std::fread(part.data(), 1, part.size(), output)) {
    outcome.output.append(part.data(), n);
  }
  const int status = ::pclose(output);
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return outcome;
}

}  // namespace montecarta::engine
