// SPDX-License-Identifier: BSD-3-Clause
#include "engine/threads/thread_budget.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <unistd.h>

namespace montecarta::engine {
namespace {

/// A file system root of our own making.
class CgroupQuota : public testing::Test {
 protected:
  ~CgroupQuota() override { std::filesystem::remove_all(root); }

  void write(const std::string& path, const std::string& text) const {
    std::filesystem::create_directories((root / path).parent_path());
    std::ofstream(root / path) << text << '\n';
  }

  const std::filesystem::path root =
      std::filesystem::path(testing::TempDir()) /
      ("cgroup_" + std::to_string(getpid()) + "_" +
       testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(CgroupQuota, IsNoneWithoutGroups) { EXPECT_EQ(cgroup_quota(root), std::nullopt); }

TEST_F(CgroupQuota, IsTheTightestOfAllParentsInVersion2) {
  write("proc/self/cgroup", "0::/batch/job_7");
  write("sys/fs/cgroup/cpu.max", "max 100000");
  write("sys/fs/cgroup/batch/cpu.max", "150000 100000");
  write("sys/fs/cgroup/batch/job_7/cpu.max", "400000 100000");
  EXPECT_EQ(cgroup_quota(root), 1.5);
}

TEST_F(CgroupQuota, IsUnlimitedAtMax) {
  write("proc/self/cgroup", "0::/");
  write("sys/fs/cgroup/cpu.max", "max 100000");
  EXPECT_EQ(cgroup_quota(root), std::nullopt);
}

TEST_F(CgroupQuota, ReadsVersion1) {
  write("proc/self/cgroup", "5:memory:/x\n4:cpu,cpuacct:/docker/abc");
  write("sys/fs/cgroup/cpu,cpuacct/cpu.cfs_quota_us", "-1");
  write("sys/fs/cgroup/cpu,cpuacct/cpu.cfs_period_us", "100000");
  write("sys/fs/cgroup/cpu,cpuacct/docker/abc/cpu.cfs_quota_us", "300000");
  write("sys/fs/cgroup/cpu,cpuacct/docker/abc/cpu.cfs_period_us", "100000");
  EXPECT_EQ(cgroup_quota(root), 3.0);
}

TEST_F(CgroupQuota, FallsBackToTheMountInAContainer) {
  write("proc/self/cgroup", "4:cpu:/out/of/sight");
  write("sys/fs/cgroup/cpu/cpu.cfs_quota_us", "200000");
  write("sys/fs/cgroup/cpu/cpu.cfs_period_us", "100000");
  EXPECT_EQ(cgroup_quota(root), 2.0);
}

}  // namespace
}  // namespace montecarta::engine
