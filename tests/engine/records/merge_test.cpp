// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/merge.hpp"

#include "engine/errors.hpp"
#include "engine/records/result_file.hpp"
#include "tests/doubles/reader_program.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/doubles/scripted_result.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>

namespace montecarta::engine {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class Merge : public ::testing::Test {
 protected:
  std::filesystem::path shard(const std::string& name, std::uint64_t first, std::uint64_t last) {
    write_result(folder_ / name, part_of_plan(plan_, first, last));
    return folder_ / name;
  }
  std::string refusal(const std::vector<std::filesystem::path>& shards) {
    try {
      merge_results(out_, shards, Existing::refuse);
    } catch (const std::runtime_error& error) {
      EXPECT_FALSE(std::filesystem::exists(out_));
      EXPECT_FALSE(std::filesystem::exists(folder_ / "out.h5.merging"));
      return error.what();
    }
    ADD_FAILURE() << "merged";
    return {};
  }

  ScratchFolder folder_;
  std::filesystem::path out_ = folder_ / "out.h5";
  StudyPlan plan_ = small_result_plan(5);
};

TEST_F(Merge, EqualsTheStudyInOnePiece) {
  if (!installed("h5diff")) GTEST_SKIP() << "h5diff (hdf5-tools) is not installed";
  const auto summary = merge_results(
      out_, {shard("b.h5", 2, 4), shard("a.h5", 0, 2), shard("c.h5", 3, 5)}, Existing::refuse);
  EXPECT_EQ(summary.runs, 5U);
  EXPECT_EQ(summary.overlapping, 1U);
  write_result(folder_ / "once.h5", plan_);
  const std::string diff = "h5diff " + out_.string() + " " + (folder_ / "once.h5").string();
  for (const char* group : {" /cells", " /truth", " /scenario", " /run", " /timing"}) {
    EXPECT_EQ(std::system((diff + group + group).c_str()), 0) << group;
  }
}

TEST_F(Merge, NamesGapsAndWritesNothing) {
  EXPECT_THAT(refusal({shard("a.h5", 0, 1), shard("b.h5", 3, 4)}), HasSubstr("runs 1:3, 4:5 are"));
}

TEST_F(Merge, RefusesAnotherStudy) {
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
  std::fstream file(a, std::ios::binary | std::ios::in | std::ios::out);
  std::string content((std::istreambuf_iterator<char>(file)), {});
  Drive drive;
  plan_.drives->generate(3, drive);
  const auto at = content.find(std::string(reinterpret_cast<const char*>(drive.truth.data()), 240));
  ASSERT_NE(at, std::string::npos);
  file.seekp(static_cast<std::streamoff>(at));
  file.write("torn", 4);
  file.close();
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

TEST_F(Merge, RefusesMissingShardsAndItsOwnOutput) {
  EXPECT_THAT(refusal({folder_ / "nothing.h5"}), HasSubstr("nothing.h5"));
  const auto a = shard("a.h5", 0, 5);
  EXPECT_THROW(merge_results(a, {a}, Existing::replace), StudyError);
  EXPECT_EQ(ResultFile(a).runs().size(), 5U);
}

}  // namespace
}  // namespace montecarta::engine
