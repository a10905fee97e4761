// SPDX-License-Identifier: BSD-3-Clause
#include "engine/threads/cpu_limits.hpp"

#include <algorithm>
#include <fstream>
#include <sched.h>
#include <sstream>
#include <string>
#include <thread>

namespace montecarta::engine {
namespace {

namespace fs = std::filesystem;
using Quota = std::optional<double>;

Quota tighter(Quota a, Quota b) {
  if (!a || !b) return a ? a : b;
  return std::min(*a, *b);
}

Quota ratio(double microseconds, double period) {
  if (!(microseconds > 0.0) || !(period > 0.0)) return std::nullopt;
  return microseconds / period;
}

/// Version 2: one file "max 100000" or "150000 100000".
Quota quota_v2(const fs::path& group) {
  std::ifstream file(group / "cpu.max");
  double quota = 0.0;
  double period = 0.0;
  if (!(file >> quota >> period)) return std::nullopt;
  return ratio(quota, period);
}

/// Version 1: two files, the quota -1 where there is none.
Quota quota_v1(const fs::path& group) {
  std::ifstream quota_file(group / "cpu.cfs_quota_us");
  std::ifstream period_file(group / "cpu.cfs_period_us");
  double quota = 0.0;
  double period = 0.0;
  if (!(quota_file >> quota) || !(period_file >> period)) return std::nullopt;
  return ratio(quota, period);
}

/// Of `group` (as /proc/self/cgroup writes it, "/a/b") and every parent up to the mount point. In a
/// container the named group may be out of sight: then only the mount point, which is the
/// container's own group, counts.
Quota tightest_upwards(const fs::path& mount, const std::string& group,
                       Quota (*read)(const fs::path&)) {
  Quota tightest = read(mount);
  fs::path place = mount;
  for (const fs::path& part : fs::path(group).relative_path()) {
    place /= part;
    tightest = tighter(tightest, read(place));
  }
  return tightest;
}

bool names_cpu(const std::string& controllers) {
  std::istringstream list(controllers);
  for (std::string name; std::getline(list, name, ',');)
    if (name == "cpu") return true;
  return false;
}

}  // namespace

std::optional<double> cgroup_quota(const fs::path& root) {
  const fs::path mounts = root / "sys/fs/cgroup";
  std::ifstream memberships(root / "proc/self/cgroup");
  Quota tightest;
  for (std::string line; std::getline(memberships, line);) {  // "hierarchy:controllers:group"
    const std::size_t first = line.find(':');
    const std::size_t second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const std::string group = line.substr(second + 1);
    if (controllers.empty())
      tightest = tighter(tightest, tightest_upwards(mounts, group, quota_v2));
    if (!names_cpu(controllers)) continue;
    tightest = tighter(tightest, tightest_upwards(mounts / controllers, group, quota_v1));
    if (controllers != "cpu")
      tightest = tighter(tightest, tightest_upwards(mounts / "cpu", group, quota_v1));
  }
  return tightest;
}

CpuLimits cpu_limits() {
  CpuLimits limits;
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  // Fails on machines with more processors than the set has room for.
  limits.affinity = sched_getaffinity(0, sizeof allowed, &allowed) == 0
                        ? CPU_COUNT(&allowed)
                        : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  limits.quota = cgroup_quota("/");
  return limits;
}

}  // namespace montecarta::engine
