// SPDX-License-Identifier: BSD-3-Clause
#include "engine/threads/thread_budget.hpp"

#include "engine/errors.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

namespace montecarta::engine {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// The budget of a process on 6 processors with these variables set.
ThreadBudget budget(std::map<std::string, std::string> variables,
                    std::optional<std::string> option = std::nullopt,
                    std::optional<double> quota = std::nullopt) {
  const Environment environment = [&](const char* name) -> std::optional<std::string> {
    const auto found = variables.find(name);
    if (found == variables.end()) return std::nullopt;
    return found->second;
  };
  return thread_budget(option, environment, CpuLimits{6, quota});
}

void expect_budget(const ThreadBudget& actual, int threads, const std::string& source) {
  EXPECT_EQ(actual.threads, threads);
  EXPECT_EQ(actual.source, source);
}

TEST(ThreadBudget, TakesTheFirstThatIsSet) {
  std::map<std::string, std::string> variables{
      {"MONTECARTA_THREADS", "3"}, {"SLURM_CPUS_PER_TASK", "4"}, {"OMP_NUM_THREADS", "5,2"}};
  expect_budget(budget(variables, "2"), 2, "--threads");
  expect_budget(budget(variables), 3, "MONTECARTA_THREADS");
  variables.erase("MONTECARTA_THREADS");
  expect_budget(budget(variables), 4, "SLURM_CPUS_PER_TASK");
  variables.erase("SLURM_CPUS_PER_TASK");
  expect_budget(budget(variables), 5, "OMP_NUM_THREADS");
  expect_budget(budget({}), 6, "CPU affinity");
}

TEST(ThreadBudget, CountsAnEmptyVariableAsUnset) {
  expect_budget(budget({{"MONTECARTA_THREADS", ""}, {"OMP_NUM_THREADS", "2"}}), 2,
                "OMP_NUM_THREADS");
}

TEST(ThreadBudget, ObeysTheQuotaRoundedUp) {
  expect_budget(budget({}, std::nullopt, 1.5), 2, "cgroup CPU quota");
  expect_budget(budget({}, std::nullopt, 0.1), 1, "cgroup CPU quota");
  expect_budget(budget({}, std::nullopt, 16.0), 6, "CPU affinity");
}

TEST(ThreadBudget, NamesTheVariableAndTheRemedy) {
  for (const char* bad : {"0", "-2", "two", "2x", "1e9", "99999999999999999999", " 2"})
    EXPECT_THAT(
        [&] {
          budget({{"SLURM_CPUS_PER_TASK", bad}});
        },
        ThrowsMessage<StudyError>(
            AllOf(HasSubstr("SLURM_CPUS_PER_TASK"), HasSubstr(bad), HasSubstr("unset it"))));
  EXPECT_THAT([&] { budget({}, "0"); },
              ThrowsMessage<StudyError>(AllOf(HasSubstr("--threads"), HasSubstr("'0'"))));
}

TEST(ThreadBudget, DoesNotReadWhatDoesNotCount) {
  expect_budget(budget({{"OMP_NUM_THREADS", "many"}}, "2"), 2, "--threads");
}

TEST(ThreadBudget, OfThisProcessIsPositive) {
  EXPECT_GE(cpu_limits().affinity, 1);
  EXPECT_GE(thread_budget(std::nullopt).threads, 1);
}

}  // namespace
}  // namespace montecarta::engine
