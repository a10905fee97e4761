// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/commands.hpp"

int main(int argc, char** argv) {
  return montecarta::run_program(std::vector<std::string>(argv + 1, argv + argc));
}
