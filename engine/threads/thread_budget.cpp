// SPDX-License-Identifier: BSD-3-Clause
#include "engine/threads/thread_budget.hpp"

#include "engine/errors.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>

namespace montecarta::engine {
namespace {

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
  // Rounded up: a throttled second thread still finishes sooner than an idle half of a processor.
  const int threads = std::max(1, static_cast<int>(std::ceil(*limits.quota)));
  return {std::min(threads, limits.affinity), "cgroup CPU quota"};
}

}  // namespace

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
