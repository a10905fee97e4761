// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace montecarta::engine {

/// What the operating system lets this process use.
struct CpuLimits {
  int affinity = 1;  ///< processors the process may run on
  std::optional<double>
      quota;  ///< processors' worth of time of the tightest control group, if any limits it
};

CpuLimits cpu_limits();

/// The tightest CPU quota of the process's control group and its parents, version 1 or 2, in
/// processors. `root` is "/" but for tests. Groups that cannot be read do not limit.
std::optional<double> cgroup_quota(const std::filesystem::path& root);

/// How many threads a program may use, and who says so.
struct ThreadBudget {
  int threads = 1;
  std::string source;  ///< e.g. "--threads", "SLURM_CPUS_PER_TASK", "CPU affinity"
};

/// Value of an environment variable, nullopt where it is unset.
using Environment = std::function<std::optional<std::string>(const char* name)>;
std::optional<std::string> environment_variable(const char* name);

/// The first that is set of: `threads_option` (the text behind --threads), MONTECARTA_THREADS,
/// SLURM_CPUS_PER_TASK, OMP_NUM_THREADS; else the tightest of the CPU limits. Throws StudyError
/// where the one that counts is not a whole number from 1 to 4096. A variable set to nothing counts
/// as unset.
ThreadBudget thread_budget(const std::optional<std::string>& threads_option,
                           const Environment& environment = environment_variable,
                           const CpuLimits& limits = cpu_limits());

}  // namespace montecarta::engine
