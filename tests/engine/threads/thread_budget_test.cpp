// SPDX-License-Identifier: BSD-3-Clause
#include "engine/threads/thread_budget.hpp"

#include "engine/errors.hpp"
#include "engine/threads/parallel.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <array>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <map>
#include <string>

namespace montecarta::engine {
namespace {

constexpr double kNoQuota = std::numeric_limits<double>::infinity();

/// Leaves the variables as they were.
class ThreadBudget : public testing::Test {
 protected:
  ThreadBudget() {
    for (const char* name : kVariables) {
      if (const char* value = std::getenv(name)) before_[name] = value;
    }
  }
  ~ThreadBudget() override { set_only(before_); }

  /// The budget of a process on 6 processors with these variables set.
  static int budget(const std::map<std::string, std::string>& variables,
                    const std::optional<std::string>& option = std::nullopt,
                    double quota = kNoQuota) {
    set_only(variables);
    return thread_budget(option, CpuLimits{6, quota});
  }

 private:
  static constexpr std::array kVariables = {"MONTECARTA_THREADS", "SLURM_CPUS_PER_TASK",
                                            "OMP_NUM_THREADS"};

  static void set_only(const std::map<std::string, std::string>& variables) {
    for (const char* name : kVariables) ::unsetenv(name);
    for (const auto& [name, value] : variables) ::setenv(name.c_str(), value.c_str(), 1);
  }

  std::map<std::string, std::string> before_;
};

TEST_F(ThreadBudget, TakesTheFirstThatIsSetWithinTheQuota) {
  std::map<std::string, std::string> variables{
      {"MONTECARTA_THREADS", "3"}, {"SLURM_CPUS_PER_TASK", "4"}, {"OMP_NUM_THREADS", "5,2"}};
  EXPECT_EQ(budget(variables, "2"), 2);
  EXPECT_EQ(budget(variables), 3);
  variables.erase("MONTECARTA_THREADS");
  EXPECT_EQ(budget(variables), 4);
  variables.erase("SLURM_CPUS_PER_TASK");
  EXPECT_EQ(budget(variables), 5);
  EXPECT_EQ(budget({}), 6);
  EXPECT_EQ(budget({{"MONTECARTA_THREADS", ""}, {"OMP_NUM_THREADS", "2"}}), 2);
  EXPECT_EQ(budget({}, std::nullopt, 1.5), 2);
  EXPECT_EQ(budget({}, std::nullopt, 0.1), 1);
  EXPECT_EQ(budget({}, std::nullopt, 16.0), 6);
}

TEST_F(ThreadBudget, IsNeverMoreThanThereAreProcessors) {
  EXPECT_EQ(budget({}, "64"), 6);
  EXPECT_EQ(budget({{"SLURM_CPUS_PER_TASK", "64"}}), 6);
  EXPECT_EQ(budget({}, "6", 1.5), 2);
}

TEST_F(ThreadBudget, NamesTheVariableAndTheRemedy) {
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

TEST_F(ThreadBudget, DoesNotReadWhatDoesNotCount) {
  EXPECT_EQ(budget({{"OMP_NUM_THREADS", "many"}}, "2"), 2);
}

TEST_F(ThreadBudget, OfThisProcessIsPositive) {
  EXPECT_GE(cpu_limits().affinity, 1);
  EXPECT_GE(thread_budget(std::nullopt), 1);
}

/// A file system root of our own making.
class CgroupQuota : public testing::Test {
 protected:
  void write(const std::string& path, const std::string& text) const {
    std::filesystem::create_directories((root / path).parent_path());
    std::ofstream(root / path) << text << '\n';
  }

  const ScratchFolder folder;
  const std::filesystem::path root = folder.path();
};

TEST_F(CgroupQuota, IsTheTightestOfAllParentsInVersion2) {
  EXPECT_EQ(cgroup_quota(root), kNoQuota) << "without groups";
  write("proc/self/cgroup", "0::/batch/job_7");
  write("sys/fs/cgroup/cpu.max", "max 100000");
  EXPECT_EQ(cgroup_quota(root), kNoQuota);
  write("sys/fs/cgroup/batch/cpu.max", "150000 100000");
  write("sys/fs/cgroup/batch/job_7/cpu.max", "400000 100000");
  EXPECT_EQ(cgroup_quota(root), 1.5);
}

TEST_F(CgroupQuota, IsReadOfVersion1AndOfTheMountInAContainer) {
  const auto write_limits = [&](const std::string& group, const char* quota) {
    write("sys/fs/cgroup/" + group + "/cpu.cfs_quota_us", quota);
    write("sys/fs/cgroup/" + group + "/cpu.cfs_period_us", "100000");
  };
  write("proc/self/cgroup", "5:memory:/x\n4:cpu,cpuacct:/docker/abc");
  write_limits("cpu,cpuacct", "-1");
  write_limits("cpu,cpuacct/docker/abc", "300000");
  EXPECT_EQ(cgroup_quota(root), 3.0);
  write("proc/self/cgroup", "4:cpu:/out/of/sight");
  write_limits("cpu", "200000");
  EXPECT_EQ(cgroup_quota(root), 2.0);
}

TEST(SpareThreads, AreLentOnceAWorkerHasNothingToDo) {
  const Parallel parallel(Backend::tbb, 2);
  SpareThreads spare(parallel, 2);
  EXPECT_EQ(&spare.lend(1000), &Parallel::serial());
  spare.gain_one();
  EXPECT_EQ(&spare.lend(1000), &parallel);
  const Parallel four(Backend::tbb, 4);
  EXPECT_EQ(&SpareThreads(four, 3).lend(1000), &four) << "fewer runs than threads";
}

TEST(SpareThreads, DoNotPayForFewParticles) {
  const Parallel parallel(Backend::tbb, 2);
  const SpareThreads spare(parallel, 1);
  EXPECT_EQ(&spare.lend(SpareThreads::kLeastParticles - 1), &Parallel::serial());
  EXPECT_EQ(&spare.lend(SpareThreads::kLeastParticles), &parallel);
}

}  // namespace
}  // namespace montecarta::engine
