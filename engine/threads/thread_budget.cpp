// SPDX-License-Identifier: BSD-3-Clause
#include "engine/threads/thread_budget.hpp"

#include "engine/errors.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sched.h>
#include <sstream>
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

/// Version 2 has one file, "max 100000" or "150000 100000".
Quota quota_v2(const fs::path& group) {
  std::ifstream file(group / "cpu.max");
  double quota = 0.0;
  double period = 0.0;
  if (!(file >> quota >> period)) return std::nullopt;
  return ratio(quota, period);
}

/// Version 1 has two files; the quota is -1 if there is none.
Quota quota_v1(const fs::path& group) {
  std::ifstream quota_file(group / "cpu.cfs_quota_us");
  std::ifstream period_file(group / "cpu.cfs_period_us");
  double quota = 0.0;
  double period = 0.0;
  if (!(quota_file >> quota) || !(period_file >> period)) return std::nullopt;
  return ratio(quota, period);
}

/// The tightest quota of `group` (as in /proc/self/cgroup, "/a/b") and all its parents up to the
/// mount point. In a container the group may not be visible; then only the mount point counts,
/// which is the container's own group.
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

constexpr int kMostThreads = 4096;

int parse_threads(const std::string& place, const std::string& text, const char* remedy) {
  int threads = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, threads);
  if (error == std::errc() && stop == end && threads >= 1 && threads <= kMostThreads)
    return threads;
  throw StudyError(place + ": '" + text + "' (a number of threads is a whole number from 1 to " +
                   std::to_string(kMostThreads) + "): " + remedy);
}

/// OMP_NUM_THREADS may list one number per level of nesting: "4,2".
std::string first_of_list(const std::string& text) { return text.substr(0, text.find(',')); }

ThreadBudget tightest(const CpuLimits& limits) {
  if (!limits.quota || *limits.quota >= limits.affinity) return {limits.affinity, "CPU affinity"};
  // This rounds up: a throttled second thread still ends sooner than an idle half of a processor.
  const int threads = std::max(1, static_cast<int>(std::ceil(*limits.quota)));
  return {std::min(threads, limits.affinity), "cgroup CPU quota"};
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
  // This fails on machines with more processors than fit into the set.
  limits.affinity = sched_getaffinity(0, sizeof allowed, &allowed) == 0
                        ? CPU_COUNT(&allowed)
                        : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  limits.quota = cgroup_quota("/");
  return limits;
}

std::optional<std::string> environment_variable(const char* name) {
  const char* value = std::getenv(name);
  if (value == nullptr) return std::nullopt;
  return value;
}

ThreadBudget thread_budget(const std::optional<std::string>& threads_option,
                           const Environment& environment, const CpuLimits& limits) {
  if (threads_option)
    return {
        parse_threads("--threads", *threads_option, "give --threads 1 or more, or leave it out"),
        "--threads"};
  for (const char* name : {"MONTECARTA_THREADS", "SLURM_CPUS_PER_TASK", "OMP_NUM_THREADS"}) {
    const std::optional<std::string> value = environment(name);
    if (!value || value->empty()) continue;
    const bool list = std::string_view(name) == "OMP_NUM_THREADS";
    return {parse_threads(std::string("environment variable ") + name,
                          list ? first_of_list(*value) : *value,
                          "set it to 1 or more, unset it, or give --threads N"),
            name};
  }
  return tightest(limits);
}

}  // namespace montecarta::engine
