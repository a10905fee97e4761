// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/merge.hpp"

#include "engine/errors.hpp"
#include "engine/records/result_file.hpp"
#include "engine/records/result_layout.hpp"
#include "tests/doubles/damage.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/reader_program.hpp"
#include "tests/doubles/result_writing.hpp"

#include <cstdlib>

namespace montecarta::engine {
namespace {

class Merge : public ResultWriting {
 protected:
  Merge() { plan_ = small_result_plan(5); }
  std::filesystem::path shard(const std::string& name, std::uint64_t first, std::uint64_t last) {
    write_result(folder_ / name, part_of_plan(plan_, first, last));
    return folder_ / name;
  }
  std::string refusal(const std::vector<std::filesystem::path>& shards) {
    try {
      merge_results(path_, shards, Existing::refuse);
    } catch (const std::runtime_error& error) {
      EXPECT_FALSE(std::filesystem::exists(path_));
      EXPECT_FALSE(std::filesystem::exists(folder_ / "out.h5.new"));
      return error.what();
    }
    ADD_FAILURE() << "merged";
    return {};
  }
};

TEST_F(Merge, EqualsTheStudyInOnePiece) {
  if (!installed("h5diff")) GTEST_SKIP() << "h5diff (hdf5-tools) is not installed";
  const auto summary = merge_results(
      path_, {shard("b.h5", 2, 4), shard("a.h5", 0, 2), shard("c.h5", 3, 5)}, Existing::refuse);
  EXPECT_EQ(summary.runs, 5U);
  write_result(folder_ / "once.h5", plan_);
  const std::string diff = "h5diff " + path_.string() + " " + (folder_ / "once.h5").string();
  for (const char* group : {" /cells", " /truth", " /scenario", " /run", " /timing"}) {
    EXPECT_EQ(std::system((diff + group + group).c_str()), 0) << group;
  }
}

TEST_F(Merge, RefusesGapsAndAnotherStudy) {
  EXPECT_THAT(refusal({shard("c.h5", 0, 1), shard("d.h5", 3, 4)}), HasSubstr("runs 1:3, 4:5 are"));
  const auto a = shard("a.h5", 0, 3);
  plan_.resolved_text += "# other\n";
  EXPECT_THAT(refusal({a, shard("b.h5", 3, 5)}), HasSubstr("b.h5"));
}

TEST_F(Merge, RefusesRunsThatDiffer) {
  const auto a = shard("a.h5", 0, 3);
  plan_.cells[0].make_filter = [] {
    return std::make_unique<ScriptedFilter>(ScriptedFilter::Script{.landmarks = 1});
  };
  EXPECT_THAT(refusal({a, shard("b.h5", 2, 5)}), HasSubstr("run 2 differs"));
}

TEST_F(Merge, RefusesAShardThatIsDamaged) {
  const auto a = shard("a.h5", 0, 5);
  flip_bit(a, find_slabs(a, describe(plan_, {})).truth->pose.at(3));
  EXPECT_THAT(refusal({a}), HasSubstr("run 3 is damaged"));
}

TEST_F(Merge, TakesTheWholeRunsOfUnfinishedWork) {
  const auto a = shard("a.h5", 0, 3);
  {
    const StudyPlan rest = part_of_plan(plan_, 2, 5);
    ResultWriter writer = ResultWriter::create(folder_ / "b.h5", rest, {}, Existing::refuse);
    store_run(writer, rest, 3);
  }
  EXPECT_THAT(refusal({a, folder_ / "b.h5.part"}), HasSubstr("runs 4:5"));
}

TEST_F(Merge, IsLeftToAnotherProcessThatWasFaster) {
  const auto a = shard("a.h5", 0, 5);
  const auto removed = folder_ / "a.h5.part.of.faster";
  EXPECT_THROW(merge_attempt(path_, {removed}), std::runtime_error);
  EXPECT_TRUE(merge_attempt(path_, {a}));
  EXPECT_FALSE(merge_attempt(path_, {removed}));
}

TEST_F(Merge, RefusesMissingShardsAndItsOwnOutput) {
  EXPECT_THAT(refusal({folder_ / "nothing.h5"}), HasSubstr("nothing.h5"));
  const auto a = shard("a.h5", 0, 5);
  EXPECT_THROW(merge_results(a, {a}, Existing::replace), StudyError);
  EXPECT_EQ(ResultFile(a).runs().size(), 5U);
}

}  // namespace
}  // namespace montecarta::engine
