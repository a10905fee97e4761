// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/commands.hpp"

#include <csignal>

int main(int argc, char** argv) {
  // A file that grows beyond `ulimit -f` shall be an error with a remedy, not a sudden death.
  std::signal(SIGXFSZ, SIG_IGN);
  return montecarta::experiments::run_program(std::vector<std::string>(argv + 1, argv + argc));
}
