// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

#include <filesystem>
#include <optional>

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

}  // namespace montecarta::engine
