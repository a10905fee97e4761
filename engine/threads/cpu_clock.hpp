// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

#include <ctime>

namespace montecarta::engine {

/// Processor time of the calling thread since construction. A system call (0.7 us where measured),
/// so it is read once a run, not once a step.
class CpuClock {
 public:
  CpuClock() : begin_(now()) {}
  /// [s]
  double seconds() const { return now() - begin_; }

 private:
  static double now() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }
  double begin_;
};

}  // namespace montecarta::engine
