// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/array_index.hpp"

#include "engine/errors.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/experiments/commands/program.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <optional>

namespace montecarta::experiments {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// The environment of a task, without what a scheduler set before the test.
class ArrayTask : public testing::Test {
 protected:
  using Variables = std::map<std::string, std::string>;

  ArrayTask() {
    for (const char* name :
         {"SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_MAX", "PBS_ARRAY_INDEX", "SGE_TASK_ID",
          "SGE_TASK_LAST", "LSB_JOBINDEX", "JOB_COMPLETION_INDEX", "AWS_BATCH_JOB_ARRAY_INDEX"}) {
      const char* value = std::getenv(name);
      before_[name] = value == nullptr ? std::nullopt : std::optional<std::string>(value);
      ::unsetenv(name);
    }
  }
  ~ArrayTask() override {
    for (const auto& [name, value] : before_) {
      ::unsetenv(name.c_str());
      if (value) ::setenv(name.c_str(), value->c_str(), 1);
    }
  }
  /// The shard of a task with these variables, or the error.
  std::string shard_with(const Variables& variables, const std::string& shard = "auto/4") const {
    for (const auto& [name, value] : variables) ::setenv(name.c_str(), value.c_str(), 1);
    std::string found;
    const std::string complaint = complaint_of([&] { found = with_array_index(shard); });
    for (const auto& [name, value] : variables) ::unsetenv(name.c_str());
    return found.empty() ? complaint : found;
  }

 private:
  std::map<std::string, std::optional<std::string>> before_;
};

TEST_F(ArrayTask, HasTheShardOfItsNumber) {
  for (const char* from_0 : {"SLURM_ARRAY_TASK_ID", "PBS_ARRAY_INDEX", "JOB_COMPLETION_INDEX",
                             "AWS_BATCH_JOB_ARRAY_INDEX"}) {
    EXPECT_EQ(shard_with({{from_0, "0"}}), "0/4") << from_0;
    EXPECT_EQ(shard_with({{from_0, "3"}}), "3/4") << from_0;
  }
  for (const char* from_1 : {"SGE_TASK_ID", "LSB_JOBINDEX"}) {
    EXPECT_EQ(shard_with({{from_1, "1"}}), "0/4") << from_1;
    EXPECT_EQ(shard_with({{from_1, "4"}}), "3/4") << from_1;
  }
}

TEST_F(ArrayTask, IsRefusedIfItsNumberIsNoShardWithTheArrayThatWouldFit) {
  EXPECT_THAT(shard_with({{"SLURM_ARRAY_TASK_ID", "4"}}),
              AllOf(HasSubstr("SLURM_ARRAY_TASK_ID=4"), HasSubstr("sbatch --array=0-3")));
  EXPECT_THAT(shard_with({{"SGE_TASK_ID", "5"}}), HasSubstr("qsub -t 1-4"));
  EXPECT_THAT(shard_with({{"PBS_ARRAY_INDEX", "x"}}), HasSubstr("qsub -J 0-3"));
  EXPECT_THAT(shard_with({{"LSB_JOBINDEX", "5"}}), HasSubstr("[1-4]"));
  EXPECT_THAT(shard_with({{"JOB_COMPLETION_INDEX", "-1"}}), HasSubstr("completions: 4"));
}

TEST_F(ArrayTask, IsRefusedIfTheArrayLacksTheFirstShard) {
  EXPECT_THAT(shard_with({{"SLURM_ARRAY_TASK_ID", "2"}, {"SLURM_ARRAY_TASK_MAX", "4"}}),
              AllOf(HasSubstr("SLURM_ARRAY_TASK_MAX=4"), HasSubstr("--array=0-3")));
  EXPECT_EQ(shard_with({{"SLURM_ARRAY_TASK_ID", "2"}, {"SLURM_ARRAY_TASK_MAX", "3"}}), "2/4");
  EXPECT_EQ(shard_with({{"SGE_TASK_ID", "2"}, {"SGE_TASK_LAST", "4"}}), "1/4");
}

TEST_F(ArrayTask, IsRefusedIfTheArrayLacksTheLastShard) {
  EXPECT_THAT(shard_with({{"SLURM_ARRAY_TASK_ID", "2"}, {"SLURM_ARRAY_TASK_MAX", "2"}}),
              AllOf(HasSubstr("SLURM_ARRAY_TASK_MAX=2"), HasSubstr("--array=0-3")));
  EXPECT_THAT(shard_with({{"SGE_TASK_ID", "2"}, {"SGE_TASK_LAST", "3"}}), HasSubstr("-t 1-4"));
}

TEST_F(ArrayTask, OfTwoSchedulersIsRefusedIfTheyDisagree) {
  EXPECT_THAT(shard_with({{"SLURM_ARRAY_TASK_ID", "2"}, {"SGE_TASK_ID", "2"}}),
              AllOf(HasSubstr("SLURM_ARRAY_TASK_ID=2"), HasSubstr("SGE_TASK_ID=2")));
  EXPECT_EQ(shard_with({{"SLURM_ARRAY_TASK_ID", "2"}, {"SGE_TASK_ID", "3"}}), "2/4");
  EXPECT_EQ(shard_with({{"SGE_TASK_ID", "undefined"},
                        {"LSB_JOBINDEX", "0"},
                        {"PBS_ARRAY_INDEX", ""},
                        {"SLURM_ARRAY_TASK_ID", "1"}}),
            "1/4");
}

TEST_F(ArrayTask, IsNeededForAutomaticShardsOnly) {
  EXPECT_THAT(shard_with({{"SGE_TASK_ID", "undefined"}}),
              AllOf(HasSubstr("AWS_BATCH_JOB_ARRAY_INDEX"), HasSubstr("--shard I/4")));
  EXPECT_EQ(shard_with({{"SLURM_ARRAY_TASK_ID", "2"}}, "1/4"), "1/4");
  EXPECT_EQ(shard_with({}, "auto/x"), "auto/x");
}

class ArrayOfRuns : public BlinkProgram {};

TEST_F(ArrayOfRuns, MakesTheShardsOfAStudy) {
  for (const std::string task : {"1", "2", "3"}) {
    const Called called =
        call({"run", "blink.ini", "--shard", "auto/3", "--quiet", "-o", "shard" + task + ".h5"},
             "env -u SLURM_ARRAY_TASK_ID LSB_JOBINDEX=" + task + " ");
    EXPECT_EQ(called.code, 0) << called.err;
  }
  EXPECT_EQ(call({"merge", "all.h5", "shard1.h5", "shard2.h5", "shard3.h5"}).code, 0);
  expect_refused({"run", "blink.ini", "--shard", "auto/x", "-o", "x.h5"}, "no shard of this study");
}

}  // namespace
}  // namespace montecarta::experiments
