// SPDX-License-Identifier: BSD-3-Clause
// Ends the program with a message instead of an illegal instruction on a processor that lacks
// instructions for which the program was compiled. This file is compiled for any processor
// (CMakeLists.txt), and the check runs before the constructors of global objects.
#include <cstring>
#include <unistd.h>

#ifdef __x86_64__

namespace {

/// Returns whether the processor has the floating-point instructions of x86-64-v3 and, if AVX-512
/// is used, of x86-64-v4.
bool has_what_is_needed() {
  __builtin_cpu_init();
#ifdef MONTECARTA_NEEDS_AVX512
  if (__builtin_cpu_supports("avx512f") == 0 || __builtin_cpu_supports("avx512bw") == 0 ||
      __builtin_cpu_supports("avx512dq") == 0 || __builtin_cpu_supports("avx512vl") == 0)
    return false;
#endif
  return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0 &&
         __builtin_cpu_supports("bmi2") != 0;
}

[[gnu::constructor(101)]] void check_processor() {
  if (has_what_is_needed()) return;
  constexpr const char* kMessage =
      "montecarta: this processor lacks instructions that the program was built for "
      "(" MONTECARTA_ARCH
      "; AVX2, FMA and BMI2 at least): build it on this machine, or use one with x86-64-v3\n";
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, kMessage, std::strlen(kMessage));
  ::_exit(2);
}

}  // namespace

#endif
