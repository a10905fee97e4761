// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

#include <filesystem>
#include <limits>
#include <optional>
#include <string>

namespace montecarta::engine {

/// The limits that the operating system sets for this process.
struct CpuLimits {
  int affinity = 1;  ///< number of processors on which the process may run
  /// Number of processors by the tightest control group; infinity if none limits it.
  double quota = std::numeric_limits<double>::infinity();
};

CpuLimits cpu_limits();

/// The tightest CPU quota, in processors, of the control group of this process and its parents,
/// version 1 or 2. `root` is "/" except in tests. Groups that cannot be read do not limit.
double cgroup_quota(const std::filesystem::path& root);

/// The number of threads that a program may use: the first one that is set of `threads_option` (the
/// text after --threads), MONTECARTA_THREADS, SLURM_CPUS_PER_TASK and OMP_NUM_THREADS, and at most
/// the tightest CPU limit. Throws StudyError if it is not a whole number from 1 to 4096. An empty
/// variable counts as not set.
int thread_budget(const std::optional<std::string>& threads_option,
                  const CpuLimits& limits = cpu_limits());

}  // namespace montecarta::engine
