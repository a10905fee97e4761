// SPDX-License-Identifier: BSD-3-Clause
// The program in `bin` of a package for every processor runs on x86-64-v3. Where the processor has
// x86-64-v4 it hands over, before anything else runs, to the program beside it that has wider
// registers and gives the same bits. MONTECARTA_ARCH=x86-64-v3 in the environment keeps it.
#include "experiments/files/files.hpp"

#include <cstdlib>
#include <cstring>
#include <unistd.h>

namespace {

bool has_wider_registers() {
  __builtin_cpu_init();
  return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
         __builtin_cpu_supports("avx512cd") != 0 && __builtin_cpu_supports("avx512dq") != 0 &&
         __builtin_cpu_supports("avx512vl") != 0;
}

/// Returns whether the user chose x86-64-v3. Ends the program if it is another choice.
bool is_to_stay() {
  const char* chosen = std::getenv("MONTECARTA_ARCH");
  if (chosen == nullptr || *chosen == '\0') return false;
  if (std::strcmp(chosen, "x86-64-v3") == 0) return true;
  const std::string message = "montecarta: MONTECARTA_ARCH=" + std::string(chosen) +
                              " (not a choice): say x86-64-v3, or leave it out for the widest\n";
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, message.data(), message.size());
  ::_exit(2);
}

// After the check of the processor.
[[gnu::constructor(102)]] void hand_over(int, char** arguments, char**) {
  if (is_to_stay() || !has_wider_registers()) return;
  const std::filesystem::path wider =
      montecarta::experiments::program_path().parent_path().parent_path() /
      montecarta::experiments::kWiderFolder / "montecarta";
  ::execv(wider.c_str(), arguments);  // returns where there is none
}

}  // namespace
