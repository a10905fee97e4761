// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/commands.hpp"

#include <csignal>
#include <malloc.h>

int main(int argc, char** argv) {
  // Keep freed memory: the next run needs it again, and every page that was returned to the system
  // costs a page fault.
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  mallopt(M_MMAP_THRESHOLD, 1 << 25);  // the largest threshold that glibc accepts
  // Growing a file beyond `ulimit -f` must be an error with a remedy instead of ending the process.
  std::signal(SIGXFSZ, SIG_IGN);
  return montecarta::experiments::run_program(std::vector<std::string>(argv + 1, argv + argc));
}
