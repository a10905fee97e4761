// SPDX-License-Identifier: BSD-3-Clause
#include "engine/threads/thread_budget.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sched.h>
#include <thread>
#include <vector>

namespace montecarta::engine {
namespace {

namespace fs = std::filesystem;

/// The quota of one group. Version 2 has one file, "max 100000" or "150000 100000". Version 1 has
/// two files; the quota is -1 if there is none.
double quota_in(const fs::path& group) {
  std::ifstream both(group / "cpu.max");
  std::ifstream first(group / "cpu.cfs_quota_us"), second(group / "cpu.cfs_period_us");
  double quota = 0.0, period = 0.0;
  const bool is_read = both >> quota >> period || (first >> quota && second >> period);
  return is_read && quota > 0.0 && period > 0.0 ? quota / period : CpuLimits().quota;
}

/// The tightest quota of `group` (as in /proc/self/cgroup, "/a/b") and all its parents up to the
/// mount point. In a container the group may not be visible; then only the mount point counts,
/// which is the container's own group.
double tightest_upwards(fs::path place, const std::string& group) {
  double tightest = quota_in(place);
  for (const fs::path& part : fs::path(group).relative_path())
    tightest = std::min(tightest, quota_in(place /= part));
  return tightest;
}

/// The folders in which groups with these controllers, such as "cpu,cpuacct", may be mounted. In
/// version 2 there are no controllers.
std::vector<fs::path> mounts_of(const std::string& controllers, const fs::path& mounts) {
  if (controllers.empty()) return {mounts};
  const bool limits_cpu = formatted(",{},", controllers).find(",cpu,") != std::string::npos;
  return limits_cpu ? std::vector{mounts / controllers, mounts / "cpu"} : std::vector<fs::path>();
}

int parse_threads(const std::string& place, std::string_view text, const char* remedy) {
  constexpr int kMostThreads = 4096;
  int threads = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, threads);
  if (error == std::errc() && stop == end && threads >= 1 && threads <= kMostThreads)
    return threads;
  throw StudyError("{}: '{}' (a number of threads is a whole number from 1 to {}): {}", place, text,
                   kMostThreads, remedy);
}

}  // namespace

double cgroup_quota(const fs::path& root) {
  std::ifstream memberships(root / "proc/self/cgroup");
  double tightest = CpuLimits().quota;
  for (std::string line; std::getline(memberships, line);) {  // "hierarchy:controllers:group"
    const std::size_t first = line.find(':');
    const std::size_t second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    for (const fs::path& mount : mounts_of(controllers, root / "sys/fs/cgroup"))
      tightest = std::min(tightest, tightest_upwards(mount, line.substr(second + 1)));
  }
  return tightest;
}

CpuLimits cpu_limits() {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  // This fails on machines with more processors than fit into the set.
  const int affinity = sched_getaffinity(0, sizeof allowed, &allowed) == 0
                           ? CPU_COUNT(&allowed)
                           : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  return {affinity, cgroup_quota("/")};
}

namespace {

/// The number of threads that the user asks for; nullopt if there is none.
std::optional<int> wanted_threads(const std::optional<std::string>& threads_option) {
  if (threads_option)
    return parse_threads("--threads", *threads_option, "give --threads 1 or more, or leave it out");
  for (const std::string name : {"MONTECARTA_THREADS", "SLURM_CPUS_PER_TASK", "OMP_NUM_THREADS"}) {
    const char* value = std::getenv(name.c_str());
    if (value == nullptr || *value == '\0') continue;
    std::string_view text = value;
    // It may list one number per level of nesting: "4,2".
    if (name == "OMP_NUM_THREADS") text = text.substr(0, text.find(','));
    return parse_threads("environment variable " + name, text,
                         "set it to 1 or more, unset it, or give --threads N");
  }
  return std::nullopt;
}

}  // namespace

int thread_budget(const std::optional<std::string>& threads_option, const CpuLimits& limits) {
  // This rounds up: a throttled second thread still ends sooner than an idle half of a processor.
  const auto processors =
      static_cast<int>(std::clamp(std::ceil(limits.quota), 1.0, double(limits.affinity)));
  // More threads would drive each other's runs out of the caches (measured: 64 on 2 processors took
  // 9 % more processor time), and each of them takes memory.
  return std::min(wanted_threads(threads_option).value_or(processors), processors);
}

}  // namespace montecarta::engine
