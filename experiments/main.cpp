// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/commands.hpp"

#include <csignal>

int main(int argc, char** argv) {
  // Growing a file beyond `ulimit -f` must be an error with a remedy instead of ending the process.
  std::signal(SIGXFSZ, SIG_IGN);
  return montecarta::experiments::run_program(std::vector<std::string>(argv + 1, argv + argc));
}
